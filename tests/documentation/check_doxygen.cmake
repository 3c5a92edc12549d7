# SPDX-License-Identifier: BSD-3-Clause
# Doxygen has nothing to say against the comments of the public headers, and every class, struct and enumeration of a
# namespace has one. Run by ctest with -DDOXYGEN, -DSOURCES and -DWORK.
set(output ${WORK}/doxygen)
file(REMOVE_RECURSE ${output})
file(MAKE_DIRECTORY ${output})
# As in the root of the repository, but with what it writes here.
file(READ ${SOURCES}/docs/Doxyfile settings)
string(REPLACE "= include" "= ${SOURCES}/include" settings "${settings}")
string(REPLACE "docs/api.dox" "${SOURCES}/docs/api.dox" settings "${settings}")
file(WRITE ${output}/Doxyfile "${settings}\nWARN_IF_UNDOCUMENTED = YES\n")
execute_process(COMMAND ${DOXYGEN} Doxyfile WORKING_DIRECTORY ${output}
                RESULT_VARIABLE result OUTPUT_VARIABLE warnings ERROR_VARIABLE warnings)
# A member whose name and type say all needs no comment.
string(REGEX REPLACE "[^\n]*warning: Member [^\n]* is not documented\\.\n" "" warnings "${warnings}")
if(NOT result EQUAL 0 OR NOT warnings MATCHES "^[ \n]*$")
  message(FATAL_ERROR "doxygen docs/Doxyfile (result ${result}) says:\n${warnings}")
endif()
foreach(page IN ITEMS index classholdfast_1_1Pipeline classholdfast_1_1Segmenter structholdfast_1_1Camera)
  if(NOT EXISTS ${output}/out/api/${page}.html)
    message(FATAL_ERROR "there is no page ${page}.html")
  endif()
endforeach()
file(REMOVE_RECURSE ${output})
