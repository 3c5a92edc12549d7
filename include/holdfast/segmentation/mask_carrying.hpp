// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "holdfast/core/camera.hpp"
#include "holdfast/core/coarse_view.hpp"

namespace holdfast {

/// Points of labelled objects, followed from one frame to another; a structure of arrays. Positions are undistorted
/// pixels, depths [m], 0 = none.
struct FollowedPairs {
  std::vector<float> from_x, from_y, from_depth;
  std::vector<float> to_x, to_y, to_depth;

  std::size_t size() const { return from_x.size(); }
  void clear() { from_x.clear(), from_y.clear(), from_depth.clear(), to_x.clear(), to_y.clear(), to_depth.clear(); }
};

/// Labels on the cells of a coarse view, with how well each is founded (255 = as segmented). 0 = background,
/// 255 = unknown.
struct CellLabels {
  std::vector<std::uint8_t> labels;
  std::vector<std::uint8_t> quality;
  std::vector<std::uint8_t> moving;  ///< 1 where an object was last judged to move
};

/// Carries labels from one frame to another on their coarse views. A cell takes the label of the place that the
/// camera's motion moves it from, when the same surface was there; or of the place that the points of an object moved
/// here from, when depth agrees. Then the objects grow over surface that continues theirs in depth where there was free
/// space before, so that what comes into view is found, and a person does not flow into the floor. After the idea of
/// NGD-SLAM (Zhang et al. 2024, section III-B: points of the last mask followed by flow, mask rebuilt by depth), with
/// the background as a second witness. Keeps its buffers; one thread.
class MaskCarrier {
 public:
  explicit MaskCarrier(const Camera& camera) : camera_(camera) {}

  /// `T_to_from` is the motion of the camera. `to` must not be `from`.
  void carry(const CoarseView& from_view, const CellLabels& from, const CoarseView& to_view,
             const Eigen::Isometry3d& T_to_from, const FollowedPairs& pairs, CellLabels& to);

 private:
  void find_movers(const CoarseGrid& grid, const FollowedPairs& pairs);
  void grow(const CoarseView& to_view, CellLabels& to);
  void fill_holes(const CoarseView& to_view, CellLabels& to);

  /// A way that surface near a block of cells may have moved.
  struct Mover {
    int columns, rows;   // cells, from minus to
    float depth_change;  // m, from minus to
  };
  static constexpr int block = 8;  // cells
  static constexpr int most_movers = 4;

  Camera camera_;
  int block_columns_ = 0, block_rows_ = 0;
  std::vector<Mover> movers_;  // most_movers for each block
  std::vector<std::uint8_t> mover_count_;
  /// What was at a cell's place before, by the camera's motion: the same surface, free space, something nearer, or
  /// nothing known.
  enum class Past : std::uint8_t { same, free, hidden, unseen };
  std::vector<Past> past_;
  std::vector<float> start_depth_;  // of the part of an object that grew here [m]
  std::vector<std::int32_t> front_, next_front_;
};

}  // namespace holdfast
