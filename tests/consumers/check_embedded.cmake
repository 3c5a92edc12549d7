# SPDX-License-Identifier: BSD-3-Clause
# add_subdirectory: a program on two modules builds and runs, and the project around it stays as it was.
include(${CMAKE_CURRENT_LIST_DIR}/run.cmake)

set(build ${WORK_FOLDER}/embedded)
configure(${CMAKE_CURRENT_LIST_DIR}/embedded ${build} -DHOLDFAST_FOLDER=${HOLDFAST_FOLDER}
          -DCMAKE_EXPORT_COMPILE_COMMANDS=ON OUTPUT configured)
run(COMMAND ${CMAKE_COMMAND} --build ${build} --target consumer --parallel 2 OUTPUT built)
run(COMMAND ${build}/consumer)
if(EXISTS ${build}/holdfast/modules/tracking/libholdfast_tracking.a)
  message(FATAL_ERROR "a module that nobody asked for was built")
endif()
if("${configured}${built}" MATCHES "[Ww]arning:|CMake Warning")
  message(FATAL_ERROR "there was a warning:\n${configured}\n${built}")
endif()

# No install rule: nothing of ours appears when the project installs itself.
file(GLOB_RECURSE scripts ${build}/holdfast/cmake_install.cmake)
foreach(script IN LISTS scripts)
  file(READ ${script} text)
  if(text MATCHES "file\\(INSTALL")
    message(FATAL_ERROR "${script} installs something, and nobody asked")
  endif()
endforeach()

# The only flags that come to the project's own files are the language and where headers lie.
file(READ ${build}/compile_commands.json commands)
string(REGEX MATCH "\"command\": \"[^\"]*embedded/main.cpp\"" command "${commands}")
if(NOT command)
  message(FATAL_ERROR "the command that compiles main.cpp was not found")
endif()
string(REGEX MATCHALL " -[-a-zA-Z][^ ]*" flags "${command}")
list(FILTER flags EXCLUDE REGEX "^ -(std=|I|isystem|o|c$|Wall|Wextra|Wpedantic|Werror)")
if(flags OR commands MATCHES "-march|-mtune")
  message(FATAL_ERROR "flags came along (or one for a processor): '${flags}' in\n${command}")
endif()
