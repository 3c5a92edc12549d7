# SPDX-License-Identifier: BSD-3-Clause
# Plugins that are left out cost neither their libraries nor their modules, and an error that names one says how to get
# it.
include(${CMAKE_CURRENT_LIST_DIR}/run.cmake)

set(build ${WORK_FOLDER}/reduced)
configure(${CMAKE_CURRENT_LIST_DIR}/reduced ${build} -DHOLDFAST_FOLDER=${HOLDFAST_FOLDER})
run(COMMAND ${CMAKE_COMMAND} --build ${build} --target consumer --parallel 2)
run(COMMAND ${build}/consumer OUTPUT printed)
set(expected "features/orb
loop_detector/none
matcher/nearest
segmenter/none
source/tum
no optimizer module is called 'ceres'; it was left out of this build; configure Holdfast with -DHOLDFAST_PLUGIN_CERES=ON
")
if(NOT printed STREQUAL expected)
  message(FATAL_ERROR "expected\n${expected}found\n${printed}")
endif()
