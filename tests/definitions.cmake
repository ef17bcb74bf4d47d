# What test programs are told of their surroundings, and how sanitizers are told what to overlook.
set(HDR_TEST_DEFINITIONS
    HDR_BINARY="$<TARGET_FILE:hdr>"
    HDR_SOURCE_DIR="${PROJECT_SOURCE_DIR}"
    HDR_BUILD_DIR="${PROJECT_BINARY_DIR}"
    HDR_SHARED_DATA="${PROJECT_SOURCE_DIR}/../shared/data")

set(sanitizers_environment "")
if(HDR_SANITIZE MATCHES "thread")
  set(sanitizers_environment "TSAN_OPTIONS=suppressions=${PROJECT_SOURCE_DIR}/tests/tsan.supp")
elseif(HDR_SANITIZE)
  set(sanitizers_environment "LSAN_OPTIONS=suppressions=${PROJECT_SOURCE_DIR}/tests/lsan.supp")
endif()
