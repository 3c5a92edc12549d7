# SPDX-License-Identifier: BSD-3-Clause
# The oldest versions that Holdfast is built with, and what configuring says where something is older or missing: all of
# it at once, each with what was found, what was expected and how to get it. docs/install.md has a table by system.
include_guard()

# holdfast_check_version(NAME FOUND MINIMUM PACKAGE [UNUSABLE] [BELOW version] [HINT text])
# Records a problem unless FOUND ("" for missing) is at least MINIMUM and below BELOW. PACKAGE is Debian's name; UNUSABLE
# is a problem whatever the version is.
function(holdfast_check_version name found minimum package)
  cmake_parse_arguments(PARSE_ARGV 4 arg "UNUSABLE" "BELOW;HINT" "")
  set(expected "${minimum} or later")
  if(arg_BELOW)
    string(APPEND expected " and below ${arg_BELOW}")
  endif()
  if(found STREQUAL "")
    set(problem "was not found; expected ${expected}")
  elseif(found VERSION_LESS minimum)
    set(problem "${found} is too old; expected ${expected}")
  elseif(arg_BELOW AND NOT found VERSION_LESS arg_BELOW)
    set(problem "${found} is too new; expected ${expected}")
  elseif(arg_UNUSABLE)
    set(problem "${found} is incomplete; expected all its parts")
  else()
    return()
  endif()
  string(APPEND problem " (Debian: ${package})")
  if(arg_HINT)
    string(APPEND problem "; ${arg_HINT}")
  endif()
  set_property(GLOBAL APPEND_STRING PROPERTY HOLDFAST_VERSION_PROBLEMS "  ${name} ${problem}\n")
endfunction()

# The processor: holdfast/core/platform.hpp checks the same for programs that are built on an installed Holdfast.
function(holdfast_check_processor pointer_bytes byte_order)
  if(pointer_bytes STREQUAL "")
    return()  # CMake could not find out
  elseif(NOT pointer_bytes EQUAL 8)
    math(EXPR bits "8 * ${pointer_bytes}")
    set(problem "${bits} bits")
    set(remedy "install a 64-bit system (on ARM boards: aarch64, also called arm64), or leave out -m32")
  elseif(NOT byte_order STREQUAL "LITTLE_ENDIAN")
    set(problem "a big-endian byte order")
    set(remedy "maps, bags and depth files are read in the byte order of memory, so that this processor is not supported")
  else()
    return()
  endif()
  set_property(GLOBAL APPEND_STRING PROPERTY HOLDFAST_VERSION_PROBLEMS
    "  the compiler's target has ${problem}; expected 64 bits and little-endian: ${remedy}\n")
endfunction()

# The compiler, whose C++20 is what matters.
function(holdfast_check_compiler id version)
  if(id STREQUAL "GNU")
    holdfast_check_version("g++" "${version}" 12 g++ HINT "name another compiler by -DCMAKE_CXX_COMPILER=g++-12")
  elseif(id STREQUAL "Clang")
    holdfast_check_version("clang++" "${version}" 14 clang HINT "name another compiler by -DCMAKE_CXX_COMPILER=g++")
  else()
    message(WARNING "Holdfast was never compiled by ${id} ${version}; g++ and clang++ are known to work")
  endif()
endfunction()

# holdfast_find(NAME MINIMUM PACKAGE [BELOW version] [HINT text] [ARGUMENTS ...]): find_package(NAME ARGUMENTS ...), of
# which a missing or too old version is reported by holdfast_report_versions(). A macro, for the package's variables.
macro(holdfast_find name minimum package)
  cmake_parse_arguments(holdfast_find "" "BELOW;HINT" "ARGUMENTS" ${ARGN})
  find_package(${name} ${minimum} QUIET ${holdfast_find_ARGUMENTS})
  if(NOT ${name}_FOUND)
    # What was found but not taken; any of several is as good.
    set(holdfast_find_version "")
    if(${name}_CONSIDERED_VERSIONS)
      list(GET ${name}_CONSIDERED_VERSIONS 0 holdfast_find_version)
    endif()
    holdfast_check_version(${name} "${holdfast_find_version}" ${minimum} "${package}" UNUSABLE
                           BELOW "${holdfast_find_BELOW}" HINT "${holdfast_find_HINT}")
  endif()
endmacro()

# Stops with everything that was recorded.
function(holdfast_report_versions)
  get_property(problems GLOBAL PROPERTY HOLDFAST_VERSION_PROBLEMS)
  if(problems)
    message(FATAL_ERROR "Holdfast cannot be built with what is installed here:\n${problems}"
                        "On Debian `sh cmake/install_dependencies.sh` installs what is needed; docs/install.md "
                        "says how to get it on other systems.")
  endif()
endfunction()
