# SPDX-License-Identifier: BSD-3-Clause
# A plugin in a repository of its own, on an installation that was moved: built by holdfast_add_plugin, found by path
# and by name, and refused with the folders that were searched when it is not there.
include(${CMAKE_CURRENT_LIST_DIR}/run.cmake)

set(build ${WORK_FOLDER}/plugin)
configure(${CMAKE_CURRENT_LIST_DIR}/plugin ${build} -DCMAKE_PREFIX_PATH=${WORK_FOLDER}/moved)
run(COMMAND ${CMAKE_COMMAND} --build ${build} --parallel 2)

run(COMMAND ${build}/ask_plugin ${build}/libupper_half.so OUTPUT output)
if(NOT output MATCHES "upper_half from [^\n]*libupper_half.so\nevidence -3 0\n")
  message(FATAL_ERROR "the plugin said: ${output}")
endif()
run(COMMAND ${CMAKE_COMMAND} -E env HOLDFAST_PLUGIN_PATH=${WORK_FOLDER}:${build} ${build}/ask_plugin upper_half)

execute_process(COMMAND ${CMAKE_COMMAND} -E env HOLDFAST_PLUGIN_PATH=${WORK_FOLDER} ${build}/ask_plugin upper_half
                RESULT_VARIABLE result ERROR_VARIABLE message)
if(NOT result EQUAL 5 OR NOT message MATCHES "upper_half" OR NOT message MATCHES "${WORK_FOLDER}")
  message(FATAL_ERROR "a plugin that is not there gave ${result}: ${message}")
endif()

# The installed program, which knows nothing of them, runs a segmenter and a filter of theirs.
if(EXISTS ${BUILD_FOLDER}/bin/holdfast)
  run(COMMAND ${CMAKE_COMMAND} -E env HOLDFAST_PLUGIN_PATH=${build} ${WORK_FOLDER}/moved/bin/holdfast
              run ${CMAKE_CURRENT_LIST_DIR}/plugin/run.yaml --output ${build}/out OUTPUT output)
  file(STRINGS ${build}/out/trajectory.txt poses REGEX "^[0-9]")
  list(LENGTH poses number)
  file(READ ${build}/out/config.yaml resolved)
  if(NOT number EQUAL 12 OR NOT resolved MATCHES "${build}/libdark_things.so")
    message(FATAL_ERROR "a run with plugins gave ${number} poses with the configuration\n${resolved}\n${output}")
  endif()
endif()
