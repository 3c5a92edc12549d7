// SPDX-License-Identifier: BSD-3-Clause
// A segmenter of one's own: names the class of every pixel of a keyframe; Holdfast carries the mask to the frames
// between.
#include <iostream>
#include <opencv2/core.hpp>

#include "holdfast/holdfast.hpp"
#include "holdfast/settings/all.hpp"
#include "simulated_frames.hpp"

/// Takes whatever is reddish for a person. A network would go in its place.
class RedThings final : public holdfast::Segmenter {
 public:
  const std::vector<std::string>& classes() const override { return classes_; }
  holdfast::Segmentation segment(const holdfast::SensorFrame& frame) override {
    cv::Mat channels[3], labels;
    cv::split(frame.colour, channels);  // blue, green, red
    labels = (channels[2] > 1.3 * channels[1]) & (channels[2] > 1.3 * channels[0]);
    return {labels & 1, {}};  // 0 = background, 1 = person
  }

 private:
  std::vector<std::string> classes_{"background", "person"};
};

int main() try {
  const auto source = simulated_frames(0.6);
  holdfast::Pipeline pipeline = holdfast::PipelineBuilder()
                                    .source(source->describe())
                                    .features(holdfast::OrbSettings{})
                                    .optimizer(holdfast::CeresSettings{})
                                    .segmenter(std::make_unique<RedThings>())
                                    .filter(holdfast::SemanticMaskSettings{.classes = {"person"}})
                                    .build();
  holdfast::FrameResult result;
  while (const auto frame = source->next()) result = pipeline.feed(*frame);
  pipeline.finish();
  std::cout << pipeline.mask_latencies().size() << " masks; of the last frame's " << result.features << " features "
            << result.features - result.static_features << " lay on red things\n";
  return result.status == holdfast::TrackingStatus::tracked && !pipeline.mask_latencies().empty() ? 0 : 1;
} catch (const holdfast::Error& error) {
  std::cerr << error.what() << '\n';
  return 1;
}
