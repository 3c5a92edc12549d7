// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <atomic>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "holdfast/core/camera.hpp"
#include "holdfast/core/module.hpp"
#include "holdfast/geometry/pose_problem.hpp"
#include "holdfast/interfaces/bundle_factors.hpp"

namespace holdfast {

/// Motion-only bundle adjustment: the pose of one camera with fixed points (Mur-Artal and Tardos 2017, equation 3).
/// Entry i of every array belongs to observation i. Residual: undistorted pixel and, where there is depth, column in
/// the virtual right image, minus the projection of the point; weighted by inverse_sigma2 * weight.
struct PoseProblem {
  const Camera* camera = nullptr;
  Eigen::Isometry3d T_camera_world = Eigen::Isometry3d::Identity();  ///< in: first guess; out: the result
  std::vector<Eigen::Vector3d> points;                               ///< world [m]
  std::vector<float> x, y;                                           ///< undistorted [px]
  std::vector<float> right_x;                                        ///< [px], NaN = none
  std::vector<float> inverse_sigma2;                                 ///< [1/px^2]
  std::vector<float> weight;                                         ///< 0 to 1, static probability
  std::vector<std::uint8_t> inlier;                                  ///< out: 1 where the final chi-square test passed

  void clear() {
    points.clear(), x.clear(), y.clear(), right_x.clear(), inverse_sigma2.clear(), weight.clear(), inlier.clear();
  }
  std::size_t size() const { return points.size(); }
};

/// Result of motion-only adjustment.
using geometry::PoseSummary;

/// Adapts PoseProblem to geometry::adjust_pose and geometry::find_pose, which throw CheckError without a camera or for
/// arrays of different lengths.
template <>
struct geometry::PoseProblemTraits<PoseProblem> {
  static Pinhole pinhole(const PoseProblem& problem) { return pinhole_of(*problem.camera); }
  static std::size_t size(const PoseProblem& problem) { return problem.size(); }
  static const Eigen::Vector3d& point(const PoseProblem& problem, std::size_t i) { return problem.points[i]; }
  static Eigen::Vector2d pixel(const PoseProblem& problem, std::size_t i) { return {problem.x[i], problem.y[i]}; }
  static double right_x(const PoseProblem& problem, std::size_t i) { return problem.right_x[i]; }
  static double information(const PoseProblem& problem, std::size_t i) { return problem.inverse_sigma2[i]; }
  static double weight(const PoseProblem& problem, std::size_t i) { return problem.weight[i]; }
  static const Eigen::Isometry3d& pose(const PoseProblem& problem) { return problem.T_camera_world; }
  static void set_pose(PoseProblem& problem, const Eigen::Isometry3d& pose) { problem.T_camera_world = pose; }
  static void set_inlier(PoseProblem& problem, std::size_t i, bool inlier) { problem.inlier[i] = inlier; }
  /// Checks the problem and resizes its inlier flags.
  static void begin(PoseProblem& problem);
};

/// \cond
// Compiled once, in holdfast::interfaces.
extern template PoseSummary geometry::adjust_pose(PoseProblem& problem, const PoseAdjustmentOptions& options);
extern template PoseSummary geometry::find_pose(PoseProblem& problem, const PnpOptions& options);
/// \endcond

/// Poses and points together: local and full bundle adjustment (Mur-Artal and Tardos 2017, section III-C); with factors
/// a visual-inertial one (Mur-Artal and Tardos, "Visual-inertial monocular SLAM with map reuse", RA-L 2017, equation
/// 8).
struct BundleProblem {
  /// The pose of one camera.
  struct Pose {
    Eigen::Isometry3d T_camera_world;  ///< in and out
    bool fixed = false;
  };
  /// Observation of a point by a camera; `pose` and `point` are indices into the lists below.
  struct Observation {
    std::uint32_t pose = 0;
    std::uint32_t point = 0;
    float x = 0, y = 0;        ///< undistorted [px]
    float right_x = 0;         ///< [px], NaN = none
    float inverse_sigma2 = 1;  ///< [1/px^2]
    float weight = 1;          ///< 0 to 1, static probability
    bool outlier = false;      ///< out
  };

