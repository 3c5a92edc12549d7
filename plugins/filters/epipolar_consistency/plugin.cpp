// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/plugin/plugin.hpp"

#include "epipolar_consistency.hpp"

HOLDFAST_PLUGIN(epipolar_consistency, registry) {
  using namespace holdfast;
  registry.add<DynamicFilter, epipolar_consistency_plugin::EpipolarConsistency, EpipolarConsistencySettings>(
      {.name = EpipolarConsistencySettings::module,
       .summary = "Evidence against features that violate the epipolar constraint; none if the epipolar geometry is "
                  "degenerate.",
       .paper = "Yu, Liu, Liu, Xie, Yang, Wei, Fei: DS-SLAM: A semantic visual SLAM towards dynamic environments. IROS "
                "2018, section II-C"});
}
