// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/matching/frame_features.hpp"

namespace holdfast {

template class matching::GuidedSearch<Frame>;
template class matching::ViewProjection<Frame>;

FrameProjection projection_into(const Frame& frame, const Eigen::Isometry3d& T_camera_world) {
  return FrameProjection(frame, T_camera_world.linear(), T_camera_world.translation());
}

void mark_static(const Frame& frame, std::vector<std::uint8_t>& usable) {
  usable.resize(frame.size());
  for (std::size_t i = 0; i < usable.size(); ++i) usable[i] = is_static(frame, i) ? 1 : 0;
}

DescriptorBlock static_descriptors(const Frame& frame) {
  DescriptorBlock descriptors(frame.features.descriptors.type());
  descriptors.reserve(frame.size());
  for (std::size_t i = 0; i < frame.size(); ++i)
    if (is_static(frame, i)) descriptors.append(frame.features.descriptors, i);
  return descriptors;
}

void mark_unmatched(const Frame& frame, std::vector<std::uint8_t>& usable) {
  usable.resize(frame.size());
  for (std::size_t i = 0; i < usable.size(); ++i) usable[i] = frame.map_points[i].valid() ? 0 : 1;
}

}  // namespace holdfast
