# SPDX-License-Identifier: BSD-3-Clause
# Installed with the package: what a third party's CMakeLists.txt may call.
include_guard()

# holdfast_add_plugin(NAME SOURCES a.cpp ... [DEPENDS target ...] [STATIC])
# A third party's plugin: NAME.so (libNAME.so) to be named under `plugins:` in the YAML, or, with STATIC, a library
# whose entry function holdfast_register_plugin_NAME the program calls itself.
function(holdfast_add_plugin name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "STATIC" "" "SOURCES;DEPENDS")
  if(arg_STATIC)
    add_library(${name} STATIC ${arg_SOURCES})
    target_compile_definitions(${name} PRIVATE HOLDFAST_STATIC_PLUGIN)
  else()
    add_library(${name} MODULE ${arg_SOURCES})
    set_target_properties(${name} PROPERTIES CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
  endif()
  set_target_properties(${name} PROPERTIES POSITION_INDEPENDENT_CODE ON CXX_EXTENSIONS OFF)
  target_compile_features(${name} PRIVATE cxx_std_20)
  target_link_libraries(${name} PRIVATE holdfast::interfaces holdfast::plugin ${arg_DEPENDS})
endfunction()
