# SPDX-License-Identifier: BSD-3-Clause
# Installs the build under test, then moves it, so that any path into the first place shows. The fixture of the checks
# that use an installed package.
include(${CMAKE_CURRENT_LIST_DIR}/run.cmake)

file(REMOVE_RECURSE ${WORK_FOLDER}/first ${WORK_FOLDER}/moved)
run(COMMAND ${CMAKE_COMMAND} --install ${BUILD_FOLDER} --prefix ${WORK_FOLDER}/first --config ${CONFIGURATION})
file(RENAME ${WORK_FOLDER}/first ${WORK_FOLDER}/moved)

file(GLOB_RECURSE files ${WORK_FOLDER}/moved/*.cmake ${WORK_FOLDER}/moved/*.pc)
if(NOT files)
  message(FATAL_ERROR "no package file was installed")
endif()
foreach(file IN LISTS files)
  file(READ ${file} text)
  if(text MATCHES "-march|-mtune|-mavx|-msse")
    message(FATAL_ERROR "${file} exports a flag for some processors only")
  endif()
  foreach(folder IN ITEMS ${HOLDFAST_FOLDER} ${BUILD_FOLDER} ${WORK_FOLDER})
    string(FIND "${text}" "${folder}/" position)
    if(NOT position EQUAL -1)
      message(FATAL_ERROR "${file} names ${folder}: the package cannot be moved")
    endif()
  endforeach()
endforeach()

# Everything that a reader of the headers needs lies with them.
file(GLOB_RECURSE headers RELATIVE ${HOLDFAST_FOLDER}/include ${HOLDFAST_FOLDER}/include/*.hpp)
foreach(header IN LISTS headers ITEMS holdfast/core/version.hpp)
  if(NOT EXISTS ${WORK_FOLDER}/moved/include/${header})
    message(FATAL_ERROR "${header} was not installed")
  endif()
endforeach()

# What a shell and `man` look for, and configurations to begin with.
if(EXISTS ${BUILD_FOLDER}/bin/holdfast)
  foreach(file IN ITEMS man/man1/holdfast.1 bash-completion/completions/holdfast zsh/site-functions/_holdfast
                        fish/vendor_completions.d/holdfast.fish holdfast/configs/demo.yaml holdfast/scenes/crowd.yaml)
    if(NOT EXISTS ${WORK_FOLDER}/moved/share/${file})
      message(FATAL_ERROR "share/${file} was not installed")
    endif()
    file(SIZE ${WORK_FOLDER}/moved/share/${file} size)
    if(size LESS 100)
      message(FATAL_ERROR "share/${file} is empty")
    endif()
  endforeach()
  run(COMMAND ${WORK_FOLDER}/moved/bin/holdfast check ${WORK_FOLDER}/moved/share/holdfast/configs/demo.yaml)
  run(COMMAND ${WORK_FOLDER}/moved/bin/holdfast check demo OUTPUT demo)
  if(NOT demo MATCHES "moved/share/holdfast/configs/demo.yaml")
    message(FATAL_ERROR "`check demo` did not find the installed configuration:\n${demo}")
  endif()
endif()
