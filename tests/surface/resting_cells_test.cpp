// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/surface/resting_cells.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace holdfast {
namespace {

/// Frames of a camera that moves to the side before a wall 3 m ahead and a board 2 m ahead, at a place that depends on
/// the time.
class RestingCellsTest : public testing::Test {
 protected:
  RestingCellsTest() : camera_(std::make_shared<Camera>()), grid_(CoarseSampler(*camera_).grid()) {}

  static FrameResult tracked(bool is_keyframe = false) {
    FrameResult result;
    result.status = TrackingStatus::tracked;
    result.method = TrackingMethod::motion_model;
    result.is_keyframe = is_keyframe;
    return result;
  }
  /// `left`: edge of the board, which is 0.6 m wide [m].
  Frame frame(std::uint64_t index, double left) const {
    Frame frame;
    frame.index = index;
    frame.timestamp = 0.1 * static_cast<double>(index);
    frame.camera = camera_;
    frame.T_camera_world.translation().x() = -0.01 * static_cast<double>(index);
    frame.coarse.grid = grid_;
    for (int cell = 0; cell < grid_.size(); ++cell)
      frame.coarse.depth.push_back(is_board(frame, cell, left) ? 2.0F : 3.0F);
    return frame;
  }
  bool is_board(const Frame& frame, int cell, double left) const {
    const double x = (static_cast<double>(grid_.x_of(cell % grid_.columns)) - camera_->cx) / camera_->fx * 2.0 -
                     frame.T_camera_world.translation().x();
    const double y = (static_cast<double>(grid_.y_of(cell / grid_.columns)) - camera_->cy) / camera_->fy * 2.0;
    return x > left && x < left + 0.6 && std::abs(y) < 0.3;
  }
  /// -2 for the cells of the board, 1 for those of the wall.
  std::vector<float> moving_board(const Frame& frame, double left) const {
    std::vector<float> log_odds;
    for (int cell = 0; cell < grid_.size(); ++cell) log_odds.push_back(is_board(frame, cell, left) ? -2.0F : 1.0F);
    return log_odds;
  }
  /// Share of the board that is released in the last frame, when it moves to its place as `left_at` says.
  template <class Place>
  double released_share(const Place& left_at, std::uint64_t frames) const {
    RestingCells cells(2.0);
    for (std::uint64_t i = 0; i < frames; ++i) cells.add(frame(i, left_at(i)), tracked(i + 1 == frames));
    const Frame last = frame(frames - 1, left_at(frames - 1));
    const std::vector<float> before = moving_board(last, left_at(frames - 1)),
                             after = cells.released(frames - 1, before);
    double board = 0.0, released = 0.0;
    for (std::size_t i = 0; i < before.size(); ++i) {
      if (before[i] > 0.0F) {
        EXPECT_EQ(after[i], before[i]);
      }
      board += before[i] < 0.0F ? 1.0 : 0.0;
      released += before[i] < 0.0F && after[i] == 0.0F ? 1.0 : 0.0;
    }
    EXPECT_GT(board, 100.0);
    return released / board;
  }

  std::shared_ptr<Camera> camera_;
  CoarseGrid grid_;
};

TEST_F(RestingCellsTest, ReleasesWhatStoodStillForTheTime) {
  EXPECT_EQ(released_share([](std::uint64_t) { return 0.1; }, 30), 1.0);
  const auto stops_at = [](std::uint64_t stop) {
    return [stop](std::uint64_t i) { return 0.1 - 0.04 * static_cast<double>(stop - std::min(i, stop)); };
  };
  EXPECT_EQ(released_share(stops_at(20), 32), 0.0) << "it moved within the last 2 s";
  EXPECT_EQ(released_share(stops_at(20), 44), 1.0);
}

TEST_F(RestingCellsTest, ReleasesNothingThatMovesOrIsNew) {
  EXPECT_EQ(released_share([](std::uint64_t i) { return 0.02 * static_cast<double>(i) - 0.5; }, 40), 0.0);
  EXPECT_EQ(released_share([](std::uint64_t i) { return i < 30 ? -10.0 : 0.1; }, 35), 0.0);
  EXPECT_EQ(released_share([](std::uint64_t) { return 0.1; }, 15), 0.0) << "it was not there for so long yet";
}

TEST_F(RestingCellsTest, KnowsOnlyFramesThatItHas) {
  RestingCells cells(2.0);
  for (std::uint64_t i = 0; i < 60; ++i) cells.add(frame(i, 0.1), tracked());
  const std::vector<float> log_odds = moving_board(frame(59, 0.1), 0.1);
  EXPECT_EQ(cells.released(59, log_odds), log_odds) << "between two that are kept";
  EXPECT_NE(cells.released(58, log_odds), log_odds);
  EXPECT_EQ(cells.released(2, log_odds), log_odds) << "so long ago";
  EXPECT_EQ(cells.released(58, {}), std::vector<float>());
  cells.clear();
  EXPECT_EQ(cells.released(58, log_odds), log_odds);
}

TEST_F(RestingCellsTest, ForgetsPosesOfAnotherMapAndOfBeforeALoss) {
  const std::vector<float> log_odds = moving_board(frame(58, 0.1), 0.1);
  const auto is_released_after = [&](std::uint64_t at, const FrameResult& event) {
    RestingCells cells(2.0);
    for (std::uint64_t i = 0; i < 60; ++i) cells.add(frame(i, 0.1), i == at ? event : tracked(true));
    return cells.released(58, log_odds) != log_odds;
  };
  FrameResult event = tracked();
  EXPECT_TRUE(is_released_after(50, event));
  for (const TrackingMethod method : {TrackingMethod::recovered, TrackingMethod::relocalised}) {
    event.method = method;
    EXPECT_FALSE(is_released_after(50, event)) << to_string(method);
    EXPECT_TRUE(is_released_after(30, event)) << "long enough ago";
  }
  event.status = TrackingStatus::initialised;
  EXPECT_FALSE(is_released_after(50, event));
  event.status = TrackingStatus::lost;
  event.method = TrackingMethod::none;
  EXPECT_TRUE(is_released_after(50, event)) << "the map is the same";
}

}  // namespace
}  // namespace holdfast
