# SPDX-License-Identifier: BSD-3-Clause
add_executable(simulation_benchmark ${CMAKE_CURRENT_LIST_DIR}/simulation_benchmark.cpp)
holdfast_target_defaults(simulation_benchmark)
target_link_libraries(simulation_benchmark PRIVATE holdfast::simulation benchmark::benchmark)
