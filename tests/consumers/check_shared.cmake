# SPDX-License-Identifier: BSD-3-Clause
# BUILD_SHARED_LIBS=ON: modules become shared libraries, which the program finds and needs.
include(${CMAKE_CURRENT_LIST_DIR}/run.cmake)

set(build ${WORK_FOLDER}/shared)
configure(${CMAKE_CURRENT_LIST_DIR}/embedded ${build} -DHOLDFAST_FOLDER=${HOLDFAST_FOLDER} -DBUILD_SHARED_LIBS=ON)
run(COMMAND ${CMAKE_COMMAND} --build ${build} --target consumer --parallel 2)
run(COMMAND ${build}/consumer)
run(COMMAND ldd ${build}/consumer OUTPUT libraries)
if(NOT libraries MATCHES "libholdfast_core.so" OR NOT libraries MATCHES "libholdfast_plugin.so")
  message(FATAL_ERROR "the program does not use shared libraries:\n${libraries}")
endif()
