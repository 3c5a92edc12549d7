// SPDX-License-Identifier: BSD-3-Clause
// The ids of people who walk before and behind each other, with exact masks that come late.
#include <gtest/gtest.h>

#include <algorithm>
#include <iostream>
#include <map>
#include <memory>
#include <opencv2/imgproc.hpp>
#include <set>

#include "holdfast/moving_world/mask_propagator.hpp"
#include "holdfast/simulation/scene_file.hpp"
#include "holdfast/simulation/simulator.hpp"

namespace holdfast {
namespace {

/// Identification F1 (Ristani et al. 2016): of all true and all found appearances, those that agree under the best
/// one-to-one assignment of ids, here a greedy one, which is a lower bound.
class IdentityScore {
 public:
  void add(const std::vector<std::uint16_t>& truth, const std::vector<std::uint16_t>& found) {
    std::map<std::pair<int, int>, int> both;
    std::map<int, int> of_truth, of_found;
    for (std::size_t i = 0; i < truth.size(); ++i) {
      if (truth[i] != 0) ++of_truth[truth[i]];
      if (found[i] != 0) ++of_found[found[i]];
      if (truth[i] != 0 && found[i] != 0) ++both[{truth[i], found[i]}];
    }
    constexpr int least = 12;  // cells
    for (const auto& [id, cells] : of_truth) appearances_ += cells >= least ? 1 : 0;
    for (const auto& [id, cells] : of_found) appearances_ += cells >= least ? 1 : 0;
    for (const auto& [pair, cells] : both)
      if (2 * cells > of_truth[pair.first] + of_found[pair.second] - cells && of_truth[pair.first] >= least &&
          of_found[pair.second] >= least)
        ++matches_[pair];
  }

  /// The same without the assignment: all appearances with a mask count.
  double detection_f1() const {
    int agreeing = 0;
    for (const auto& [pair, count] : matches_) agreeing += count;
    return 2.0 * agreeing / appearances_;
  }

  double identity_f1() const {
    std::vector<std::pair<int, std::pair<int, int>>> order;
    for (const auto& [pair, count] : matches_) order.emplace_back(-count, pair);
    std::sort(order.begin(), order.end());
    std::set<int> truths, ids;
    int agreeing = 0;
    for (const auto& [count, pair] : order) {
      if (truths.contains(pair.first) || ids.contains(pair.second)) continue;
      truths.insert(pair.first), ids.insert(pair.second);
      agreeing -= count;
    }
    return 2.0 * agreeing / appearances_;
  }

 private:
  std::map<std::pair<int, int>, int> matches_;
  int appearances_ = 0;
};

Camera small_camera() {
  Camera camera = *find_camera("tum_fr3");
  camera.width /= 2, camera.height /= 2;
  camera.fx /= 2, camera.fy /= 2, camera.cx /= 2, camera.cy /= 2;
  camera.distortion = {};
  return camera;
}

/// Masks of which each `interval`-th frame is segmented, `late` frames later, and their score.
struct Follower {
  MaskPropagator masks;
  std::uint64_t interval, late;
  IdentityScore score = {};
  std::map<std::uint64_t, CellMask> awaited = {};

  void follow(const cv::Mat& grey, const Frame& frame, const Eigen::Isometry3d& T_frame_previous,
              const CellMask& exact) {
    masks.advance(grey, frame, T_frame_previous);
    masks.set_pose(frame.T_camera_world, frame.coarse, -1.0F);
    if (frame.index % interval == 0) {
      masks.remember();
      awaited[frame.index] = exact;
    }
    if (frame.index >= late && (frame.index - late) % interval == 0)
      masks.apply(frame.index - late, awaited[frame.index - late]);
    if (!masks.mask().empty()) score.add(exact.instances, masks.mask().instances);
  }
};

TEST(InstanceIdsAccuracy, PeopleWhoHideEachOtherKeepTheirIds) {
  simulation::Simulator simulator(
      simulation::read_scene(std::string(HOLDFAST_SOURCE_DIR) + "/examples/scenes/walking_xyz.yaml"), small_camera());
  const auto& names = simulator.class_names();
  const auto person = static_cast<std::uint8_t>(std::find(names.begin(), names.end(), "person") - names.begin());
  const auto camera = std::make_shared<Camera>(simulator.camera());
  const CoarseSampler sampler(*camera);
  Follower exact{MaskPropagator(*camera, sampler, 1.0), 1, 0}, late{MaskPropagator(*camera, sampler, 1.0), 5, 2};
  Frame frame, previous;
  constexpr std::uint64_t frames = 180, step = 2;  // 12 s at 15 Hz
  for (std::uint64_t i = 0; i < frames; ++i) {
    const SensorFrame image = simulator.frame(step * i);
    previous = frame;
    frame = Frame();
    frame.index = i, frame.timestamp = image.timestamp, frame.camera = camera;
    sampler.sample_depth(image.depth, frame.coarse);
    frame.T_camera_world = image.truth->T_world_camera->inverse();
    cv::Mat grey;
    cv::cvtColor(image.colour, grey, cv::COLOR_BGR2GRAY);
    Segmentation truth{(image.truth->class_labels == person) / 255, {}};
    image.truth->object_mask.convertTo(truth.instances, CV_16UC1);
    truth.instances.setTo(0, truth.labels == 0);
    const CellMask mask = sample_mask(sampler, truth);
    const Eigen::Isometry3d T_frame_previous =
        i == 0 ? Eigen::Isometry3d::Identity() : frame.T_camera_world * previous.T_world_camera();
    for (Follower* follower : {&exact, &late}) follower->follow(grey, frame, T_frame_previous, mask);
  }
  std::cout << "IDF1 " << exact.score.identity_f1() << "; with a mask every 0.33 s, 0.13 s late, "
            << late.score.identity_f1() << " of " << late.score.detection_f1() << '\n';
  EXPECT_GE(exact.score.identity_f1(), 0.9);
  EXPECT_GE(late.score.detection_f1(), 0.8) << "people who come into view have no mask yet";
  EXPECT_GE(late.score.identity_f1(), 0.95 * late.score.detection_f1());
}

}  // namespace
}  // namespace holdfast
