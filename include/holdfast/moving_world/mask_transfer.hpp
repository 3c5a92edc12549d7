// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "holdfast/core/camera.hpp"
#include "holdfast/core/cell_mask.hpp"
#include "holdfast/core/coarse_view.hpp"
#include "holdfast/geometry/warp.hpp"

namespace holdfast {

/// Points of labelled objects tracked from one frame to another; a structure of arrays. Positions are undistorted
/// pixels, depths [m], 0 = none.
struct FollowedPairs {
  std::vector<float> from_x, from_y, from_depth;
  std::vector<float> to_x, to_y, to_depth;
  std::vector<std::uint16_t> instance;  ///< of the object, 0 = none; empty without instances

  std::size_t size() const { return from_x.size(); }
  void clear() {
    from_x.clear(), from_y.clear(), from_depth.clear(), to_x.clear(), to_y.clear(), to_depth.clear(), instance.clear();
  }
};

/// Transfers the labels of one frame to another on their coarse views. A cell takes the label at its
/// ego-motion-compensated position if the same surface was observed there, or else the label at its position
/// compensated by the motion of followed points of an object, if depth agrees. Then objects grow over neighbouring
/// cells of continuous depth that were free space in the previous view. This labels newly visible parts without
/// spreading over the floor. It follows NGD-SLAM (Zhang et al. 2024, section III-B: points of the last mask are tracked
/// by optical flow and the mask is reconstructed by depth), and adds the ego-motion of the background. Keeps its
/// buffers; one thread.
///
/// Instances are transferred with the labels; a point moves cells of its own instance only.
///
/// Without depth, a cell is labelled if at least half of the tracked points near it come from labelled cells. Labels at
/// the image border are extrapolated beyond it, so that newly visible parts are labelled. Without followed points,
/// labels are transferred by the rotation of the camera.
class MaskTransfer {
 public:
  /// `has_depth`: whether views may have depth; without it, their depths are not read.
  explicit MaskTransfer(const Camera& camera, bool has_depth = true) : camera_(camera), has_depth_(has_depth) {}

  /// `T_to_from` is the motion of the camera. `to` must not be `from`; all its arrays are replaced, its age is kept.
  void transfer(const CoarseView& from_view, const CellMask& from, const CoarseView& to_view,
                const Eigen::Isometry3d& T_to_from, const FollowedPairs& pairs, CellMask& to);

 private:
  struct Job;
  /// A followed pair near the centre of a block.
  struct Neighbour {
    float distance;  // px^2
    std::size_t pair;
  };
  void find_movers(const CoarseGrid& grid, const FollowedPairs& pairs);
  /// Adds a pair that ends at (x, y) to the blocks within reach.
  void add_to_blocks(const CoarseGrid& grid, float x, float y, std::size_t pair);
  /// Keeps the max_movers nearest pairs of a block; of equally distant ones the first.
  static void insert_by_distance(const Neighbour& added, Neighbour* nearest, std::uint8_t& count);
  /// All cells of a view without depth.
  void transfer_by_points_alone(const Job& job, const FollowedPairs& pairs);
  /// Copies the labels of a row from their ego-motion-compensated positions; sets open_columns_.
  void take_row_by_ego_motion(const Job& job, int row);
  void take_by_object_motion(const Job& job, int column, int row);
  void take_without_depth(const Job& job, int column, int row);
  void grow(const CoarseView& to_view, CellMask& to);
  void fill_holes(const CoarseView& to_view, CellMask& to);

  /// A candidate motion of the surface near a block of cells.
  struct Mover {
    int columns, rows;   // cells, from minus to
    float depth_change;  // m, from minus to
    std::uint16_t instance;

    /// Whether this motion applies to a cell of a mask.
    bool moves(const CellMask& mask, std::size_t cell) const {
      return CellMask::is_object(mask.labels[cell]) && (instance == 0 || mask.instances[cell] == instance);
    }
  };
  static constexpr int block = 8;  // cells
  static constexpr int max_movers = 4;

  Camera camera_;
  bool has_depth_;
  int block_columns_ = 0, block_rows_ = 0;
  std::vector<Neighbour> nearest_;  // max_movers for each block
  std::vector<Mover> movers_;       // max_movers for each block
  std::vector<std::uint8_t> mover_count_;
  /// Ego-motion-compensated state of a cell in the previous view.
  enum class CellState : std::uint8_t { same_surface, free_space, occluded, unobserved };
  std::vector<CellState> previous_state_;
  Eigen::ArrayXf rays_x_;
  geometry::WarpedRow warped_;         // cells of the row in work, with their depth
  std::vector<std::int32_t> sources_;  // cells from which ego-motion moves them
  std::vector<int> open_columns_;      // of the row in work, where motion of an object has to be looked for
  std::vector<float> start_depth_;     // depth at which the growth into this cell began [m]
  std::vector<std::int32_t> front_, next_front_;
};

}  // namespace holdfast
