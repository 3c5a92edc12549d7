// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/plugin/plugin.hpp"

#include "sift.hpp"

HOLDFAST_PLUGIN(sift, registry) {
  registry.add<holdfast::FeatureExtractor, holdfast::sift_plugin::SiftExtractor, holdfast::SiftSettings>(
      {.name = holdfast::SiftSettings::module,
       .summary = "OpenCV's SIFT: maxima of differences of Gaussians, 128 numbers; slower than orb by an order of "
                  "magnitude.",
       .paper = "Lowe: Distinctive image features from scale-invariant keypoints. IJCV 60(2), 2004"});
}
