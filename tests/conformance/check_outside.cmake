# SPDX-License-Identifier: BSD-3-Clause
# holdfast_conformance_test in a repository outside ours, on an installation that was moved: the tests of a shared and
# of a static plugin are found by ctest and pass.
include(${CMAKE_CURRENT_LIST_DIR}/../consumers/run.cmake)

set(build ${WORK_FOLDER}/conformance)
configure(${CMAKE_CURRENT_LIST_DIR}/outside ${build} -DCMAKE_PREFIX_PATH=${WORK_FOLDER}/moved)
run(COMMAND ${CMAKE_COMMAND} --build ${build} --parallel 2)
run(COMMAND ${CMAKE_CTEST_COMMAND} --test-dir ${build} --output-on-failure --no-tests=error OUTPUT output)
foreach(name IN ITEMS patches_conformance.features/patches.DescriptorsAreOfTheType
                      steady_conformance.matcher/steady.FindsWhatIsPredicted)
  if(NOT output MATCHES "${name}")
    message(FATAL_ERROR "the case ${name} is not there:\n${output}")
  endif()
endforeach()
foreach(name IN ITEMS nearness_conformance nearness_linked_conformance)
  if(NOT output MATCHES "${name}.filters/nearness.EvidenceIsSound")
    message(FATAL_ERROR "the cases of ${name} are not there:\n${output}")
  endif()
endforeach()
