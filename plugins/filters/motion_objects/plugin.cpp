// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/plugin/plugin.hpp"

#include "motion_objects.hpp"

HOLDFAST_PLUGIN(motion_objects, registry) {
  using namespace holdfast;
  registry.add<DynamicFilter, motion_objects_plugin::MotionObjects, MotionObjectsSettings>(
      {.name = MotionObjectsSettings::module,
       .summary = "Tracks moving objects, each with its own rigid motion, and reports them to observers.",
       .paper =
           "Ruenz, Agapito: Co-Fusion: Real-time Segmentation, Tracking and Fusion of Multiple Objects. ICRA 2017. "
           "Ruenz, Buffier, Agapito: MaskFusion: Real-Time Recognition, Tracking and Reconstruction of Multiple "
           "Moving Objects. ISMAR 2018"});
}
