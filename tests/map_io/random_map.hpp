// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <vector>

#include "holdfast/core/map.hpp"
#include "holdfast/core/random.hpp"

namespace holdfast::test {

/// A map made through its own functions, with keyframes and points removed again, so that slots have holes and are used
/// twice; two cameras, two pyramids, a loop, evidence of all signs.
inline Map random_map(int keyframes, std::size_t features, std::uint64_t seed, const MapFeatures& map_features = {}) {
  Random random(seed);
  const auto real = [&](double low, double high) { return random.uniform(low, high); };
  Camera exposed_at_once = *find_camera("tum_fr1");  // like those of all maps
  exposed_at_once.readout = 0.0;
  std::vector<std::shared_ptr<const Camera>> cameras = {std::make_shared<const Camera>(exposed_at_once),
                                                        std::make_shared<const Camera>()};
  const std::vector<std::shared_ptr<const ScalePyramid>> pyramids = {std::make_shared<const ScalePyramid>(8, 1.2),
                                                                     std::make_shared<const ScalePyramid>(4, 1.5)};
  Map map;
  map.set_features(map_features);
  std::vector<KeyFrameId> ids;
  for (int k = 0; k < keyframes; ++k) {
    Frame frame;
    frame.index = static_cast<std::uint64_t>(7 * k + 3);
    frame.timestamp = 1305031102.175304 + 0.23 * k;
    frame.camera = cameras[k % 5 == 4 ? 1 : 0];
    frame.pyramid = pyramids[k % 7 == 6 ? 1 : 0];
    frame.features.resize(features, map_features.descriptors);
    for (std::size_t f = 0; f < features; ++f) {
      Features& all = frame.features;
      all.x[f] = static_cast<float>(real(0, 639)), all.y[f] = static_cast<float>(real(0, 479));
      all.angle[f] = static_cast<float>(real(0, 6.28)), all.response[f] = static_cast<float>(real(0, 200));
      all.octave[f] = static_cast<std::uint8_t>(random.below(static_cast<std::uint32_t>(frame.pyramid->levels())));
      if (map_features.descriptors.kind == DescriptorKind::float32)
        for (float& number : all.descriptors.numbers(f)) number = static_cast<float>(real(-1, 1));
      else
        for (std::size_t byte = 0; byte < all.descriptors.bytes(f).size(); byte += 8) {
          const std::uint64_t word = random.next();
          const std::span<std::byte> rest = all.descriptors.bytes(f).subspan(byte);
          std::memcpy(rest.data(), &word, std::min<std::size_t>(8, rest.size()));
        }
      frame.x.push_back(all.x[f] + 0.3F), frame.y.push_back(all.y[f] - 0.2F);
      const bool has_depth = f % 3 != 0;
      frame.depth.push_back(has_depth ? static_cast<float>(real(0.5, 5)) : 0.0F);
      frame.right_x.push_back(has_depth ? frame.x.back() - 42.0F / frame.depth.back()
                                        : std::numeric_limits<float>::quiet_NaN());
      frame.static_probability.push_back(static_cast<float>(real(0, 1)));
    }
    frame.map_points.assign(features, MapPointId());
    // Two thirds of the features show points that are there.
    const std::vector<MapPointId> there = map.points().ids();
    for (std::size_t f = 0; f < features * 2 / 3 && f < there.size(); ++f)
      frame.map_points[f] = there[there.size() - 1 - f];
    const Eigen::Quaterniond rotation(Eigen::Vector4d(real(-1, 1), real(-1, 1), real(-1, 1), 2).normalized());
    frame.T_camera_world = Eigen::Translation3d(real(-3, 3), real(-1, 1), real(-3, 3)) * rotation;
    const KeyFrameId id = map.add_keyframe(std::move(frame));
    for (std::uint32_t f = 0; f < features; ++f) {
      if (map.keyframe(id).frame.map_points[f].valid() || f % 5 == 4) continue;
      const MapPointId point = map.add_point({real(-4, 4), real(-1, 2), real(1, 6)}, map.keyframe(id).sequence);
      map.point(point).static_log_odds = static_cast<float>(real(-3, 3));
      map.point(point).visible_count = 1 + random.below(50);
      map.point(point).found_count = 1 + random.below(20);
      map.add_observation(point, id, f);
    }
    for (const MapPointId point : map.keyframe(id).frame.map_points)
      if (point.valid()) map.update_point(point);
    map.set_covisibility_minimum(3);
    map.update_covisibility(id);
    ids.push_back(id);
    // Gone again, so that later ones reuse the slots.
    if (k > 3 && k % 3 == 0 && map.keyframe(ids[static_cast<std::size_t>(k - 2)]).parent.valid())
      map.remove_keyframe(ids[static_cast<std::size_t>(k - 2)]);
    if (k % 2 == 1)
      for (int i = 0; i < 3; ++i) {
        const std::vector<MapPointId> points = map.points().ids();
        map.remove_point(points[random.below(static_cast<std::uint32_t>(points.size()))]);
      }
  }
  const std::vector<KeyFrameId> left = map.keyframes().ids();
  if (left.size() > 4) {
    map.add_loop_edge(left[0], left.back());
    map.add_loop_edge(left[3], left[1]);
  }
  return map;
}

}  // namespace holdfast::test
