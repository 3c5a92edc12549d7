# SPDX-License-Identifier: BSD-3-Clause
# The sources of a plugin linked into a program on an installation that was moved.
include(${CMAKE_CURRENT_LIST_DIR}/run.cmake)

set(build ${WORK_FOLDER}/static_plugin)
configure(${CMAKE_CURRENT_LIST_DIR}/static_plugin ${build} -DCMAKE_PREFIX_PATH=${WORK_FOLDER}/moved)
run(COMMAND ${CMAKE_COMMAND} --build ${build} --parallel 2)
run(COMMAND ${build}/robot)
