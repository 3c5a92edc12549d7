// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "holdfast/interfaces/observer.hpp"
#include "holdfast/plugin/registry.hpp"

extern "C" void holdfast_register_plugin_class_motion(holdfast::Registry&);

namespace holdfast {
namespace {

namespace fs = std::filesystem;

/// A frame whose feature i lies in cell i of a mask with these labels.
Frame frame_of(const std::vector<std::uint8_t>& labels, const std::vector<float>& measured) {
  Frame frame;
  frame.coarse.grid = CoarseSampler(*find_camera("tum_fr3")).grid();
  frame.coarse.mask.assign(static_cast<std::size_t>(frame.coarse.grid.size()), CellMask::unknown, 255);
  std::copy(labels.begin(), labels.end(), frame.coarse.mask.labels.begin());
  frame.features.resize(labels.size());
  for (std::size_t i = 0; i < labels.size(); ++i) {
    frame.x.push_back(frame.coarse.grid.x_of(static_cast<int>(i)));
    frame.y.push_back(frame.coarse.grid.y_of(0));
  }
  frame.measured_log_odds = measured;
  return frame;
}

TEST(ClassMotion, CountsWhatWasMeasuredToMove) {
  const fs::path folder = fs::path(testing::TempDir()) / ("holdfast_class_motion_" + std::to_string(getpid()));
  fs::create_directories(folder);
  Registry registry;
  holdfast_register_plugin_class_motion(registry);
  CreationContext context;
  context.output_directory = folder;
  const auto observer = registry.create<Observer>("class_motion", {}, context);
  observer->on_start({"background", "person", "chair, old", "tv"});
  FrameResult result;
  const Frame frame = frame_of({0, 1, 1, 2, 2, CellMask::unknown, 1}, {0.5F, -3.0F, 0.5F, -0.9F, -1.0F, -5.0F, 0.0F});
  observer->on_frame({}, frame, result);  // no pose: nothing was measured
  result.status = TrackingStatus::tracked;
  observer->on_frame({}, frame, result);
  observer->on_frame({}, frame, result);
  observer->on_frame({}, frame_of({1, 1}, {}), result);  // no filter measures
  observer->on_finish(Map());
  std::ifstream stream(folder / "class_motion.csv");
  std::stringstream text;
  text << stream.rdbuf();
  EXPECT_EQ(text.str(),
            "class,measured,moving,share\n"
            "background,2,0,0.0000\n"
            "person,4,2,0.5000\n"
            "chair, old,4,2,0.5000\n");
  fs::remove_all(folder);
  EXPECT_NO_THROW(registry.create<Observer>("class_motion", {}, {})->on_finish(Map())) << "without a folder";
}

}  // namespace
}  // namespace holdfast
