# `cpack` makes two Debian packages: hdr, the command, and libhdr-dev, the library.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_CONTACT "the hdr developers <hdr@localhost>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${PROJECT_DESCRIPTION}")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_ALL tools dev)
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_TOOLS_PACKAGE_NAME hdr)
set(CPACK_DEBIAN_TOOLS_PACKAGE_SHLIBDEPS ON)  # read from the program itself
set(CPACK_DEBIAN_DEV_PACKAGE_NAME libhdr-dev)
set(CPACK_DEBIAN_DEV_PACKAGE_SECTION libdevel)
set(CPACK_COMPONENT_TOOLS_DESCRIPTION
    "Brackets of photographs become radiance maps, light probes, spherical harmonics, lights and test renders: the command.")
set(CPACK_COMPONENT_DEV_DESCRIPTION "The C++20 library behind the command: headers, archives, CMake and pkg-config files.")
# What installing the development packages that tests/run.sh lists would bring, and no more.
set(CPACK_DEBIAN_DEV_PACKAGE_DEPENDS
    "libopenimageio-dev, libopenexr-dev, libimath-dev, libtiff-dev, libraw-dev, libopencv-core-dev, libopencv-imgproc-dev, \
libopencv-video-dev, libopencv-features2d-dev, libopencv-calib3d-dev, libceres-dev, libeigen3-dev, libtbb-dev, \
libembree-dev, libassimp-dev, libhwy-dev, libfmt-dev, nlohmann-json3-dev")
if(HDR_HAS_LIBCAMERA)
  string(APPEND CPACK_DEBIAN_DEV_PACKAGE_DEPENDS ", libcamera-dev")
endif()
include(CPack)
