// SPDX-License-Identifier: BSD-3-Clause
#include "remnants.hpp"

#include <algorithm>
#include <vector>

namespace holdfast::surface {

namespace {

/// The vertices of a part: the last views of the surface that stands there, and of the carved surface beside.
struct Record {
  std::vector<std::uint16_t> own, beside;
};

class Voxels {
 public:
  Voxels(const Blocks& blocks, const SurfaceSettings& settings) : blocks_(blocks), settings_(settings) {}

  void record(const Eigen::Vector3f& position, Record& record) const {
    constexpr int reach = 2;
    const Eigen::Vector3i centre = (position / static_cast<float>(settings_.voxel)).array().round().cast<int>();
    std::uint16_t own = 0, beside = 0;
    for (int x = -reach; x <= reach; ++x)
      for (int y = -reach; y <= reach; ++y)
        for (int z = -reach; z <= reach; ++z) {
          const Eigen::Vector3i offset(x, y, z), voxel = centre + offset;
          const Eigen::Vector3i coordinates(voxel.x() >> 3, voxel.y() >> 3, voxel.z() >> 3);
          const std::int32_t found = blocks_.find(coordinates);
          if (found < 0) continue;
          const Block& block = *blocks_.list()[static_cast<std::size_t>(found)];
          const auto i = static_cast<std::size_t>(Block::index(voxel.x() & 7, voxel.y() & 7, voxel.z() & 7));
          if (block.is_gone(i, settings_.minimum_views))
            beside = std::max(beside, block.last[i]);
          else if (offset.cwiseAbs().maxCoeff() <= 1 && block.balance[i] > 0.0F &&
                   block.is_observed(i, settings_.minimum_views))
            own = std::max(own, block.last[i]);
        }
    record.own.push_back(own);
    if (beside > 0) record.beside.push_back(beside);
  }

 private:
  const Blocks& blocks_;
  const SurfaceSettings& settings_;
};

/// The value that a share of all values is below.
std::uint16_t quantile(std::vector<std::uint16_t>& values, double share) {
  const auto place = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + place, values.end());
  return values[static_cast<std::size_t>(place)];
}

/// Most of what is beside the part was carved, and after the last view of the part.
bool is_remnant(Record& record) {
  if (record.beside.empty() || 2 * record.beside.size() < record.own.size()) return false;
  return quantile(record.own, 0.9) < quantile(record.beside, 0.5);
}

}  // namespace

void remove_remnants(TriangleMesh& mesh, const Blocks& blocks, const SurfaceSettings& settings) {
  constexpr double largest_area = 0.5;  // [m^2], of a part of a person
  const MeshParts parts(mesh);
  const Voxels voxels(blocks, settings);
  std::vector<Record> records(mesh.vertices.size());
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
    if (const std::uint32_t part = parts.part[i];
        parts.area[part] <= largest_area && parts.area[part] >= settings.smallest_part)
      voxels.record(mesh.vertices[i].position, records[part]);
  std::vector<bool> is_removed;
  for (Record& record : records) is_removed.push_back(is_remnant(record));
  remove_triangles(mesh, [&](const auto& triangle) { return is_removed[parts.part[triangle[0]]]; });
}

}  // namespace holdfast::surface
