# SPDX-License-Identifier: BSD-3-Clause
# Installs the build under test, then moves it, so that any path into the first place shows. The fixture of the checks
# that use an installed package.
include(${CMAKE_CURRENT_LIST_DIR}/run.cmake)

file(REMOVE_RECURSE ${WORK_FOLDER}/first ${WORK_FOLDER}/moved)
run(COMMAND ${CMAKE_COMMAND} --install ${BUILD_FOLDER} --prefix ${WORK_FOLDER}/first --config ${CONFIGURATION})
file(RENAME ${WORK_FOLDER}/first ${WORK_FOLDER}/moved)

file(GLOB_RECURSE files ${WORK_FOLDER}/moved/*.cmake)
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
