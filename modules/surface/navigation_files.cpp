// SPDX-License-Identifier: BSD-3-Clause
#include <array>
#include <cstdio>

#include "holdfast/core/check.hpp"
#include "holdfast/surface/free_space.hpp"

namespace holdfast {

namespace {

constexpr int octree_depth = 16;

/// Writes an octree over a grid from its root, whose cells begin at -2^15 along each axis.
class OctreeWriter {
 public:
  OctreeWriter(const FreeSpace& space, const Eigen::Vector3i& first) : space_(space), first_(first) {}

  std::string data;
  std::size_t nodes = 0;

  /// Writes the children of a node, whose lowest cell is `corner` and whose side is 2^level cells.
  void write(const Eigen::Vector3i& corner, int level) {
    ++nodes;
    const int half = 1 << (level - 1);
    std::array<Content, 8> contents{};
    unsigned bits = 0;
    for (int child = 0; child < 8; ++child) {
      contents[static_cast<std::size_t>(child)] = content(corner_of(corner, child, half), half);
      bits |= bits_of(contents[static_cast<std::size_t>(child)]) << (2 * child);
    }
    data += static_cast<char>(bits & 255U);
    data += static_cast<char>(bits >> 8U);
    for (int child = 0; child < 8; ++child) {
      const Content inside = contents[static_cast<std::size_t>(child)];
      if (inside == Content::mixed)
        write(corner_of(corner, child, half), level - 1);
      else if (inside != Content::unknown)
        ++nodes;
    }
  }

 private:
  enum class Content { unknown, free, occupied, mixed };

  static unsigned bits_of(Content content) {
    switch (content) {
      case Content::free:
        return 1;
      case Content::occupied:
        return 2;
      case Content::mixed:
        return 3;
      case Content::unknown:
        break;
    }
    return 0;
  }
  static Eigen::Vector3i corner_of(const Eigen::Vector3i& corner, int child, int half) {
    return corner + half * Eigen::Vector3i(child & 1, (child >> 1) & 1, (child >> 2) & 1);
  }

  /// What a cube holds: one state, or several.
  Content content(const Eigen::Vector3i& corner, int side) const {
    const Eigen::Vector3i low = (corner - first_).cwiseMax(0);
    const Eigen::Vector3i high = (corner - first_ + Eigen::Vector3i::Constant(side)).cwiseMin(space_.size());
    if ((low.array() >= high.array()).any()) return Content::unknown;
    const bool is_inside = ((high - low).array() == side).all();
    const Occupancy first = is_inside ? space_.at(low) : Occupancy::unknown;
    for (int z = low.z(); z < high.z(); ++z)
      for (int y = low.y(); y < high.y(); ++y)
        for (int x = low.x(); x < high.x(); ++x)
          if (space_.at(Eigen::Vector3i(x, y, z)) != first) return Content::mixed;
    return first == Occupancy::free       ? Content::free
           : first == Occupancy::occupied ? Content::occupied
                                          : Content::unknown;
  }

  const FreeSpace& space_;
  Eigen::Vector3i first_;  // cell of the grid's corner, as counted from the world's origin
};

}  // namespace

std::string FreeSpace::octomap() const {
  const Eigen::Vector3i first = (origin_ / resolution_).array().round().cast<int>();
  OctreeWriter writer(*this, first);
  if (!states_.empty()) writer.write(Eigen::Vector3i::Constant(-(1 << (octree_depth - 1))), octree_depth);
  std::array<char, 64> resolution{};
  std::snprintf(resolution.data(), resolution.size(), "%.9g", resolution_);
  return "# Octomap OcTree binary file\n# (feel free to add / change comments, but leave the first line as it is!)\n#\n"
         "id OcTree\nsize " +
         std::to_string(writer.nodes) + "\nres " + resolution.data() + "\ndata\n" + writer.data;
}

std::string grid_map_pgm(const GridMap& map) {
  std::string bytes = "P5\n" + std::to_string(map.width) + " " + std::to_string(map.height) + "\n255\n";
  for (int row = map.height - 1; row >= 0; --row)
    for (int column = 0; column < map.width; ++column) {
      const Occupancy state = map.at(column, row);
      bytes += static_cast<char>(state == Occupancy::occupied ? 0 : state == Occupancy::free ? 254 : 205);
    }
  return bytes;
}

std::string grid_map_yaml(const GridMap& map, const std::string& image) {
  std::array<char, 256> text{};
  std::snprintf(text.data(), text.size(),
                "image: %s\nresolution: %.9g\norigin: [%.6f, %.6f, 0.0]\nnegate: 0\noccupied_thresh: 0.65\n"
                "free_thresh: 0.196\nmode: trinary\n",
                image.c_str(), map.resolution, map.origin.x(), map.origin.y());
  std::string yaml = text.data();
  yaml += "# T_map_world, row by row:\n";
  for (int row = 0; row < 3; ++row) {
    std::snprintf(text.data(), text.size(), "#   %.9f %.9f %.9f %.9f\n", map.T_map_world(row, 0),
                  map.T_map_world(row, 1), map.T_map_world(row, 2), map.T_map_world(row, 3));
    yaml += text.data();
  }
  return yaml;
}

}  // namespace holdfast
