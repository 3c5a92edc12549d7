// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/plugin/plugin.hpp"

#include "akaze.hpp"

HOLDFAST_PLUGIN(akaze, registry) {
  registry.add<holdfast::FeatureExtractor, holdfast::akaze_plugin::AkazeExtractor, holdfast::AkazeSettings>(
      {.name = holdfast::AkazeSettings::module,
       .summary = "OpenCV's AKAZE: maxima of the Hessian in a scale space that keeps edges, MLDB of 486 bits.",
       .paper = "Alcantarilla, Nuevo, Bartoli: Fast explicit diffusion for accelerated features in nonlinear scale "
                "spaces. BMVC 2013"});
}