  const Camera* camera = nullptr;
  std::vector<Pose> poses;
  std::vector<Eigen::Vector3d> points;  ///< world [m], in and out
  std::vector<Observation> observations;
  BundleFactors factors;      ///< of other kinds than observations; have plain squares in both phases
  int robust_iterations = 5;  ///< with Huber's cost, then outliers are set aside
  int final_iterations = 10;  ///< without it, on what is left; 0 = skip
  /// Convergence tolerance of the relative cost decrease in both phases; 0 = the optimizer's default.
  double function_tolerance = 0.0;
};

/// Result of a bundle adjustment.
struct BundleSummary {
  bool usable = false;   ///< false: nothing was changed
  bool stopped = false;  ///< the stop flag ended it early; the best state so far is in the problem
  int iterations = 0;
  int outliers = 0;
  double initial_cost = 0.0;
  double final_cost = 0.0;
  double seconds = 0.0;
};

/// Keyframe poses linked by relative poses (Mur-Artal and Tardos 2017, section III-D).
struct PoseGraphProblem {
  /// The pose of one keyframe.
  struct Node {
    Eigen::Isometry3d T_camera_world;  ///< in and out
    bool fixed = false;
    double scale = 1.0;  ///< out, of optimize_similarity_graph(): scale factor of lengths around this node
  };
  /// Relative pose measurement between the nodes with indices `from` and `to`.
  struct Edge {
    std::uint32_t from = 0;
    std::uint32_t to = 0;
    Eigen::Isometry3d T_to_from;  ///< measured: maps camera `from` to camera `to`, in the unit of lengths around `to`
    double weight = 1.0;
    double scale = 1.0;  ///< measured scale of the Sim(3) from `from` to `to`; optimize_similarity_graph() only
  };
  std::vector<Node> nodes;
  std::vector<Edge> edges;
  /// Direction of gravity in the world frame, of any length but 0, with which nothing is usable. With it, nodes have
  /// four degrees of freedom, position and yaw about it, and keep roll and pitch (Qin, Li and Shen, "VINS-Mono", T-RO
  /// 2018, section VIII; Campos et al., "ORB-SLAM3", T-RO 2021, section VII); without it, six. Only for optimizers that
  /// keep it (keeps_vertical()).
  std::optional<Eigen::Vector3d> vertical;
  int iterations = 20;
};

/// Result of a pose graph optimization.
struct GraphSummary {
  bool usable = false;
  int iterations = 0;
  double initial_cost = 0.0;
  double final_cost = 0.0;
};

/// Solves the least-squares problems of the pipeline. Any method may be called by several threads at once, each with a
/// problem of its own. With CreationContext::sequential the results are bit-identical from run to run. What is not
/// marked `out` is not written to. Numbers that are not finite in an observation, a factor or an edge make it an
/// outlier or the problem unusable, never a pose or point that is not finite.
class Optimizer : public Module {
 public:
  static constexpr const char* kind = "optimizer";

  /// Motion-only bundle adjustment. The default is geometry::adjust_pose with its default options.
  virtual PoseSummary optimize_pose(PoseProblem& problem);
  /// Whether optimize_bundle() solves problems with factors of this kind. A problem with factors of another kind is not
  /// usable. Poses, motions, gravity and scale that no factor and no observation ties to fixed ones are held only by
  /// the damping.
  virtual bool supports(FactorKind) const { return false; }
  /// `stop` is read between iterations.
  virtual BundleSummary optimize_bundle(BundleProblem& problem, const std::atomic<bool>& stop) = 0;
  virtual GraphSummary optimize_pose_graph(PoseGraphProblem& problem) = 0;
  /// Whether both functions for pose graphs obey PoseGraphProblem::vertical; others ignore it.
  virtual bool keeps_vertical() const { return false; }
  /// Pose graph over Sim(3) for monocular maps with scale drift (Strasdat, Montiel and Davison, "Scale drift-aware
  /// large scale monocular SLAM", RSS 2010). The default optimizes the scales first (a linear problem in their
  /// logarithms), and then the poses in the scaled units by optimize_pose_graph(). Nodes keep scale 1 when the summary
  /// is not usable.
  virtual GraphSummary optimize_similarity_graph(PoseGraphProblem& problem);
};

}  // namespace holdfast
