# SPDX-License-Identifier: BSD-3-Clause
# `cmake --install`: the libraries with their package, the headers, the program. Included last, when every target is
# known. The result can be moved as a whole: nothing in it names the place where it was built.
include(CMakePackageConfigHelpers)

set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/holdfast)
get_property(exported_targets GLOBAL PROPERTY HOLDFAST_EXPORTED_TARGETS)

# The package that defines a library of somebody else's; "" for what every linker knows.
function(holdfast_package_of library result)
  if(library MATCHES "^opencv_")
    set(package OpenCV)
  elseif(library MATCHES "^(Eigen3|Threads|nlohmann_json|CLI11|GTest)::")
    set(package ${CMAKE_MATCH_1})
  elseif(library MATCHES "^Ceres::")
    set(package Ceres)
  elseif(library MATCHES "^yaml-cpp")
    set(package yaml-cpp)
  elseif(library MATCHES "^(lz4|deflate|jpeg|bz2|zstd|sqlite3|dnnl|OpenNI2|openvdb|tbb|OpenEXR|Iex|Imath)$")
    set(package ${library})
  elseif(library STREQUAL "gomp" OR library IN_LIST CMAKE_DL_LIBS)
    set(package "")
  else()
    message(FATAL_ERROR "cmake/HoldfastInstall.cmake does not know which package '${library}' comes from: name it in "
                        "holdfast_package_of and in cmake/holdfastConfig.cmake.in")
  endif()
  set(${result} "${package}" PARENT_SCOPE)
endfunction()

# Every package that somebody who links `target` must have, those of static libraries' private parts included.
function(holdfast_packages_of target result)
  set(packages "")
  set(visited "")
  set(pending ${target})
  while(pending)
    list(POP_FRONT pending current)
    string(REGEX REPLACE "^\\$<LINK_ONLY:(.*)>$" "\\1" current "${current}")
    if(TARGET ${current})
      get_target_property(aliased ${current} ALIASED_TARGET)
      if(aliased)
        set(current ${aliased})
      endif()
    endif()
    if(current IN_LIST visited)
      continue()
    endif()
    list(APPEND visited ${current})
    if(current IN_LIST exported_targets)
      get_target_property(libraries ${current} INTERFACE_LINK_LIBRARIES)
      if(libraries)
        list(APPEND pending ${libraries})
      endif()
    else()
      holdfast_package_of(${current} package)
      list(APPEND packages ${package})
    endif()
  endwhile()
  list(REMOVE_DUPLICATES packages)
  list(SORT packages)
  set(${result} "${packages}" PARENT_SCOPE)
endfunction()

# A component is a module; what it needs is read from its target, so that the package cannot fall behind.
set(HOLDFAST_COMPONENTS "")
set(HOLDFAST_COMPONENT_PACKAGES "")
foreach(target IN LISTS exported_targets)
  get_target_property(component ${target} EXPORT_NAME)
  holdfast_packages_of(${target} packages)
  list(APPEND HOLDFAST_COMPONENTS ${component})
  string(APPEND HOLDFAST_COMPONENT_PACKAGES "set(holdfast_${component}_packages \"${packages}\")\n")
  set_target_properties(${target} PROPERTIES INSTALL_RPATH "\$ORIGIN")
endforeach()

install(TARGETS ${exported_targets} EXPORT holdfast
        ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development
        LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT runtime
        RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT runtime)
install(EXPORT holdfast NAMESPACE holdfast:: FILE holdfastTargets.cmake
        DESTINATION ${package_folder} COMPONENT development)

list(JOIN HOLDFAST_OPENCV_COMPONENTS " " holdfast_opencv_components)
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/holdfastConfig.cmake.in
                              ${holdfast_BINARY_DIR}/package/holdfastConfig.cmake
                              INSTALL_DESTINATION ${package_folder}
                              NO_SET_AND_CHECK_MACRO NO_CHECK_REQUIRED_COMPONENTS_MACRO)
# Before 1.0 a minor version may break what was promised before.
write_basic_package_version_file(${holdfast_BINARY_DIR}/package/holdfastConfigVersion.cmake
                                 VERSION ${holdfast_VERSION} COMPATIBILITY SameMinorVersion)
install(FILES ${holdfast_BINARY_DIR}/package/holdfastConfig.cmake
              ${holdfast_BINARY_DIR}/package/holdfastConfigVersion.cmake
              ${CMAKE_CURRENT_LIST_DIR}/HoldfastAddPlugin.cmake
              ${CMAKE_CURRENT_LIST_DIR}/HoldfastConformance.cmake
              ${CMAKE_CURRENT_LIST_DIR}/conformance_main.cpp.in
        DESTINATION ${package_folder} COMPONENT development)

include(HoldfastPkgConfig)

set(left_out "")
foreach(header IN LISTS HOLDFAST_LEFT_OUT_SETTINGS)
  list(APPEND left_out PATTERN "${header}" EXCLUDE)
endforeach()
install(DIRECTORY ${holdfast_SOURCE_DIR}/include/holdfast ${holdfast_BINARY_DIR}/include/holdfast
        DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT development FILES_MATCHING PATTERN "*.hpp" ${left_out})
install(FILES ${holdfast_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT runtime)

if(TARGET holdfast_program)
  set_target_properties(holdfast_program PROPERTIES INSTALL_RPATH "\$ORIGIN/../${CMAKE_INSTALL_LIBDIR}")
  install(TARGETS holdfast_program RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT program)
  # Written by the program itself after it was linked; see modules/cli.
  set(shell_folder ${holdfast_BINARY_DIR}/shell)
  install(FILES ${shell_folder}/holdfast.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT program OPTIONAL)
  install(FILES ${shell_folder}/holdfast DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions
          COMPONENT program OPTIONAL)
  install(FILES ${shell_folder}/_holdfast DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/site-functions
          COMPONENT program OPTIONAL)
  install(FILES ${shell_folder}/holdfast.fish DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d
          COMPONENT program OPTIONAL)
  install(DIRECTORY ${holdfast_SOURCE_DIR}/examples/configs ${holdfast_SOURCE_DIR}/examples/scenes
          DESTINATION ${CMAKE_INSTALL_DATADIR}/holdfast COMPONENT program FILES_MATCHING PATTERN "*.yaml")
endif()

if(PROJECT_IS_TOP_LEVEL)
  include(HoldfastPackage)
endif()
