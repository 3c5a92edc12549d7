// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/plugin/plugin.hpp"
#include "holdfast/plugin/parameter_table.hpp"
#include "onnx_features.hpp"

namespace holdfast {

void OnnxFeaturesSettings::describe(ParameterTable<OnnxFeaturesSettings>& table) {
  using S = OnnxFeaturesSettings;
  table.add("model", &S::model, "ONNX file with float32 weights").required();
  table.add("width", &S::width, "width of the network input; 0 = as declared by the model").range(0, 8192).unit("px");
  table.add("height", &S::height, "height of the network input; 0 = as declared by the model")
      .range(0, 8192)
      .unit("px");
  table.add("scale", &S::scale, "factor on grey values from 0 to 255 of the input").range(-1000, 1000);
  table.add("offset", &S::offset, "added to the scaled grey values").range(-1e6, 1e6);
  table.add("scores", &S::scores,
            "name of the output with scores: a heat map (1 x 1 x height x width, or cells as SuperPoint has them), or "
            "one score per keypoint");
  table.add("descriptors", &S::descriptors,
            "name of the output with descriptors: a map (1 x length x rows x columns), or one row per keypoint");
  table.add("keypoints", &S::keypoints,
            "name of the output with keypoints (column and row in pixels of the input); empty = scores are a heat map");
  table.add("count", &S::count, "maximum number of features per image, the best").range(10, 50000);
  table.add("threshold", &S::threshold, "minimum score of a feature");
  table
      .add("suppression_radius", &S::suppression_radius,
           "a feature of a heat map has the largest score within this distance in columns and rows")
      .range(0, 100)
      .unit("px");
  table.add("border", &S::border, "a heat map has no feature so near to its border").range(1, 1000).unit("px");
  table.add("subpixel", &S::subpixel, "refine positions of a heat map to sub-pixel accuracy");
  table.add("metric", &S::metric,
            "how descriptors are compared: by the cosine of their angle (they are brought to unit length), or by the "
            "length of their difference");
  table
      .add("strict_distance", &S::strict_distance,
           "recommended largest distance of descriptors of a match without a prediction")
      .range(1e-6, 1e6);
  table
      .add("loose_distance", &S::loose_distance,
           "recommended largest distance of descriptors of a match near its prediction, not below strict_distance")
      .range(1e-6, 1e6);
}

}  // namespace holdfast

HOLDFAST_PLUGIN(onnx_features, registry) {
  registry
      .add<holdfast::FeatureExtractor, holdfast::onnx_features_plugin::OnnxFeatures, holdfast::OnnxFeaturesSettings>(
          {.name = holdfast::OnnxFeaturesSettings::module,
           .summary = "Features of a network in ONNX format with a heat map or keypoints, such as SuperPoint.",
           .paper = "DeTone, Malisiewicz, Rabinovich: SuperPoint: self-supervised interest point detection and "
                    "description. CVPR workshops 2018"});
}
