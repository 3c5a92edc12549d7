// SPDX-License-Identifier: BSD-3-Clause
// An observer of one's own: sees every frame, keyframe and loop as it comes, and the map at the end.
#include <iostream>

#include "holdfast/holdfast.hpp"
#include "holdfast/settings/all.hpp"
#include "simulated_frames.hpp"

class Storyteller final : public holdfast::Observer {
 public:
  explicit Storyteller(int& keyframes) : keyframes_(keyframes) {}

  void on_frame(const holdfast::SensorFrame& frame, const holdfast::Frame&,
                const holdfast::FrameResult& result) override {
    std::cout << frame.timestamp << " s: " << holdfast::to_string(result.status) << ", " << result.inliers
              << " points in view\n";
  }
  // In threaded mode another thread than that of on_frame() calls this; the map is valid during the call only.
  void on_keyframe(holdfast::KeyFrameId, const holdfast::ObservedMap& map) override {
    ++keyframes_;
    std::cout << "  a keyframe; the map has " << map.snapshot().points.size() << " points\n";
  }
  void on_finish(const holdfast::Map& map) override {
    std::cout << "the end, with " << map.keyframes().size() << " keyframes\n";
  }

 private:
  int& keyframes_;
};

int main() try {
  const auto source = simulated_frames(0.4);
  int keyframes = 0;
  holdfast::Pipeline pipeline = holdfast::PipelineBuilder()
                                    .source(source->describe())
                                    .features(holdfast::OrbSettings{})
                                    .optimizer(holdfast::CeresSettings{})
                                    .observer(std::make_unique<Storyteller>(keyframes))
                                    .build();
  while (const auto frame = source->next()) pipeline.feed(*frame);
  pipeline.finish();
  return keyframes > 0 ? 0 : 1;
} catch (const holdfast::Error& error) {
  std::cerr << error.what() << '\n';
  return 1;
}
