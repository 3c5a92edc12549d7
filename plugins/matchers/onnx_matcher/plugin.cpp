// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/plugin/plugin.hpp"
#include "holdfast/plugin/parameter_table.hpp"
#include "onnx_matcher.hpp"

namespace holdfast {

void OnnxMatcherSettings::describe(ParameterTable<OnnxMatcherSettings>& table) {
  using S = OnnxMatcherSettings;
  table.add("model", &S::model, "ONNX file with float32 weights").required();
  table.add("count", &S::count, "number of features of each image in the inputs; 0 = as declared by the model")
      .range(0, 20000);
  table.add("keypoints0", &S::keypoints0, "input with the keypoints of the first image, 1 x count x 2, from -1 to 1");
  table.add("keypoints1", &S::keypoints1, "the same of the second image");
  table.add("descriptors0", &S::descriptors0, "input with the descriptors of the first image, 1 x count x length");
  table.add("descriptors1", &S::descriptors1, "the same of the second image");
  table.add("scores", &S::scores,
            "output with the scores of all pairs, 1 x count x count, or one row and column more for features without a "
            "partner");
  table.add("dual_softmax", &S::dual_softmax,
            "scores are numbers of any size, over which a softmax is taken in both directions; otherwise they are "
            "logarithms of probabilities");
  table.add("temperature", &S::temperature, "divisor of the scores before the dual softmax").range(1e-3, 1e3);
  table.add("threshold", &S::threshold, "minimum probability of a match").range(0, 1);
}

}  // namespace holdfast

HOLDFAST_PLUGIN(onnx_matcher, registry) {
  registry.add<holdfast::FeatureMatcher, holdfast::onnx_matcher_plugin::OnnxMatcher, holdfast::OnnxMatcherSettings>(
      {.name = holdfast::OnnxMatcherSettings::module,
       .summary = "A network in ONNX format that matches the features of two images, such as LightGlue.",
       .paper =
           "Lindenberger, Sarlin, Pollefeys: LightGlue: local feature matching at light speed. ICCV 2023; Sarlin et "
           "al.: SuperGlue. CVPR 2020"});
}
