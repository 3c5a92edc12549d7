# SPDX-License-Identifier: BSD-3-Clause
# add_subdirectory: a program on two modules builds and runs, and the project around it stays as it was.
include(${CMAKE_CURRENT_LIST_DIR}/run.cmake)

set(build ${WORK_FOLDER}/embedded)
configure(${CMAKE_CURRENT_LIST_DIR}/embedded ${build} -DHOLDFAST_FOLDER=${HOLDFAST_FOLDER})
run(COMMAND ${CMAKE_COMMAND} --build ${build} --target consumer --parallel 2)
run(COMMAND ${build}/consumer)
if(EXISTS ${build}/holdfast/modules/tracking/libholdfast_tracking.a)
  message(FATAL_ERROR "a module that nobody asked for was built")
endif()
