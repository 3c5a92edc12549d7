# SPDX-License-Identifier: BSD-3-Clause
# find_package: a program builds on an installation that was moved, and runs; so does the installed program itself.
include(${CMAKE_CURRENT_LIST_DIR}/run.cmake)

set(build ${WORK_FOLDER}/installed)
file(GLOB_RECURSE bridge ${WORK_FOLDER}/moved/*/libholdfast_bridge.*)
set(with_bridge OFF)
if(bridge)
  set(with_bridge ON)
endif()
configure(${CMAKE_CURRENT_LIST_DIR}/installed ${build} -DCMAKE_PREFIX_PATH=${WORK_FOLDER}/moved
          -DWITH_BRIDGE=${with_bridge})
run(COMMAND ${CMAKE_COMMAND} --build ${build})
run(COMMAND ${build}/consumer)
run(COMMAND ${build}/geometry_consumer)
if(bridge)
  run(COMMAND ${CMAKE_COMMAND} -E chdir ${build} ./bridge_consumer)
endif()
check_libraries(${build}/consumer)

if(EXISTS ${BUILD_FOLDER}/bin/holdfast)
  run(COMMAND ${WORK_FOLDER}/moved/bin/holdfast modules OUTPUT modules)
  if(NOT modules MATCHES "opencv_orb")
    message(FATAL_ERROR "the installed program does not know its modules:\n${modules}")
  endif()
  check_libraries(${WORK_FOLDER}/moved/bin/holdfast)
endif()

# Flags that change the layout of the types in our headers: the linker refuses the program and states its layout, unless
# the program fixes the alignment. What needs headers alone takes any flag.
function(build_with_flags flags targets)
  configure(${CMAKE_CURRENT_LIST_DIR}/installed ${build}_flags -DCMAKE_PREFIX_PATH=${WORK_FOLDER}/moved
            -DCMAKE_CXX_FLAGS=${flags})
  run(COMMAND ${CMAKE_COMMAND} --build ${build}_flags --target ${targets})
endfunction()
set(other_flags -DEIGEN_MAX_STATIC_ALIGN_BYTES=0)
cmake_host_system_information(RESULT processor QUERY OS_PLATFORM)
if(processor MATCHES "x86_64|AMD64")
  list(APPEND other_flags "-mavx2 -mfma")
  build_with_flags("-mavx2 -DEIGEN_MAX_ALIGN_BYTES=16" consumer)
endif()
foreach(flags IN LISTS other_flags)
  build_with_flags("${flags}" geometry_consumer)
  execute_process(COMMAND ${CMAKE_COMMAND} --build ${build}_flags --target consumer
                  RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(result EQUAL 0 OR NOT output MATCHES "BuildLayout<.*EigenAlignmentInStructs.*is_that_of_the_library")
    message(FATAL_ERROR "a program with ${flags} gave ${result}:\n${output}")
  endif()
endforeach()

# Shared libraries, where there are any.
file(GLOB_RECURSE libraries ${WORK_FOLDER}/moved/libholdfast*.so)
foreach(library IN LISTS libraries)
  check_libraries(${library})
endforeach()

# Without CMake: the package of pkg-config, which was moved, too.
find_program(PKG_CONFIG pkg-config)
if(PKG_CONFIG)
  file(GLOB_RECURSE package ${WORK_FOLDER}/moved/*/holdfast.pc)
  cmake_path(GET package PARENT_PATH package_folder)
  run(COMMAND ${CMAKE_COMMAND} -E env PKG_CONFIG_PATH=${package_folder} ${PKG_CONFIG} --cflags --libs holdfast
      OUTPUT flags)
  separate_arguments(flags UNIX_COMMAND "${flags}")
  run(COMMAND ${CXX} ${CMAKE_CURRENT_LIST_DIR}/whole/main.cpp ${flags} -o ${build}/consumer_of_pkg_config)
  run(COMMAND ${CMAKE_COMMAND} -E env LD_LIBRARY_PATH=${package_folder}/..
      ${build}/consumer_of_pkg_config ${CMAKE_CURRENT_LIST_DIR}/whole/simulated.yaml)
endif()
