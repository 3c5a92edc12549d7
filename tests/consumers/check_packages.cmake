# SPDX-License-Identifier: BSD-3-Clause
# Debian packages of the build under test, unpacked into a clean root: their dependencies are said, the program runs,
# and a consumer builds on the library.
include(${CMAKE_CURRENT_LIST_DIR}/run.cmake)

find_program(DPKG_DEB dpkg-deb)
find_program(CPACK cpack)
if(NOT DPKG_DEB OR NOT CPACK OR NOT EXISTS ${BUILD_FOLDER}/bin/holdfast)
  message("skipped: needs dpkg-deb, cpack and the program")
  return()
endif()

set(folder ${WORK_FOLDER}/packages)
file(REMOVE_RECURSE ${folder})
file(MAKE_DIRECTORY ${folder}/root)
run(COMMAND ${CPACK} -G DEB -B ${folder} --config ${BUILD_FOLDER}/CPackConfig.cmake -C "${CONFIGURATION}"
            -D CPACK_DEBIAN_COMPRESSION_TYPE=gzip)
file(GLOB packages ${folder}/*.deb)
list(LENGTH packages number)
# The segmenter `python` and the Python package, where they were built, are one more each.
file(GLOB_RECURSE python_plugins ${BUILD_FOLDER}/lib*/*holdfast_python.so)
file(GLOB extensions ${BUILD_FOLDER}/python/holdfast/_core.*.so)
list(APPEND python_plugins ${extensions})
list(LENGTH python_plugins python_packages)
math(EXPR expected_number "3 + ${python_packages}")
if(NOT number EQUAL expected_number)
  message(FATAL_ERROR "expected ${expected_number} packages, found ${packages}")
endif()

set(fields "")
foreach(package IN LISTS packages)
  run(COMMAND ${DPKG_DEB} --field ${package} Package Version Depends OUTPUT text)
  string(APPEND fields "${text}\n")
  run(COMMAND ${DPKG_DEB} --extract ${package} ${folder}/root)
endforeach()
foreach(expected IN ITEMS "Package: holdfast\n" "Package: libholdfast\n" "Package: libholdfast-dev\n"
                          "Depends: libholdfast [(]= [0-9.]+[)], libeigen3-dev, libopencv-dev")
  if(NOT fields MATCHES "${expected}")
    message(FATAL_ERROR "no '${expected}' in\n${fields}")
  endif()
endforeach()
find_program(SHLIBDEPS dpkg-shlibdeps)
if(SHLIBDEPS AND NOT fields MATCHES "libopencv-core[0-9]")
  message(FATAL_ERROR "the program's package does not say which libraries it needs:\n${fields}")
endif()

check_libraries(${folder}/root/usr/bin/holdfast)
run(COMMAND ${folder}/root/usr/bin/holdfast modules orb OUTPUT reference)
if(NOT reference MATCHES "fast_threshold")
  message(FATAL_ERROR "the packaged program does not know its modules:\n${reference}")
endif()
find_program(PYTHON python3 PATHS /usr/bin NO_DEFAULT_PATH)  # the one that the package depends on
if(extensions AND PYTHON)
  run(COMMAND ${CMAKE_COMMAND} -E env PYTHONPATH=${folder}/root/usr/lib/python3/dist-packages ${PYTHON} -m holdfast
              modules orb OUTPUT reference)
  if(NOT reference MATCHES "fast_threshold" OR NOT fields MATCHES "Package: python3-holdfast\n")
    message(FATAL_ERROR "the packaged Python package does not work:\n${reference}\n${fields}")
  endif()
endif()
set(build ${WORK_FOLDER}/packaged)
configure(${CMAKE_CURRENT_LIST_DIR}/installed ${build} -DCMAKE_PREFIX_PATH=${folder}/root/usr)
run(COMMAND ${CMAKE_COMMAND} --build ${build})
run(COMMAND ${build}/consumer)
