// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/plugin/plugin.hpp"

#include "opencv_orb.hpp"

HOLDFAST_PLUGIN(opencv_orb, registry) {
  registry.add<holdfast::FeatureExtractor, holdfast::opencv_orb_plugin::OpencvOrb, holdfast::OpencvOrbSettings>(
      {.name = holdfast::OpencvOrbSettings::module,
       .summary = "OpenCV's ORB: the strongest FAST corners of each pyramid level, steered BRIEF of 256 bits.",
       .paper = "Rublee, Rabaud, Konolige, Bradski: ORB: an efficient alternative to SIFT or SURF. ICCV 2011"});
}
