// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "holdfast/plugin/parameter_table.hpp"

namespace holdfast {

/// Perturbations of the frames of a source, each with its strength and unit; 0 = off.
struct PerturbationSettings {
  double motion_blur = 0.0;
  double noise = 0.0;
  double exposure = 0.0;
  double rolling_shutter = 0.0;
  double dropped = 0.0;
  double repeated = 0.0;
  double late = 0.0;
  double depth_holes = 0.0;
  double depth_bias = 0.0;
  double depth_offset = 0.0;
  double calibration = 0.0;
  double occluder = 0.0;
  double covered = 0.0;
  std::int64_t covered_after = 8;
  std::int64_t seed = 0;

  static void describe(ParameterTable<PerturbationSettings>& table) {
    using S = PerturbationSettings;
    table.add("motion_blur", &S::motion_blur, "length of a straight blur, whose direction is drawn for every frame")
        .range(0.0, 200.0)
        .unit("px");
    table.add("noise", &S::noise, "standard deviation of normal noise that is added to each channel of the images")
        .range(0.0, 100.0)
        .unit("grey levels");
    table
        .add("exposure", &S::exposure,
             "largest change of brightness, as a power of two; every 15 frames it jumps to another one")
        .range(0.0, 4.0)
        .unit("stops");
    table
        .add("rolling_shutter", &S::rolling_shutter,
             "largest shift of the last row of an image against the first; it swings during 30 frames")
        .range(0.0, 200.0)
        .unit("px");
    table.add("dropped", &S::dropped, "share of frames that are missing").range(0.0, 0.95);
    table.add("repeated", &S::repeated, "share of frames that show the images of the frame before").range(0.0, 0.95);
    table.add("late", &S::late, "largest delay of a time stamp; drawn for every frame").range(0.0, 1.0).unit("s");
    table.add("depth_holes", &S::depth_holes, "share of the depth image without a value, in patches").range(0.0, 0.95);
    table.add("depth_bias", &S::depth_bias, "relative error of every depth").range(-0.9, 2.0);
    table
        .add("depth_offset", &S::depth_offset,
             "shift of the depth image against the colour image, in a direction that is drawn once")
        .range(0.0, 200.0)
        .unit("px");
    table
        .add("calibration", &S::calibration,
             "relative error of the focal length, and of the principal point relative to half the image; signs are "
             "drawn once")
        .range(0.0, 0.5);
    table.add("occluder", &S::occluder, "share of the image behind an object that swings 0.5 m before the camera")
        .range(0.0, 0.9);
    table
        .add("covered", &S::covered,
             "time for which something lies on the lens: black images and no depth, by the frame rate of the camera")
        .range(0.0, 3600.0)
        .unit("s");
    table.add("covered_after", &S::covered_after, "time from the first frame to the one from which the lens is covered")
        .range(0.0, 3600.0)
        .unit("s");
    table.add("seed", &S::seed, "seed of all that is drawn; 0 = the seed of the run").at_least(0.0);
  }

  bool is_nothing() const { return strengths().empty(); }

  /// Name and strength of every perturbation that is not 0, in the order of the table.
  std::vector<std::pair<std::string, double>> strengths() const;
};

}  // namespace holdfast
