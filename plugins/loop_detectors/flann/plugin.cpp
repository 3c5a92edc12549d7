// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/plugin/plugin.hpp"

#include "flann_detector.hpp"

HOLDFAST_PLUGIN(flann, registry) {
  using namespace holdfast;
  registry.add<LoopDetector, flann_plugin::FlannDetector, FlannSettings>(
      {.name = FlannSettings::module,
       .summary =
           "Incremental bag of words on FLANN, of descriptors of any type: no vocabulary file, keyframes come and go.",
       .paper = "Garcia-Fidalgo and Ortiz: iBoW-LCD. Robotics and Automation Letters 3(4), 2018; Muja and Lowe: Fast "
                "matching of binary features. CRV 2012; Nister and Stewenius: Scalable recognition with a vocabulary "
                "tree. CVPR 2006"});
}
