// SPDX-License-Identifier: BSD-3-Clause
#include "visit.hpp"

#include "holdfast/config/configuration.hpp"
#include "holdfast/core/association.hpp"
#include "holdfast/interfaces/feature_extractor.hpp"
#include "holdfast/moving_world/mask_propagator.hpp"
#include "holdfast/plugin/builtin.hpp"
#include "holdfast/run/configured_pipeline.hpp"
#include "holdfast/tracking/frame_builder.hpp"
#include "holdfast/tracking/image_depth.hpp"
#include "holdfast/tracking/tracking_settings.hpp"

namespace holdfast {

Visit read_visit(const std::string& source, const std::string& segmenter) {
  Registry registry;
  register_builtin_plugins(registry);
  const std::string text =
      "source: " + source + "\nsegmenter: " + segmenter + "\ncamera: tum_fr1\nfeatures: orb\noptimizer: ceres\n";
  const Configuration configuration =
      resolve_configuration(parse_yaml(text, "visit", "."), "visit", registry, pipeline_sections());
  BuiltSegmenter built = build_segmenter(configuration, registry);
  const auto extractor = registry.create<FeatureExtractor>("orb", {}, {});
  Visit visit;
  visit.camera = built.source->describe().camera.value_or(configuration.camera.value_or(Camera{}));
  visit.classes = built.segmenter->classes();
  ImageDepth depth(visit.camera, TrackingSettings{}.depth_edge_ratio);
  FrameBuilder builder(visit.camera, *extractor, depth);
  const Trajectory truth = built.source->truth();
  std::vector<double> stamps;
  for (const TimedPose& pose : truth) stamps.push_back(pose.timestamp);
  while (const auto sensor_frame = built.source->next()) {
    const double stamp[] = {sensor_frame->timestamp};
    const auto pairs = associate_stamps(stamp, stamps, 0.02);
    if (pairs.empty()) continue;
    Frame& frame = visit.frames.emplace_back();
    StageTimes times;
    builder.build(*sensor_frame, frame, times);
    frame.coarse.mask = sample_mask(builder.coarse_sampler(), built.segmenter->segment(*sensor_frame));
    frame.T_camera_world = truth[pairs[0].second].T_world_camera.inverse();
    visit.views.push_back(view_of(visit.camera, *sensor_frame, truth[pairs[0].second].T_world_camera));
  }
  return visit;
}

}  // namespace holdfast
