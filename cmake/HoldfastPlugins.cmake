# SPDX-License-Identifier: BSD-3-Clause
# The plugins of this repository. Each has an option HOLDFAST_PLUGIN_<NAME>, so that a program which embeds Holdfast can
# leave out a plugin and the libraries that only this plugin needs. The name is that of the module that it registers.
include_guard()
include(HoldfastOptional)

# Kind of the modules, name, folder below plugins/.
set(HOLDFAST_PLUGIN_TABLE
  "source          euroc                 sources/euroc"
  "source          folder                sources/folder"
  "source          four_seasons          sources/four_seasons"
  "source          icl_nuim              sources/icl_nuim"
  "source          kitti                 sources/kitti"
  "source          openloris             sources/openloris"
  "source          openni2               sources/openni2"
  "source          phone                 sources/phone"
  "source          rosbag                sources/rosbag"
  "source          simulated             sources/simulated"
  "source          tum                   sources/tum"
  "source          v4l2                  sources/v4l2"
  "features        akaze                 features/akaze"
  "features        onnx_features         features/onnx_features"
  "features        opencv_orb            features/opencv_orb"
  "features        orb                   features/orb"
  "features        sift                  features/sift"
  "matcher         mutual_ratio          matchers/mutual_ratio"
  "matcher         onnx_matcher          matchers/onnx_matcher"
  "filters         depth_clusters        filters/depth_clusters"
  "filters         inertial_consistency  filters/inertial_consistency"
  "filters         motion_objects        filters/motion_objects"
  "filters         multi_view_depth      filters/multi_view_depth"
  "filters         reprojection_error    filters/reprojection_error"
  "filters         semantic_mask         filters/semantic_mask"
  "filters         epipolar_consistency  filters/epipolar_consistency"
  "loop_detector   flann                 loop_detectors/flann"
  "loop_detector   global                loop_detectors/global"
  "observers       class_motion          observers/class_motion"
  "observers       foxglove              observers/foxglove"
  "observers       health                observers/health"
  "observers       mcap                  observers/mcap"
  "observers       objects               observers/objects"
  "observers       overlay               observers/overlay"
  "observers       viewer                observers/viewer"
  "optimizer       ceres                 optimizers/ceres"
  "optimizer       schur                 optimizers/schur"
  "segmenter       onnx                  segmenters/onnx"
  "segmenter       precomputed           segmenters/precomputed"
  "segmenter       python                segmenters/python"
  "segmenter       truth                 segmenters/simulated_truth"
  "segmenter       unet                  segmenters/unet"
)

# Plugins that need a library, which are looked for early, because their options depend on them. Where it is missing,
# and the option AUTO, a plugin is still linked in: it knows its parameters, so that the reference is the same in every
# build, and says what is missing where it is asked for.
# holdfast_plugin_needs(NAME MISSING PACKAGES VARIABLE ...): the variables say where it was found.
function(holdfast_plugin_needs name missing packages)
  set(found ON)
  foreach(variable IN LISTS ARGN)
    mark_as_advanced(${variable})
    if(NOT ${variable})
      set(found OFF)
    endif()
  endforeach()
  set(HOLDFAST_PLUGIN_FOUND_${name} ${found} PARENT_SCOPE)
  set(HOLDFAST_PLUGIN_MISSING_${name} "${missing}" PARENT_SCOPE)
  set(HOLDFAST_PLUGIN_PACKAGES_${name} "${packages}" PARENT_SCOPE)
endfunction()

