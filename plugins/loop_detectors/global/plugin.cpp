// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/plugin/plugin.hpp"

#include "global_detector.hpp"
#include "holdfast/inference/network_parameters.hpp"

namespace holdfast {

void GlobalSettings::describe(ParameterTable<GlobalSettings>& table) {
  using S = GlobalSettings;
  table.add("model", &S::model, "network that describes a colour image by one vector, ONNX, float32").required();
  describe_network_input(table);
  table.add("output_name", &S::output_name, "name of the output, if the model has several");
  table
      .add("minimum_similarity", &S::minimum_similarity,
           "cosine of the angle between the vectors of two images below which the places do not match; the score of a "
           "match rises from 0 there to 1")
      .range(-1.0, 0.999);
  table
      .add(
          "class_weights", &S::class_weights,
          "classes of the segmenter that count little, such as { chair: 0.1 }: below 0.5, their pixels are replaced as "
          "moving ones are; also turns on loop_closing.class_agreement")
      .range(0, 1);
}

}  // namespace holdfast

HOLDFAST_PLUGIN(global, registry) {
  using namespace holdfast;
  registry.add<LoopDetector, global_plugin::GlobalDetector, GlobalSettings>(
      {.name = GlobalSettings::module,
       .summary = "One vector per image by a network in ONNX format, such as NetVLAD or CosPlace.",
       .paper = "Arandjelovic et al.: NetVLAD: CNN architecture for weakly supervised place recognition. CVPR 2016; "
                "Berton, Masone, Caputo: Rethinking visual geo-localization for large-scale applications. CVPR 2022"});
}
