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
  "source          simulated             sources/simulated"
  "source          tum                   sources/tum"
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

# The plugin `viewer` is built where Boost is; ours to look for early, because its option depends on it.
find_path(HOLDFAST_BOOST_INCLUDE_DIR boost/beast/version.hpp)
mark_as_advanced(HOLDFAST_BOOST_INCLUDE_DIR)
set(HOLDFAST_PLUGIN_DEFAULT_viewer ON)
if(NOT HOLDFAST_BOOST_INCLUDE_DIR)
  set(HOLDFAST_PLUGIN_DEFAULT_viewer OFF)
endif()

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
if(HOLDFAST_PLUGIN_VIEWER AND NOT HOLDFAST_BOOST_INCLUDE_DIR)
  message(FATAL_ERROR "HOLDFAST_PLUGIN_VIEWER is ON, but Boost.Beast was not found: install Boost's headers (Debian: "
          "libboost-dev), or build without the viewer: -DHOLDFAST_PLUGIN_VIEWER=OFF")
elseif(HOLDFAST_PLUGIN_VIEWER)
  message(STATUS "Holdfast: the viewer is built, with Boost in ${HOLDFAST_BOOST_INCLUDE_DIR}")
elseif(NOT HOLDFAST_BOOST_INCLUDE_DIR)
  message(STATUS "Holdfast: the viewer is not built: Boost.Beast was not found (Debian: libboost-dev; then configure "
          "with -DHOLDFAST_PLUGIN_VIEWER=ON)")
endif()
# The tests of the viewer are left out with it.
list(REMOVE_ITEM HOLDFAST_LEFT_OUT HOLDFAST_PLUGIN_VIEWER)
if(HOLDFAST_LEFT_OUT AND (HOLDFAST_BUILD_TESTS OR HOLDFAST_BUILD_EXAMPLES OR HOLDFAST_BUILD_BENCHMARKS))
  list(JOIN HOLDFAST_LEFT_OUT ", " options)
  message(FATAL_ERROR "Tests, examples and benchmarks use every plugin, but ${options} is OFF: configure with "
          "-DHOLDFAST_BUILD_TESTS=OFF -DHOLDFAST_BUILD_EXAMPLES=OFF -DHOLDFAST_BUILD_BENCHMARKS=OFF, or with all plugins")
endif()
configure_file(${CMAKE_CURRENT_LIST_DIR}/settings_all.hpp.in ${holdfast_BINARY_DIR}/include/holdfast/settings/all.hpp
               @ONLY)

# Networks: a module that only plugins use.
set(HOLDFAST_INFERENCE OFF)
if(HOLDFAST_PLUGIN_ONNX OR HOLDFAST_PLUGIN_ONNX_FEATURES OR HOLDFAST_PLUGIN_ONNX_MATCHER OR
   HOLDFAST_PLUGIN_UNET)
  set(HOLDFAST_INFERENCE ON)
endif()