find_path(HOLDFAST_BOOST_INCLUDE_DIR boost/beast/version.hpp)
holdfast_plugin_needs(viewer "Boost.Beast was not found" libboost-dev HOLDFAST_BOOST_INCLUDE_DIR)
holdfast_plugin_needs(foxglove "Boost.Beast was not found" libboost-dev HOLDFAST_BOOST_INCLUDE_DIR)
find_path(HOLDFAST_LZ4_INCLUDE_DIR lz4frame.h)
find_library(HOLDFAST_LZ4_LIBRARY lz4)
find_path(HOLDFAST_BZ2_INCLUDE_DIR bzlib.h)
find_library(HOLDFAST_BZ2_LIBRARY bz2)
holdfast_plugin_needs(rosbag "lz4 or bzip2 was not found" "liblz4-dev libbz2-dev"
  HOLDFAST_LZ4_INCLUDE_DIR HOLDFAST_LZ4_LIBRARY HOLDFAST_BZ2_INCLUDE_DIR HOLDFAST_BZ2_LIBRARY)
find_path(HOLDFAST_OPENNI2_INCLUDE_DIR OpenNI.h PATH_SUFFIXES openni2)
find_library(HOLDFAST_OPENNI2_LIBRARY OpenNI2)
holdfast_plugin_needs(openni2 "OpenNI 2 was not found" libopenni2-dev HOLDFAST_OPENNI2_INCLUDE_DIR HOLDFAST_OPENNI2_LIBRARY)

set(HOLDFAST_PLUGIN_FOLDERS "")       # of the plugins that are built
set(HOLDFAST_SETTINGS_INCLUDES "")    # of their settings, as C++
set(HOLDFAST_LEFT_OUT "")             # options of the plugins that are not built
set(HOLDFAST_LEFT_OUT_CALLS "")       # registering these, as C++
set(HOLDFAST_LEFT_OUT_SETTINGS "")    # headers of their settings
foreach(row IN LISTS HOLDFAST_PLUGIN_TABLE)
  string(REGEX MATCHALL "[^ ]+" row "${row}")
  list(POP_FRONT row kind name folder)
  string(TOUPPER HOLDFAST_PLUGIN_${name} option)
  set(help "Build the plugin `${name}` (${kind})")
  set(without "")
  if(DEFINED HOLDFAST_PLUGIN_FOUND_${name})
    holdfast_optional(${option} "${help}" "the plugin `${name}`" ${HOLDFAST_PLUGIN_FOUND_${name}}
                      "${HOLDFAST_PLUGIN_MISSING_${name}}" "${HOLDFAST_PLUGIN_PACKAGES_${name}}")
    if(holdfast_optional_value STREQUAL "AUTO" AND NOT ${option})
      set(without "${HOLDFAST_PLUGIN_MISSING_${name}} when Holdfast was configured; install it (Debian: ")
      string(APPEND without "${HOLDFAST_PLUGIN_PACKAGES_${name}}), configure and build again")
    endif()
  else()
    option(${option} "${help}" ON)
  endif()
  set(settings holdfast/settings/${name}.hpp)
  if(${option})
    list(APPEND HOLDFAST_PLUGIN_FOLDERS ${folder})
    if(EXISTS ${holdfast_SOURCE_DIR}/include/${settings})
      string(APPEND HOLDFAST_SETTINGS_INCLUDES "#include \"${settings}\"\n")
    endif()
  else()
    if(without)
      list(APPEND HOLDFAST_PLUGIN_FOLDERS ${folder})
      string(APPEND HOLDFAST_LEFT_OUT_CALLS "  registry.add_unusable(\"${kind}\", \"${name}\", \"${without}\");\n")
    else()
      string(APPEND HOLDFAST_LEFT_OUT_CALLS "  registry.add_left_out(\"${kind}\", \"${name}\", \"${option}\");\n")
    endif()
    # The tests of a plugin that needs a library are left out with it.
    if(NOT DEFINED HOLDFAST_PLUGIN_FOUND_${name})
      list(APPEND HOLDFAST_LEFT_OUT ${option})
    endif()
    list(APPEND HOLDFAST_LEFT_OUT_SETTINGS ${settings})
    if(name STREQUAL "viewer")
      list(APPEND HOLDFAST_LEFT_OUT_SETTINGS holdfast/viewer/viewer.hpp)
    endif()
  endif()
