# SPDX-License-Identifier: BSD-3-Clause
# Installed with the package: tests of a third party's plugin against the contracts of the interfaces
# (docs/conformance.md).
include_guard()

# holdfast_conformance_test(PLUGIN [NAME name] [MODULES module ...] [EXCEPT module ...] [PARAMETERS yaml]
#                           [FOLDER folder] [ENTRY name] [LABELS label ...] [TIMEOUT seconds] [PARTS count])
# A GoogleTest program NAME (PLUGIN_conformance) that holds every extractor, segmenter, filter, optimizer and loop
# detector of PLUGIN to its contract; each check of each module becomes a case of ctest. PLUGIN is a target made by
# holdfast_add_plugin, shared or STATIC.
#   MODULES     only these, as `name` or `kind/name`
#   EXCEPT      not these
#   PARAMETERS  for modules that need some, as in a configuration: "segmenter: { mine: { dilate: 3 } }"
#   FOLDER      where relative paths in PARAMETERS start; the current source folder by default
#   ENTRY       name in HOLDFAST_PLUGIN(name, ...) of a static plugin; that of the target by default
#   PARTS       so many cases of ctest, each with its share of the checks in one process: for many modules that pass
function(holdfast_conformance_test plugin)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "NAME;PARAMETERS;FOLDER;ENTRY;TIMEOUT;PARTS" "MODULES;EXCEPT;LABELS")
  holdfast_add_conformance_program(${plugin} ${ARGN})
  if(NOT arg_NAME)
    set(arg_NAME ${plugin}_conformance)
  endif()
  if(NOT arg_LABELS)
    set(arg_LABELS conformance)
  endif()
  if(NOT arg_TIMEOUT)
    set(arg_TIMEOUT 120)
  endif()
  if(CMAKE_CROSSCOMPILING)  # an emulator is about fifteen times slower
    math(EXPR arg_TIMEOUT "20 * ${arg_TIMEOUT}")
  endif()
  if(arg_PARTS)
    foreach(part RANGE 1 ${arg_PARTS})
      math(EXPR index "${part} - 1")
      add_test(NAME ${arg_NAME}.part_${part} COMMAND ${arg_NAME})
      set_tests_properties(${arg_NAME}.part_${part} PROPERTIES
        LABELS "${arg_LABELS}" TIMEOUT ${arg_TIMEOUT}
        ENVIRONMENT "GTEST_TOTAL_SHARDS=${arg_PARTS};GTEST_SHARD_INDEX=${index}")
    endforeach()
    return()
  endif()
  include(GoogleTest)
  gtest_discover_tests(${arg_NAME} TEST_PREFIX "${arg_NAME}." DISCOVERY_MODE PRE_TEST DISCOVERY_TIMEOUT 60
                       PROPERTIES LABELS "${arg_LABELS}" TIMEOUT ${arg_TIMEOUT})
endfunction()

# The same without the cases of ctest: the program alone.
function(holdfast_add_conformance_program plugin)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "NAME;PARAMETERS;FOLDER;ENTRY;TIMEOUT;PARTS" "MODULES;EXCEPT;LABELS")
  if(arg_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "holdfast_conformance_test(${plugin}): unknown arguments ${arg_UNPARSED_ARGUMENTS}")
  endif()
  if(NOT TARGET ${plugin})
    message(FATAL_ERROR "holdfast_conformance_test(${plugin}): there is no target ${plugin}; make it by "
                        "holdfast_add_plugin first")
  endif()
  if(NOT TARGET holdfast::conformance)
    message(FATAL_ERROR "holdfast_conformance_test(${plugin}): this Holdfast comes without its conformance tests; "
                        "configure it with -DHOLDFAST_BUILD_CONFORMANCE=ON (and GoogleTest, Debian: libgtest-dev)")
  endif()
  find_package(GTest REQUIRED)
  if(NOT arg_NAME)
    set(arg_NAME ${plugin}_conformance)
  endif()
  if(NOT arg_FOLDER)
    set(arg_FOLDER ${CMAKE_CURRENT_SOURCE_DIR})
  endif()
  if(NOT arg_ENTRY)
    set(arg_ENTRY ${plugin})
  endif()

  set(HOLDFAST_CONFORMANCE_PARAMETERS "${arg_PARAMETERS}")
  foreach(names IN ITEMS MODULES EXCEPT)
    list(TRANSFORM arg_${names} REPLACE "(.+)" "\"\\1\"")
    list(JOIN arg_${names} ", " HOLDFAST_CONFORMANCE_${names})
  endforeach()
  set(source ${CMAKE_CURRENT_BINARY_DIR}/${arg_NAME}.cpp)
  configure_file(${CMAKE_CURRENT_FUNCTION_LIST_DIR}/conformance_main.cpp.in ${source} @ONLY)
  add_executable(${arg_NAME} ${source})
  target_link_libraries(${arg_NAME} PRIVATE holdfast::conformance)
  target_compile_features(${arg_NAME} PRIVATE cxx_std_20)
  set_target_properties(${arg_NAME} PROPERTIES CXX_EXTENSIONS OFF)
  target_compile_definitions(${arg_NAME} PRIVATE HOLDFAST_CONFORMANCE_FOLDER="${arg_FOLDER}")
  get_target_property(type ${plugin} TYPE)
  if(type STREQUAL "STATIC_LIBRARY")
    target_link_libraries(${arg_NAME} PRIVATE ${plugin})
    target_compile_definitions(${arg_NAME} PRIVATE HOLDFAST_CONFORMANCE_ENTRY=holdfast_register_plugin_${arg_ENTRY})
  else()
    add_dependencies(${arg_NAME} ${plugin})
    target_compile_definitions(${arg_NAME} PRIVATE HOLDFAST_CONFORMANCE_FILE="$<TARGET_FILE:${plugin}>")
  endif()
endfunction()
