# SPDX-License-Identifier: BSD-3-Clause
include_guard()

# holdfast_add_benchmark(NAME SOURCES a.cpp ... [DEPENDS target ...])
# A Google Benchmark program in <build>/bin. It is not a test: times say nothing on a busy machine.
function(holdfast_add_benchmark name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "SOURCES;DEPENDS")
  add_executable(${name} ${arg_SOURCES})
  holdfast_target_defaults(${name})
  target_link_libraries(${name} PRIVATE ${arg_DEPENDS} benchmark::benchmark)
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${holdfast_BINARY_DIR}/bin)
endfunction()
