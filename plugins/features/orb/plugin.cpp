// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/plugin/plugin.hpp"

#include "orb.hpp"

HOLDFAST_PLUGIN(orb, registry) {
  registry.add<holdfast::FeatureExtractor, holdfast::OrbExtractor, holdfast::OrbSettings>(
      {.name = holdfast::OrbSettings::module,
       .summary =
           "ORB with even coverage: FAST corners on a pyramid with a fallback threshold, steered BRIEF of 256 bits.",
       .paper = "Rublee, Rabaud, Konolige, Bradski: ORB: an efficient alternative to SIFT or SURF. ICCV 2011; spread: "
                "Mur-Artal, Montiel, Tardos: ORB-SLAM. IEEE Transactions on Robotics 31(5), 2015"});
}
