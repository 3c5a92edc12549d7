// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// Tolerances of depth comparisons. The axial noise of a structured-light sensor grows with the square of depth
/// (Khoshelham and Oude Elberink 2012: a few millimetres at 0.5 m, 4 cm at 5 m). Within the size of a room a linear
/// function is an upper bound. The tolerances include errors of the relative pose and of the interpolation between
/// pixels and, for moving surfaces, of the estimated motion.
namespace holdfast {

/// A tolerance that is linear in depth.
struct DepthTolerance {
  float offset;  ///< [m]
  float slope;   ///< [m per m of depth]
  constexpr float operator()(float depth) const { return offset + slope * depth; }
};

namespace depth_noise {

/// Maximum difference of the depths of one static surface seen from two poses.
/// @{
inline constexpr DepthTolerance same_place{0.01F, 0.012F};   ///< consecutive views, pose of the motion model
inline constexpr DepthTolerance agreement{0.01F, 0.01F};     ///< a keyframe and a hypothetical pose
inline constexpr DepthTolerance same_in_view{0.02F, 0.02F};  ///< a keyframe of up to 10 s ago, estimated pose
/// @}

/// Maximum difference of the depths of one moving surface seen from two poses, compensated by its motion.
inline constexpr DepthTolerance same_surface{0.015F, 0.02F};

/// Minimum difference of the depths of two surfaces of which one occludes the other.
/// @{
inline constexpr DepthTolerance occlusion{0.02F, 0.03F};  ///< consecutive views
inline constexpr DepthTolerance farther{0.05F, 0.03F};    ///< see-through: more depth than the surface of a keyframe
inline constexpr DepthTolerance slid_off{0.1F, 0.05F};  ///< a point tracked by optical flow has drifted off its object
/// @}

/// Maximum difference of the depths of neighbouring cells of one surface in one view, by the distance of the cells.
/// @{
inline constexpr DepthTolerance continues{0.02F, 0.015F};        ///< adjacent cells
inline constexpr DepthTolerance continues_normal{0.03F, 0.03F};  ///< cells from which a surface normal is computed
inline constexpr DepthTolerance continues_block{0.03F, 0.02F};   ///< adjacent blocks of two cells
inline constexpr DepthTolerance continues_region{0.04F, 0.02F};  ///< adjacent blocks of a moving region
/// @}

/// Standard deviation of a depth in dense alignment [m], including errors that are correlated between neighbouring
/// cells.
constexpr float alignment_deviation(float depth) { return 0.02F + 0.01F * depth * depth; }

}  // namespace depth_noise

}  // namespace holdfast
