// SPDX-License-Identifier: BSD-3-Clause
#include "shown_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace holdfast::viewer {

namespace {

/// Smaller changes of a vertex are not worth a message.
constexpr float smallest_move = 3e-3F;  // [m]
constexpr int smallest_tint = 12;       // of a colour, of 255

std::uint64_t key_of(const Eigen::Vector3i& cube) {
  constexpr int axis_bits = 21;
  std::uint64_t key = 0;
  for (int axis = 0; axis < 3; ++axis)
    key = key << axis_bits | (static_cast<std::uint64_t>(cube[axis]) & ((1U << axis_bits) - 1));
  return key;
}

bool looks_the_same(const MeshVertex& a, const MeshVertex& b) {
  const auto is_near = [](int x, int y) { return std::abs(x - y) <= smallest_tint; };
  return (a.position - b.position).squaredNorm() <= smallest_move * smallest_move && is_near(a.red, b.red) &&
         is_near(a.green, b.green) && is_near(a.blue, b.blue) && a.label == b.label;
}

bool looks_the_same(const SurfacePatch& a, const SurfacePatch& b) {
  return a.triangles == b.triangles &&
         std::equal(a.vertices.begin(), a.vertices.end(), b.vertices.begin(), b.vertices.end(),
                    [](const MeshVertex& x, const MeshVertex& y) { return looks_the_same(x, y); });
}

/// From -1 .. 1 to one byte.
std::uint8_t byte_of(float value) {
  return static_cast<std::uint8_t>(std::lround(127.5F + 127.5F * std::clamp(value, -1.0F, 1.0F)));
}

}  // namespace

void ShownMesh::clear() {
  slots_.clear();
  slot_of_.clear();
  changes_.clear();
  triangles_ = 0;
  ++number_;
}

void ShownMesh::put(std::uint32_t number, SurfacePatch patch) {
  Slot& slot = slots_[number];
  changes_.erase(slot.change);
  triangles_ += patch.triangles.size();
  triangles_ -= slot.patch.triangles.size();
  slot.patch = std::move(patch);
  slot.change = ++change_;
  changes_.emplace(slot.change, number);
}

void ShownMesh::add(std::vector<SurfacePatch> patches, int coarseness) {
  if (coarseness < wanted_) return;
  if (coarseness != shown_) clear();
  shown_ = coarseness;
  for (SurfacePatch& patch : patches) {
    const auto found = slot_of_.find(key_of(patch.cube));
    if (found != slot_of_.end()) {
      if (!looks_the_same(slots_[found->second].patch, patch)) put(found->second, std::move(patch));
      continue;
    }
    const bool is_full = coarseness == coarsest && triangles_ + patch.triangles.size() > most_triangles;
    if (patch.triangles.empty() || is_full) continue;
    const auto number = static_cast<std::uint32_t>(slots_.size());
    slot_of_.emplace(key_of(patch.cube), number);
    slots_.emplace_back();
    put(number, std::move(patch));
  }
  if (triangles_ > most_triangles) wanted_ = std::min(shown_ + 1, coarsest);
}

void ShownMesh::replace(std::vector<SurfacePatch> patches) {
  clear();
  for (SurfacePatch& patch : patches) {
    slots_.emplace_back();
    put(static_cast<std::uint32_t>(slots_.size() - 1), std::move(patch));
  }
}

bool ShownMesh::has_more(const MeshProgress& progress) const {
  if (slots_.empty() && progress.number == 0) return false;
  return progress.number != number_ || progress.change < change_;
}

void ShownMesh::describe(MeshProgress& progress, Message& message) const {
  if (!has_more(progress)) return;
  if (progress.number != number_) {
    progress = {number_, 0};
    message.json()["new_mesh"] = true;
  }
  std::vector<std::uint32_t> slots, sizes;
  std::vector<float> places;
  std::vector<std::uint8_t> tints;
  std::vector<std::uint16_t> corners;
  auto next = changes_.upper_bound(progress.change);
  for (; next != changes_.end() && corners.size() < 3 * most_in_message; ++next) {
    const SurfacePatch& patch = slots_[next->second].patch;
    slots.push_back(next->second);
    sizes.push_back(static_cast<std::uint32_t>(patch.vertices.size()));
    sizes.push_back(static_cast<std::uint32_t>(patch.triangles.size()));
    for (const MeshVertex& vertex : patch.vertices) {
      for (int axis = 0; axis < 3; ++axis) places.push_back(vertex.position[axis]);
      for (int axis = 0; axis < 3; ++axis) tints.push_back(byte_of(vertex.normal[axis]));
      tints.insert(tints.end(), {vertex.label, vertex.red, vertex.green, vertex.blue, 255});
    }
    for (const auto& triangle : patch.triangles) corners.insert(corners.end(), triangle.begin(), triangle.end());
    progress.change = next->first;
  }
  if (next == changes_.end()) progress.change = change_;
  message.add("patch_slots", slots);
  message.add("patch_sizes", sizes);
  message.add("patch_places", places);
  message.add("patch_tints", tints);
  message.add("patch_corners", corners);
}

}  // namespace holdfast::viewer