endforeach()
if(HOLDFAST_LEFT_OUT AND (HOLDFAST_BUILD_TESTS OR HOLDFAST_BUILD_EXAMPLES OR HOLDFAST_BUILD_BENCHMARKS))
  list(JOIN HOLDFAST_LEFT_OUT ", " options)
  message(FATAL_ERROR "Tests, examples and benchmarks use every plugin, but ${options} is OFF: configure with "
          "-DHOLDFAST_BUILD_TESTS=OFF -DHOLDFAST_BUILD_EXAMPLES=OFF -DHOLDFAST_BUILD_BENCHMARKS=OFF, or with all plugins")
endif()
# Optional parts of the source `rosbag`.
find_path(HOLDFAST_ZSTD_INCLUDE_DIR zstd.h)
find_library(HOLDFAST_ZSTD_LIBRARY zstd)
find_path(HOLDFAST_SQLITE_INCLUDE_DIR sqlite3.h)
find_library(HOLDFAST_SQLITE_LIBRARY sqlite3)
mark_as_advanced(HOLDFAST_ZSTD_INCLUDE_DIR HOLDFAST_ZSTD_LIBRARY HOLDFAST_SQLITE_INCLUDE_DIR HOLDFAST_SQLITE_LIBRARY)
if(HOLDFAST_PLUGIN_ROSBAG)
  set(found OFF)
  if(HOLDFAST_ZSTD_INCLUDE_DIR AND HOLDFAST_ZSTD_LIBRARY)
    set(found ON)
  endif()
  holdfast_optional(HOLDFAST_ZSTD "Decompress bags by zstd" "bags that zstd compressed" ${found} "zstd was not found"
                    libzstd-dev)
  set(found OFF)
  if(HOLDFAST_SQLITE_INCLUDE_DIR AND HOLDFAST_SQLITE_LIBRARY)
    set(found ON)
  endif()
  holdfast_optional(HOLDFAST_SQLITE "Read bags of ROS 2 in SQLite" "bags of ROS 2 in SQLite" ${found}
                    "SQLite was not found" libsqlite3-dev)
endif()
# An optional part of the source `phone`.
find_path(HOLDFAST_OPENEXR_INCLUDE_DIR OpenEXR/ImfInputFile.h)
find_path(HOLDFAST_IMATH_INCLUDE_DIR ImathBox.h PATH_SUFFIXES Imath)
find_library(HOLDFAST_OPENEXR_LIBRARY OpenEXR)
find_library(HOLDFAST_IMATH_LIBRARY Imath)
mark_as_advanced(HOLDFAST_OPENEXR_INCLUDE_DIR HOLDFAST_IMATH_INCLUDE_DIR HOLDFAST_OPENEXR_LIBRARY HOLDFAST_IMATH_LIBRARY)
if(HOLDFAST_PLUGIN_PHONE)
  set(found OFF)
  if(HOLDFAST_OPENEXR_INCLUDE_DIR AND HOLDFAST_IMATH_INCLUDE_DIR AND HOLDFAST_OPENEXR_LIBRARY AND HOLDFAST_IMATH_LIBRARY)
    set(found ON)
  endif()
  holdfast_optional(HOLDFAST_OPENEXR "Read depth of Record3D" "depth of Record3D in the source `phone`" ${found}
                    "OpenEXR 3 was not found" libopenexr-dev)
endif()
configure_file(${CMAKE_CURRENT_LIST_DIR}/settings_all.hpp.in ${holdfast_BINARY_DIR}/include/holdfast/settings/all.hpp
               @ONLY)

# Networks: a module that only plugins use.
set(HOLDFAST_INFERENCE OFF)
if(HOLDFAST_PLUGIN_GLOBAL OR HOLDFAST_PLUGIN_ONNX OR HOLDFAST_PLUGIN_ONNX_FEATURES OR HOLDFAST_PLUGIN_ONNX_MATCHER OR
   HOLDFAST_PLUGIN_UNET)
  set(HOLDFAST_INFERENCE ON)
endif()
