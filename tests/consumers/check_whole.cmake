# SPDX-License-Identifier: BSD-3-Clause
# find_package without components: a program on holdfast::holdfast tracks a few frames with the built-in plugins.
include(${CMAKE_CURRENT_LIST_DIR}/run.cmake)

set(build ${WORK_FOLDER}/whole)
configure(${CMAKE_CURRENT_LIST_DIR}/whole ${build} -DCMAKE_PREFIX_PATH=${WORK_FOLDER}/moved)
run(COMMAND ${CMAKE_COMMAND} --build ${build})
run(COMMAND ${build}/consumer ${CMAKE_CURRENT_LIST_DIR}/whole/simulated.yaml)
