// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// Tolerances of depth comparisons. The axial noise of a structured-light sensor grows with the square of depth
/// (Khoshelham and Oude Elberink 2012: a few millimetres at 0.5 m, 4 cm at 5 m); over the depths of a room a line
/// bounds it from above. They include the errors of the relative pose and of the interpolation between pixels if the
/// two depths come from different poses, and the error of the motion of a moving surface.
namespace holdfast {

/// A tolerance that is linear in depth.
struct DepthTolerance {
  float offset;  ///< [m]
  float slope;   ///< [m per m of depth]
  constexpr float operator()(float depth) const { return offset + slope * depth; }
};

namespace depth_noise {

/// The same static surface from two poses: depths differ by less.
/// @{
inline constexpr DepthTolerance same_place{0.01F, 0.012F};   ///< consecutive views, pose of the motion model
inline constexpr DepthTolerance agreement{0.01F, 0.01F};     ///< a keyframe and a pose that is tested against it
inline constexpr DepthTolerance same_in_view{0.02F, 0.02F};  ///< a keyframe of up to 10 s ago, estimated pose
/// @}

/// The same moving surface from two poses, when its motion is known: depths differ by less.
inline constexpr DepthTolerance same_surface{0.015F, 0.02F};

/// Two surfaces, one of which occludes the other: depths differ by more.
/// @{
inline constexpr DepthTolerance occlusion{0.02F, 0.03F};  ///< consecutive views
inline constexpr DepthTolerance farther{0.05F, 0.03F};    ///< see-through: more depth than the surface of a keyframe
inline constexpr DepthTolerance slid_off{0.1F, 0.05F};    ///< an image point tracked by flow has left its object
/// @}

/// Neighbouring cells of one surface in one view: depths differ by less. The distance of the cells differs.
/// @{
inline constexpr DepthTolerance continues{0.02F, 0.015F};        ///< adjacent cells
inline constexpr DepthTolerance continues_normal{0.03F, 0.03F};  ///< cells from which a surface normal is computed
inline constexpr DepthTolerance continues_block{0.03F, 0.02F};   ///< adjacent blocks of two cells
inline constexpr DepthTolerance continues_region{0.04F, 0.02F};  ///< adjacent blocks of a moving region
/// @}

/// Standard deviation of a depth in dense alignment [m]: noise, and errors that neighbouring cells share.
constexpr float alignment_deviation(float depth) { return 0.02F + 0.01F * depth * depth; }

}  // namespace depth_noise

}  // namespace holdfast
