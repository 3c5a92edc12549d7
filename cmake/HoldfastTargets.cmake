# SPDX-License-Identifier: BSD-3-Clause
# One function per idea, so that a module's CMakeLists.txt reads as a table.
include(GNUInstallDirs)
include(HoldfastAddPlugin)
include(HoldfastConformance)

# What every Holdfast target shares. No global flags: a project that embeds us keeps its own.
function(holdfast_target_defaults target)
  set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE ON CXX_EXTENSIONS OFF)
  target_compile_features(${target} PUBLIC cxx_std_20)
  if(HOLDFAST_WARNINGS)
    target_compile_options(${target} PRIVATE -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor)
    if(HOLDFAST_UNITY)
      # Files that are compiled together see each other's names.
      target_compile_options(${target} PRIVATE -Wno-shadow)
    endif()
    if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
      # False alarms of GCC 12 in its own std::string (bugs 105329, 105562 and 105651), and of designated initialisers
      # that leave a member at its default.
      target_compile_options(${target} PRIVATE -Wno-restrict -Wno-maybe-uninitialized -Wno-stringop-overflow
                                               -Wno-array-bounds -Wno-missing-field-initializers)
    endif()
  endif()
  if(HOLDFAST_WARNINGS_AS_ERRORS)
    target_compile_options(${target} PRIVATE -Werror)
  endif()
  # -ffp-contract=off: the same sums on every processor, whatever the compiler could fuse.
  target_compile_options(${target} PRIVATE -ffp-contract=off)
  if(CMAKE_SYSTEM_PROCESSOR STREQUAL "aarch64" AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    # Eigen fuses by itself where this says that the processor can, which every aarch64 processor can. Its large matrix
    # products do so all the same (docs/arm.md).
    target_compile_options(${target} PRIVATE -U__ARM_FEATURE_FMA)
  endif()
  if(HOLDFAST_SANITIZE)
    list(JOIN HOLDFAST_SANITIZE "," sanitizers)
    target_compile_options(${target} PUBLIC -fsanitize=${sanitizers} -fno-omit-frame-pointer)
    target_link_options(${target} PUBLIC -fsanitize=${sanitizers})
  endif()
endfunction()

# holdfast_add_module(NAME [SOURCES a.cpp ...] [DEPENDS target ...] [PRIVATE_DEPENDS target ...] [INTERNAL])
# The library holdfast_NAME, known as holdfast::NAME in the build tree and after installation alike. Without SOURCES
# it is header-only. INTERNAL ones are not installed: they are archives inside what links them, shared libraries or not.
function(holdfast_add_module name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "INTERNAL" "" "SOURCES;DEPENDS;PRIVATE_DEPENDS")
  set(target holdfast_${name})
  if(arg_SOURCES)
    set(type "")
    if(arg_INTERNAL)
      set(type STATIC)
    endif()
    add_library(${target} ${type} ${arg_SOURCES})
    set(scope PUBLIC)
    holdfast_target_defaults(${target})
    holdfast_precompile(${target})
    set_target_properties(${target} PROPERTIES UNITY_BUILD ${HOLDFAST_UNITY} UNITY_BUILD_BATCH_SIZE 8)
    target_link_libraries(${target} PRIVATE ${arg_PRIVATE_DEPENDS})
  else()
    add_library(${target} INTERFACE)
    set(scope INTERFACE)
    target_compile_features(${target} INTERFACE cxx_std_20)
  endif()
  add_library(holdfast::${name} ALIAS ${target})
  target_include_directories(${target} ${scope}
    $<BUILD_INTERFACE:${holdfast_SOURCE_DIR}/include> $<BUILD_INTERFACE:${holdfast_BINARY_DIR}/include>
    $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  target_link_libraries(${target} ${scope} ${arg_DEPENDS})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name})
  if(NOT arg_INTERNAL)
    set_property(GLOBAL APPEND PROPERTY HOLDFAST_EXPORTED_TARGETS ${target})
  endif()
endfunction()

# holdfast_add_builtin_plugin(NAME SOURCES a.cpp ... [DEPENDS target ...])
# A plugin of ours, linked in: its HOLDFAST_PLUGIN(NAME, registry) entry is called by name from the generated list.
function(holdfast_add_builtin_plugin name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "SOURCES;DEPENDS")
  holdfast_add_module(plugin_${name} SOURCES ${arg_SOURCES} DEPENDS holdfast::interfaces holdfast::plugin ${arg_DEPENDS})
  target_compile_definitions(holdfast_plugin_${name} PRIVATE HOLDFAST_STATIC_PLUGIN)
  target_include_directories(holdfast_plugin_${name} PUBLIC $<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}/include>)
  set_property(GLOBAL APPEND PROPERTY HOLDFAST_BUILTIN_PLUGINS ${name})
endfunction()

# holdfast_add_test(NAME SOURCES a.cpp ... [DEPENDS target ...] [LABELS label ...] [TIMEOUT seconds] [NIGHTLY test ...]
#                   [APART])
# A GoogleTest program; each of its tests becomes a ctest case. Labels: quick (default), slow, data. The tests named
# under NIGHTLY (Suite.Name) have the label nightly instead. APART: the sources use one name for different things, or gain
# nothing from being compiled together.
function(holdfast_add_test name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "APART" "TIMEOUT" "SOURCES;DEPENDS;LABELS;NIGHTLY")
  if(NOT arg_LABELS)
    set(arg_LABELS quick)
  endif()
  if(NOT arg_TIMEOUT)
    set(arg_TIMEOUT 300)
  endif()
  if(CMAKE_CROSSCOMPILING)  # an emulator is about fifteen times slower
    math(EXPR arg_TIMEOUT "20 * ${arg_TIMEOUT}")
  endif()
  add_executable(${name} ${arg_SOURCES})
  holdfast_target_defaults(${name})
  holdfast_precompile(${name} holdfast_precompiled_tests)
  holdfast_compile_quickly(${name})
  target_include_directories(${name} PRIVATE ${holdfast_SOURCE_DIR}/tests)
  target_link_libraries(${name} PRIVATE ${arg_DEPENDS} GTest::gtest GTest::gmock GTest::gtest_main)
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${holdfast_BINARY_DIR}/tests)
  if(NOT arg_APART)
    set_target_properties(${name} PROPERTIES UNITY_BUILD ${HOLDFAST_UNITY} UNITY_BUILD_BATCH_SIZE 16)
  endif()
  include(GoogleTest)
  set(discovery TIMEOUT ${arg_TIMEOUT} DISCOVERY_TIMEOUT 60 DISCOVERY_MODE PRE_TEST)
  list(JOIN arg_NIGHTLY ":" nightly)
  if(nightly)
    gtest_discover_tests(${name} TEST_FILTER "${nightly}" TEST_LIST ${name}_nightly PROPERTIES LABELS nightly ${discovery})
    set(others TEST_FILTER "-${nightly}")
  endif()
  gtest_discover_tests(${name} ${others} PROPERTIES LABELS "${arg_LABELS}" ${discovery})
endfunction()
