# SPDX-License-Identifier: BSD-3-Clause
# What configuring says where something is too old or missing: everything at once, each with what to do.
include(${CMAKE_CURRENT_LIST_DIR}/run.cmake)
include(${HOLDFAST_FOLDER}/cmake/HoldfastVersions.cmake)

# expect_problem(TEXT): the problem recorded last, "" for none; forgets it.
function(expect_problem expected)
  get_property(found GLOBAL PROPERTY HOLDFAST_VERSION_PROBLEMS)
  set_property(GLOBAL PROPERTY HOLDFAST_VERSION_PROBLEMS "")
  if(NOT "${found}" STREQUAL "${expected}")
    message(FATAL_ERROR "expected '${expected}', found '${found}'")
  endif()
endfunction()

holdfast_check_version(Eigen3 3.4.0 3.4 libeigen3-dev)
expect_problem("")
holdfast_check_version(Eigen3 3.3.9 3.4 libeigen3-dev)
expect_problem("  Eigen3 3.3.9 is too old; expected 3.4 or later (Debian: libeigen3-dev)\n")
holdfast_check_version(OpenCV 4.10.0 4.5 libopencv-dev BELOW 5)
expect_problem("")
holdfast_check_version(OpenCV 5.0.0 4.5 libopencv-dev BELOW 5 HINT "with a hint")
expect_problem("  OpenCV 5.0.0 is too new; expected 4.5 or later and below 5 (Debian: libopencv-dev); with a hint\n")
holdfast_check_version(OpenCV 4.6.0 4.5 libopencv-dev UNUSABLE BELOW 5 HINT "with dnn")
expect_problem("  OpenCV 4.6.0 is incomplete; expected all its parts (Debian: libopencv-dev); with dnn\n")
holdfast_check_version(Ceres "" 2.1 libceres-dev)
expect_problem("  Ceres was not found; expected 2.1 or later (Debian: libceres-dev)\n")
holdfast_check_compiler(GNU 12.2.0)
expect_problem("")
holdfast_check_compiler(GNU 10.2.1)
expect_problem("  g++ 10.2.1 is too old; expected 12 or later (Debian: g++); name another compiler by -DCMAKE_CXX_COMPILER=g++-12\n")
holdfast_check_compiler(Clang 13.0.1)
expect_problem("  clang++ 13.0.1 is too old; expected 14 or later (Debian: clang); name another compiler by -DCMAKE_CXX_COMPILER=g++\n")
holdfast_check_processor(8 LITTLE_ENDIAN)
expect_problem("")
holdfast_check_processor(4 LITTLE_ENDIAN)
expect_problem("  the compiler's target has 32 bits; expected 64 bits and little-endian: install a 64-bit system (on ARM boards: aarch64, also called arm64), or leave out -m32\n")
holdfast_check_processor(8 BIG_ENDIAN)
expect_problem("  the compiler's target has a big-endian byte order; expected 64 bits and little-endian: maps, bags and depth files are read in the byte order of memory, so that this processor is not supported\n")

# A system with old versions of OpenCV and Ceres, and of nothing else, as Holdfast's own CMake files see it.
set(folder ${WORK_FOLDER}/versions)
file(REMOVE_RECURSE ${folder})
foreach(package IN ITEMS OpenCV=4.2.0 Ceres=2.0.0)
  string(REPLACE "=" ";" parts ${package})
  list(GET parts 0 name)
  list(GET parts 1 version)
  file(WRITE ${folder}/${name}/${name}Config.cmake "set(${name}_FOUND TRUE)\n")
  file(WRITE ${folder}/${name}/${name}ConfigVersion.cmake
    "set(PACKAGE_VERSION ${version})\nif(NOT PACKAGE_VERSION VERSION_LESS PACKAGE_FIND_VERSION)\n"
    "  set(PACKAGE_VERSION_COMPATIBLE TRUE)\nendif()\n")
endforeach()
find_program(NINJA ninja REQUIRED)
execute_process(COMMAND ${CMAKE_COMMAND} -S ${HOLDFAST_FOLDER} -B ${folder}/build -G Ninja -DCMAKE_CXX_COMPILER=${CXX}
                        -DCMAKE_MAKE_PROGRAM=${NINJA} -DOpenCV_DIR=${folder}/OpenCV -DCeres_DIR=${folder}/Ceres
                        -DCMAKE_FIND_USE_CMAKE_SYSTEM_PATH=OFF -DCMAKE_FIND_USE_SYSTEM_ENVIRONMENT_PATH=OFF
                RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
string(REGEX REPLACE "[ \n]+" " " text "${output}")
foreach(expected IN ITEMS "OpenCV 4.2.0 is too old; expected 4.5 or later and below 5 (Debian: libopencv-dev)"
                          "Ceres 2.0.0 is too old; expected 2.1 or later (Debian: libceres-dev)"
                          "-DHOLDFAST_PLUGIN_CERES=OFF builds without"
                          "yaml-cpp was not found; expected 0.7 or later (Debian: libyaml-cpp-dev)"
                          "docs/install.md says")
  string(FIND "${text}" "${expected}" position)
  if(result EQUAL 0 OR position EQUAL -1)
    message(FATAL_ERROR "expected '${expected}', found ${result}:\n${output}")
  endif()
endforeach()

# Options of what is optional: AUTO looks anew each time, so that what was missing once is found when it is there; what
# a user typed stays.
set(folder ${WORK_FOLDER}/optional)
file(REMOVE_RECURSE ${folder})
file(WRITE ${folder}/CMakeLists.txt "cmake_minimum_required(VERSION 3.25)\nproject(optional NONE)\n"
  "include(${HOLDFAST_FOLDER}/cmake/HoldfastOptional.cmake)\n"
  "holdfast_optional(HOLDFAST_PART \"Build a part\" \"the part\" \${FOUND} \"its library was not found\" libpart-dev)\n"
  "holdfast_report_optional()\nmessage(STATUS \"part: \${HOLDFAST_PART}\")\n")
# expect_part(EXPECTED ARGUMENTS ...): what configuring says, in the same build folder as before.
function(expect_part expected)
  execute_process(COMMAND ${CMAKE_COMMAND} -S ${folder} -B ${folder}/build ${ARGN}
                  OUTPUT_VARIABLE output ERROR_VARIABLE output)
  string(REGEX REPLACE "[ \n]+" " " text "${output}")
  string(FIND "${text}" "${expected}" position)
  if(position EQUAL -1)
    message(FATAL_ERROR "expected '${expected}' with ${ARGN}, found:\n${output}")
  endif()
endfunction()
expect_part("built without the part: its library was not found (Debian: libpart-dev) -- part: OFF" -DFOUND=OFF)
expect_part("part: ON" -DFOUND=ON)
expect_part("part: OFF" -DFOUND=OFF)
expect_part("HOLDFAST_PART is ON, but its library was not found: install it (Debian: libpart-dev)" -DHOLDFAST_PART=ON)
expect_part("part: OFF" -DHOLDFAST_PART=OFF -DFOUND=ON)
expect_part("HOLDFAST_PART is 'maybe'; expected AUTO, ON or OFF" -DHOLDFAST_PART=maybe)
