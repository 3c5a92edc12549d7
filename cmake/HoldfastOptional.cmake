# SPDX-License-Identifier: BSD-3-Clause
# Parts that are built where a library is found. Their options have three values: AUTO, the default, looks for the
# library each time that CMake configures; ON makes its absence an error; OFF leaves the part out. What AUTO left out is
# listed at the end of configuring, by `holdfast --version` and by `holdfast modules`.
include_guard()

# holdfast_optional(OPTION HELP PART FOUND MISSING PACKAGES): sets the variable OPTION to ON or OFF. PART is what the
# option builds, for messages; FOUND whether it can be built; MISSING why it cannot ("OpenNI 2 was not found");
# PACKAGES are Debian's names of what is needed.
macro(holdfast_optional option help part found missing packages)
  set(${option} AUTO CACHE STRING "${help}: AUTO (where its library is found), ON or OFF")
  set_property(CACHE ${option} PROPERTY STRINGS AUTO ON OFF)
  string(TOUPPER "${${option}}" holdfast_optional_value)
  if(NOT holdfast_optional_value MATCHES "^(AUTO|ON|OFF|TRUE|FALSE|YES|NO|1|0)$")
    message(FATAL_ERROR "${option} is '${${option}}'; expected AUTO, ON or OFF")
  elseif(holdfast_optional_value STREQUAL "AUTO")
    if(${found})
      set(${option} ON)
    else()
      set(${option} OFF)
      set_property(GLOBAL APPEND PROPERTY HOLDFAST_WITHOUT "${part}: ${missing} (Debian: ${packages})")
    endif()
  elseif(${option} AND NOT ${found})
    message(FATAL_ERROR "${option} is ON, but ${missing}: install it (Debian: ${packages}), or configure with "
                        "-D${option}=AUTO, which builds without ${part}")
  endif()
endmacro()

# Lists what AUTO left out.
function(holdfast_report_optional)
  get_property(without GLOBAL PROPERTY HOLDFAST_WITHOUT)
  foreach(part IN LISTS without)
    message(STATUS "Holdfast: built without ${part}")
  endforeach()
endfunction()
