# SPDX-License-Identifier: BSD-3-Clause
# docs/reference.md is what the program prints. Run by ctest with -DPROGRAM, -DPAGE and -DWORK.
set(printed ${WORK}/reference.md)
execute_process(COMMAND ${PROGRAM} modules --markdown OUTPUT_FILE ${printed} RESULT_VARIABLE result)
if(NOT result EQUAL 0)
  message(FATAL_ERROR "`holdfast modules --markdown` ended with ${result}")
endif()
execute_process(COMMAND ${CMAKE_COMMAND} -E compare_files ${printed} ${PAGE} RESULT_VARIABLE result)
if(NOT result EQUAL 0)
  message(FATAL_ERROR "${PAGE} is not what the program prints. Make it anew, and look at what changed:\n"
                      "  build/bin/holdfast modules --markdown > docs/reference.md")
endif()
