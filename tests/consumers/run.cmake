# SPDX-License-Identifier: BSD-3-Clause
# Shared by the check_*.cmake scripts, which ctest runs with -DHOLDFAST_FOLDER (the sources), -DBUILD_FOLDER (where they
# are built), -DWORK_FOLDER (ours alone), -DCXX, -DCONFIGURATION and, where it was found, -DCCACHE.

# run(COMMAND ...): stops with all output when the command fails. OUTPUT <variable> hands over what it printed.
function(run)
  cmake_parse_arguments(PARSE_ARGV 0 arg "" "OUTPUT" "COMMAND")
  execute_process(COMMAND ${arg_COMMAND} RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT result EQUAL 0)
    list(JOIN arg_COMMAND " " command)
    message(FATAL_ERROR "failed with ${result}: ${command}\n${output}")
  endif()
  if(arg_OUTPUT)
    set(${arg_OUTPUT} "${output}" PARENT_SCOPE)
  endif()
endfunction()

# configure(SOURCE BUILD [argument ...] [OUTPUT variable]): from nothing, with the compiler of the build under test. No
# build type: unoptimised code compiles fastest, and consumers need not build as we do.
function(configure source build)
  cmake_parse_arguments(PARSE_ARGV 2 arg "" "OUTPUT" "")
  file(REMOVE_RECURSE ${build})
  set(launcher "")
  if(CCACHE)
    set(launcher -DCMAKE_CXX_COMPILER_LAUNCHER=${CCACHE})
  endif()
  run(COMMAND ${CMAKE_COMMAND} -S ${source} -B ${build} -G Ninja -DCMAKE_CXX_COMPILER=${CXX} ${launcher}
              ${arg_UNPARSED_ARGUMENTS} OUTPUT output)
  if(arg_OUTPUT)
    set(${arg_OUTPUT} "${output}" PARENT_SCOPE)
  endif()
endfunction()

# check_libraries(FILE): what a program or library loads lies neither where Holdfast was built nor in its sources, and
# all of it is found.
function(check_libraries file)
  run(COMMAND ldd ${file} OUTPUT libraries)
  foreach(folder IN ITEMS ${HOLDFAST_FOLDER}/modules ${HOLDFAST_FOLDER}/plugins ${BUILD_FOLDER}/modules
                          ${BUILD_FOLDER}/plugins ${WORK_FOLDER}/first "not found")
    string(FIND "${libraries}" "${folder}" position)
    if(NOT position EQUAL -1)
      message(FATAL_ERROR "${file} loads what it must not, or misses it (${folder}):\n${libraries}")
    endif()
  endforeach()
  run(COMMAND readelf --dynamic ${file} OUTPUT entries)
  string(FIND "${entries}" "${BUILD_FOLDER}/modules" position)
  if(NOT position EQUAL -1)
    message(FATAL_ERROR "${file} looks for libraries where Holdfast was built:\n${entries}")
  endif()
endfunction()
