# SPDX-License-Identifier: BSD-3-Clause
# Sets HOLDFAST_HAS_PYTHON: whether the segmenter `python` is built. HOLDFAST_PYTHON is ON (Python must be there), OFF,
# or AUTO (where Python is there).
include_guard()

set(default AUTO)
if(NOT PROJECT_IS_TOP_LEVEL)
  set(default OFF)
endif()
set(HOLDFAST_PYTHON ${default} CACHE STRING "Build the segmenter `python` (pybind11): AUTO, ON or OFF")
set_property(CACHE HOLDFAST_PYTHON PROPERTY STRINGS AUTO ON OFF)
set(HOLDFAST_HAS_PYTHON FALSE)

if(HOLDFAST_PYTHON STREQUAL "AUTO" AND HOLDFAST_SANITIZE)
  set(reason "sanitizers would report Python's own code")
elseif(NOT HOLDFAST_PYTHON AND NOT HOLDFAST_PYTHON STREQUAL "AUTO")
  set(reason "HOLDFAST_PYTHON is ${HOLDFAST_PYTHON}")
else()
  find_package(Python3 3.8 QUIET COMPONENTS Development.Embed)
  # pybind11 would look for a Python of its own; headers are all that is wanted of it.
  set(PYBIND11_NOPYTHON ON)
  find_package(pybind11 2.6 CONFIG QUIET)
  set(missing "")
  if(NOT Python3_Development.Embed_FOUND)
    list(APPEND missing "Python 3.8 (python3-dev)")
  endif()
  if(NOT pybind11_FOUND)
    list(APPEND missing "pybind11 2.6 (pybind11-dev)")
  endif()
  list(JOIN missing " and " reason)
  if(NOT missing)
    set(HOLDFAST_HAS_PYTHON TRUE)
  elseif(HOLDFAST_PYTHON STREQUAL "AUTO")
    set_property(GLOBAL APPEND PROPERTY HOLDFAST_WITHOUT "the segmenter `python`: ${reason} was not found")
    string(APPEND reason " not found; `sh cmake/install_dependencies.sh --python` installs what is needed")
  else()
    message(FATAL_ERROR "HOLDFAST_PYTHON is ${HOLDFAST_PYTHON}, but ${reason} was not found: "
                        "`sh cmake/install_dependencies.sh --python` installs what is needed; -DHOLDFAST_PYTHON=OFF "
                        "builds without the segmenter `python`")
  endif()
endif()

if(HOLDFAST_HAS_PYTHON)
  message(STATUS "Holdfast: segmenter 'python' is built, with Python ${Python3_VERSION} and pybind11 ${pybind11_VERSION}")
else()
  message(STATUS "Holdfast: segmenter 'python' is not built: ${reason}")
endif()
