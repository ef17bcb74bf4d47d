# `cmake --install` and `cpack`: the command, and the library for other projects (find_package(hdr), pkg-config).
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

get_property(modules GLOBAL PROPERTY HDR_MODULES)
set(config_dir ${CMAKE_INSTALL_LIBDIR}/cmake/hdr)

install(TARGETS hdr COMPONENT tools DESTINATION ${CMAKE_INSTALL_BINDIR})
install(FILES README.md libhdr/REFERENCES.md LICENSE COMPONENT tools DESTINATION ${CMAKE_INSTALL_DOCDIR})

# Headers keep their paths below one folder of their own: code says #include "libhdr/hdr.h", installed or not.
set(include_dir ${CMAKE_INSTALL_INCLUDEDIR}/hdr)
install(DIRECTORY libhdr capture DESTINATION ${include_dir} COMPONENT dev FILES_MATCHING PATTERN "*.h"
        PATTERN "internal" EXCLUDE)
install(TARGETS ${modules} hdr_all hdr_flags hdr_opencv EXPORT hdr COMPONENT dev ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
        INCLUDES DESTINATION ${include_dir})
install(EXPORT hdr NAMESPACE hdr:: FILE hdrTargets.cmake DESTINATION ${config_dir} COMPONENT dev)

# CMake strips programs alone; debug information is nine tenths of an archive.
foreach(module ${modules})
  list(APPEND archives "\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_LIBDIR}/lib${module}.a")
endforeach()
install(CODE "if(CMAKE_INSTALL_DO_STRIP)
  execute_process(COMMAND \"${CMAKE_STRIP}\" --strip-debug ${archives} COMMAND_ERROR_IS_FATAL ANY)
endif()" COMPONENT dev)

configure_package_config_file(cmake/hdrConfig.cmake.in hdrConfig.cmake INSTALL_DESTINATION ${config_dir})
write_basic_package_version_file(hdrConfigVersion.cmake COMPATIBILITY SameMinorVersion)

# A static archive must come before those it uses, which are declared before it.
set(pc_archives ${modules})
list(REVERSE pc_archives)
list(TRANSFORM pc_archives PREPEND "-l")
list(JOIN pc_archives " " pc_archives)
set(pc_libcamera "")
if(HDR_HAS_LIBCAMERA)
  set(pc_libcamera ", libcamera")
endif()
file(RELATIVE_PATH pc_prefix /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
configure_file(cmake/hdr.pc.in hdr.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/hdrConfig.cmake ${PROJECT_BINARY_DIR}/hdrConfigVersion.cmake DESTINATION ${config_dir}
        COMPONENT dev)
install(FILES ${PROJECT_BINARY_DIR}/hdr.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT dev)

include(cmake/packages.cmake)
