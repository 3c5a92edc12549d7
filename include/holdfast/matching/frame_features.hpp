// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "holdfast/core/frame.hpp"
#include "holdfast/matching/descriptors.hpp"
#include "holdfast/matching/guided_search.hpp"

namespace holdfast {

namespace matching {

/// Reads the features of a Frame. Positions are undistorted.
template <>
struct ViewTraits<Frame> {
  using Descriptors = DescriptorView;
  static std::size_t size(const Frame& frame) { return frame.size(); }
  static float x(const Frame& frame, std::uint32_t feature) { return frame.x[feature]; }
  static float y(const Frame& frame, std::uint32_t feature) { return frame.y[feature]; }
  static float right_x(const Frame& frame, std::uint32_t feature) { return frame.right_x[feature]; }
  static float angle(const Frame& frame, std::uint32_t feature) { return frame.features.angle[feature]; }
  static int octave(const Frame& frame, std::uint32_t feature) { return frame.features.octave[feature]; }
  static Descriptors descriptors(const Frame& frame) { return frame.features.descriptors; }
  static void near(const Frame& frame, float x, float y, float radius, std::vector<std::uint32_t>& found) {
    frame.grid.query(x, y, radius, found);
  }
  static bool covers(const Frame& frame, float x, float y) { return frame.grid.covers(x, y); }
  static Pinhole camera(const Frame& frame) { return frame.camera->pinhole(); }
  static int predict_level(const Frame& frame, double max_distance, double distance) {
    return frame.pyramid->predict_level(max_distance, distance);
  }
  static float scale(const Frame& frame, int level) { return frame.pyramid->scale[static_cast<std::size_t>(level)]; }
  static float inverse_sigma2(const Frame& frame, int level) {
    return frame.pyramid->inverse_sigma2[static_cast<std::size_t>(level)];
  }
};

extern template class GuidedSearch<Frame>;
extern template class ViewProjection<Frame>;

}  // namespace matching

using FrameSearch = matching::GuidedSearch<Frame>;
using FrameProjection = matching::ViewProjection<Frame>;

/// Prepares the projection of points into a frame from any pose.
FrameProjection projection_into(const Frame& frame, const Eigen::Isometry3d& T_camera_world);

/// Whether a feature with this static probability is more likely static than moving.
inline bool is_static(float static_probability) { return static_probability >= 0.5F; }
/// The same for a feature of a frame. Only static features create map points.
inline bool is_static(const Frame& frame, std::size_t feature) { return is_static(frame.static_probability[feature]); }

/// Sets `usable` to 1 for each static feature and to 0 for the others.
void mark_static(const Frame& frame, std::vector<std::uint8_t>& usable);
/// Copies the descriptors of the static features, in their order, for place recognition without dynamic objects (Zeng
/// et al. 2023, section 3.3). Indices differ from those of the features.
DescriptorBlock static_descriptors(const Frame& frame);
/// Descriptors for place recognition: Frame::image_descriptor for a detector with global descriptors, otherwise the
/// static descriptors.
inline DescriptorBlock place_descriptors(const Frame& frame, bool of_image) {
  return of_image ? frame.image_descriptor : static_descriptors(frame);
}
/// Sets `usable` to 1 for each feature without a map point and to 0 for the others.
void mark_unmatched(const Frame& frame, std::vector<std::uint8_t>& usable);

}  // namespace holdfast
