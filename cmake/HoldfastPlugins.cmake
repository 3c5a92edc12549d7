# SPDX-License-Identifier: BSD-3-Clause
# The plugins of this repository. Each has an option HOLDFAST_PLUGIN_<NAME>, so that a program which embeds Holdfast can
# leave out a plugin and the libraries that only this plugin needs. The name is that of the module that it registers.
include_guard()

# Kind of the modules, name, folder below plugins/.
set(HOLDFAST_PLUGIN_TABLE
  "source          euroc                 sources/euroc"
  "source          folder                sources/folder"
  "source          icl_nuim              sources/icl_nuim"
  "source          kitti                 sources/kitti"
  "source          openni2               sources/openni2"
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
  "filters         motion_objects        filters/motion_objects"
  "filters         multi_view_depth      filters/multi_view_depth"
  "filters         reprojection_error    filters/reprojection_error"
  "filters         semantic_mask         filters/semantic_mask"
  "filters         epipolar_consistency  filters/epipolar_consistency"
  "loop_detector   flann                 loop_detectors/flann"
  "loop_detector   global                loop_detectors/global"
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

# Plugins that are built where their libraries are; ours to look for early, because their options depend on them.
# holdfast_optional_plugin(NAME WHAT PACKAGES VARIABLE ...): what is needed, and the variables of where it was found.
set(HOLDFAST_OPTIONAL_PLUGINS "")
function(holdfast_optional_plugin name what packages)
  set(HOLDFAST_PLUGIN_DEFAULT_${name} ON)
  foreach(variable IN LISTS ARGN)
    mark_as_advanced(${variable})
    if(NOT ${variable})
      set(HOLDFAST_PLUGIN_DEFAULT_${name} OFF)
    endif()
  endforeach()
  list(APPEND HOLDFAST_OPTIONAL_PLUGINS ${name})
  set(HOLDFAST_OPTIONAL_PLUGINS ${HOLDFAST_OPTIONAL_PLUGINS} PARENT_SCOPE)
  set(HOLDFAST_PLUGIN_DEFAULT_${name} ${HOLDFAST_PLUGIN_DEFAULT_${name}} PARENT_SCOPE)
  set(HOLDFAST_PLUGIN_WHAT_${name} "${what}" PARENT_SCOPE)
  set(HOLDFAST_PLUGIN_PACKAGES_${name} "${packages}" PARENT_SCOPE)
endfunction()

find_path(HOLDFAST_BOOST_INCLUDE_DIR boost/beast/version.hpp)
holdfast_optional_plugin(viewer "Boost.Beast" libboost-dev HOLDFAST_BOOST_INCLUDE_DIR)
find_path(HOLDFAST_LZ4_INCLUDE_DIR lz4frame.h)
find_path(HOLDFAST_BZ2_INCLUDE_DIR bzlib.h)
find_library(HOLDFAST_BZ2_LIBRARY bz2)
holdfast_optional_plugin(rosbag "lz4 or bzip2" "liblz4-dev libbz2-dev"
  HOLDFAST_LZ4_INCLUDE_DIR HOLDFAST_BZ2_INCLUDE_DIR HOLDFAST_BZ2_LIBRARY)
find_path(HOLDFAST_OPENNI2_INCLUDE_DIR OpenNI.h PATH_SUFFIXES openni2)
find_library(HOLDFAST_OPENNI2_LIBRARY OpenNI2)
holdfast_optional_plugin(openni2 "OpenNI 2" libopenni2-dev HOLDFAST_OPENNI2_INCLUDE_DIR HOLDFAST_OPENNI2_LIBRARY)

set(HOLDFAST_PLUGIN_FOLDERS "")       # of the plugins that are built
set(HOLDFAST_SETTINGS_INCLUDES "")    # of their settings, as C++
set(HOLDFAST_LEFT_OUT "")             # options of the plugins that are not built
set(HOLDFAST_LEFT_OUT_CALLS "")       # registering these, as C++
set(HOLDFAST_LEFT_OUT_SETTINGS "")    # headers of their settings
foreach(row IN LISTS HOLDFAST_PLUGIN_TABLE)
  string(REGEX MATCHALL "[^ ]+" row "${row}")
  list(POP_FRONT row kind name folder)
  string(TOUPPER HOLDFAST_PLUGIN_${name} option)
  set(default ON)
  if(DEFINED HOLDFAST_PLUGIN_DEFAULT_${name})
    set(default ${HOLDFAST_PLUGIN_DEFAULT_${name}})
  endif()
  option(${option} "Build the plugin `${name}` (${kind})" ${default})
  set(settings holdfast/settings/${name}.hpp)
  if(${option})
    list(APPEND HOLDFAST_PLUGIN_FOLDERS ${folder})
    if(EXISTS ${holdfast_SOURCE_DIR}/include/${settings})
      string(APPEND HOLDFAST_SETTINGS_INCLUDES "#include \"${settings}\"\n")
    endif()
  else()
    list(APPEND HOLDFAST_LEFT_OUT ${option})
    string(APPEND HOLDFAST_LEFT_OUT_CALLS "  registry.add_left_out(\"${kind}\", \"${name}\", \"${option}\");\n")
    list(APPEND HOLDFAST_LEFT_OUT_SETTINGS ${settings})
    if(name STREQUAL "viewer")
      list(APPEND HOLDFAST_LEFT_OUT_SETTINGS holdfast/viewer/viewer.hpp)
    endif()
  endif()
endforeach()
foreach(name IN LISTS HOLDFAST_OPTIONAL_PLUGINS)
  string(TOUPPER HOLDFAST_PLUGIN_${name} option)
  set(what ${HOLDFAST_PLUGIN_WHAT_${name}})
  set(packages ${HOLDFAST_PLUGIN_PACKAGES_${name}})
  if(${option} AND NOT HOLDFAST_PLUGIN_DEFAULT_${name})
    message(FATAL_ERROR "${option} is ON, but ${what} was not found: install it (Debian: ${packages}), or build without "
            "the plugin `${name}`: -D${option}=OFF")
  elseif(NOT HOLDFAST_PLUGIN_DEFAULT_${name})
    message(STATUS "Holdfast: the plugin `${name}` is not built: ${what} was not found (Debian: ${packages}; then "
            "configure with -D${option}=ON)")
  endif()
  # Its tests are left out with it.
  list(REMOVE_ITEM HOLDFAST_LEFT_OUT ${option})
endforeach()
if(HOLDFAST_LEFT_OUT AND (HOLDFAST_BUILD_TESTS OR HOLDFAST_BUILD_EXAMPLES OR HOLDFAST_BUILD_BENCHMARKS))
  list(JOIN HOLDFAST_LEFT_OUT ", " options)
  message(FATAL_ERROR "Tests, examples and benchmarks use every plugin, but ${options} is OFF: configure with "
          "-DHOLDFAST_BUILD_TESTS=OFF -DHOLDFAST_BUILD_EXAMPLES=OFF -DHOLDFAST_BUILD_BENCHMARKS=OFF, or with all plugins")
endif()
configure_file(${CMAKE_CURRENT_LIST_DIR}/settings_all.hpp.in ${holdfast_BINARY_DIR}/include/holdfast/settings/all.hpp
               @ONLY)

# Networks: a module that only plugins use.
set(HOLDFAST_INFERENCE OFF)
if(HOLDFAST_PLUGIN_GLOBAL OR HOLDFAST_PLUGIN_ONNX OR HOLDFAST_PLUGIN_ONNX_FEATURES OR HOLDFAST_PLUGIN_ONNX_MATCHER OR
   HOLDFAST_PLUGIN_UNET)
  set(HOLDFAST_INFERENCE ON)
endif()
