// SPDX-License-Identifier: BSD-3-Clause
// A filter of one's own: says of each feature how likely it stands still. This one distrusts what is very near, such as
// the robot's own arm.
#include <iostream>

#include "holdfast/holdfast.hpp"
#include "holdfast/settings/all.hpp"
#include "simulated_frames.hpp"

class Nearness final : public holdfast::DynamicFilter {
 public:
  explicit Nearness(float distance) : distance_(distance) {}

  holdfast::Needs needs() const override { return {.depth = true}; }
  void apply(const holdfast::FilterContext& context, holdfast::StaticEvidence& evidence) override {
    for (std::size_t i = 0; i < context.frame.size(); ++i)
      if (context.frame.has_depth(i) && context.frame.depth[i] < distance_)
        evidence.add(i, -4.0F, holdfast::StaticEvidence::Kind::prior);
  }

 private:
  float distance_;  // [m]
};

int main() try {
  const auto source = simulated_frames(0.4);
  holdfast::Pipeline pipeline = holdfast::PipelineBuilder()
                                    .source(source->describe())
                                    .features(holdfast::OrbSettings{})
                                    .optimizer(holdfast::CeresSettings{})
                                    .filter({std::make_unique<Nearness>(1.5F), "nearness"})
                                    .filter(holdfast::MultiViewDepthSettings{})
                                    .build();
  int distrusted = 0;
  holdfast::FrameResult result;
  while (const auto frame = source->next()) {
    result = pipeline.feed(*frame);
    distrusted += result.features - result.static_features;
  }
  pipeline.finish();
  std::cout << distrusted << " features were distrusted\n";
  return result.status == holdfast::TrackingStatus::tracked && distrusted > 0 ? 0 : 1;
} catch (const holdfast::Error& error) {
  std::cerr << error.what() << '\n';
  return 1;
}
