// SPDX-License-Identifier: BSD-3-Clause
// Tracks with a segmenter and a filter that are linked in.
#include <iostream>

#include "holdfast/holdfast.hpp"
#include "holdfast/settings/all.hpp"

extern "C" void holdfast_register_plugin_upper_half(holdfast::Registry&);
extern "C" void holdfast_register_plugin_dark_things(holdfast::Registry&);

int main() try {
  holdfast::Registry registry;
  holdfast::register_builtin_plugins(registry);
  const auto source = registry.create<holdfast::FrameSource>("simulated", {{"duration", 0.3}}, {});
  holdfast::Pipeline pipeline = holdfast::PipelineBuilder()
                                    .plugin(holdfast_register_plugin_upper_half)
                                    .plugin(holdfast_register_plugin_dark_things)
                                    .source(source->describe())
                                    .features(holdfast::OrbSettings{.count = 800})
                                    .optimizer(holdfast::CeresSettings{})
                                    .segmenter({"dark_things", {{"brightness", 50}}})
                                    .filter(holdfast::SemanticMaskSettings{.classes = {"dark"}})
                                    .filter({"upper_half", {{"log_odds", -5}}})
                                    .build();
  int distrusted = 0, frames = 0;
  while (const auto frame = source->next()) {
    const holdfast::FrameResult result = pipeline.feed(*frame);
    distrusted += result.features - result.static_features;
    ++frames;
  }
  pipeline.finish();
  std::cout << pipeline.trajectory().size() << " poses of " << frames << " frames, " << distrusted
            << " features distrusted, " << pipeline.mask_latencies().size() << " masks\n";
  return distrusted > 0 && !pipeline.mask_latencies().empty() ? 0 : 1;
} catch (const holdfast::Error& error) {
  std::cerr << error.what() << '\n';
  return 2;
}
