# SPDX-License-Identifier: BSD-3-Clause
# holdfast.pc, for builds without CMake. Libraries stand before those that they use, as a linker of static ones wants.
set(pkg_config_libraries "")
foreach(target IN LISTS exported_targets)
  get_target_property(type ${target} TYPE)
  # The conformance suite is for tests, and needs GoogleTest.
  if(NOT type STREQUAL "INTERFACE_LIBRARY" AND NOT target STREQUAL "holdfast_conformance")
    string(PREPEND pkg_config_libraries "-l${target} ")
  endif()
endforeach()
if(NOT BUILD_SHARED_LIBS)
  # Registering the built-in plugins and what registers them need each other's libraries.
  set(pkg_config_libraries "-Wl,--start-group ${pkg_config_libraries}-Wl,--end-group ")
endif()
if(HOLDFAST_PLUGIN_CERES)
  string(APPEND pkg_config_libraries "-lceres -lglog ")
endif()
if(HOLDFAST_PLUGIN_FLANN)
  string(APPEND pkg_config_libraries "-llz4 ")
endif()
if(HOLDFAST_LIBDEFLATE)
  string(APPEND pkg_config_libraries "-ldeflate ")
endif()
if(HOLDFAST_LIBJPEG)
  string(APPEND pkg_config_libraries "-ljpeg ")
endif()
string(APPEND pkg_config_libraries "-ldl -pthread")

file(RELATIVE_PATH prefix_from_here /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
string(REGEX REPLACE "/$" "" prefix_from_here "${prefix_from_here}")
configure_file(${CMAKE_CURRENT_LIST_DIR}/holdfast.pc.in ${holdfast_BINARY_DIR}/package/holdfast.pc @ONLY)
install(FILES ${holdfast_BINARY_DIR}/package/holdfast.pc
        DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT development)
