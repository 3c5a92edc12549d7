// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cstdio>
#include <cstring>
#include <limits>

#include "holdfast/core/check.hpp"
#include "holdfast/surface/free_space.hpp"

namespace holdfast {

namespace {

constexpr int octree_depth = 16;

/// Writes an octree over a grid from its root, whose cells begin at -2^15 along each axis.
class OctreeWriter {
 public:
  OctreeWriter(const FreeSpace& space, const Eigen::Vector3i& first, bool with_probabilities)
      : space_(space), first_(first), with_probabilities_(with_probabilities) {}

  std::string data;
  std::size_t nodes = 0;

  void write() {
    if (content(root_, 1 << octree_depth).is_unknown()) return;
    if (with_probabilities_)
      write_probabilities(root_, octree_depth);
    else
      write_states(root_, octree_depth);
  }

 private:
  /// What a cube holds: one value, or several; 0 = unknown.
  struct Content {
    int value = 0;
    bool is_mixed = false;
    bool is_unknown() const { return value == 0 && !is_mixed; }
  };

  /// Writes the children of a node, whose lowest cell is `corner` and whose side is 2^level cells: two bits for each.
  void write_states(const Eigen::Vector3i& corner, int level) {
    ++nodes;
    const int half = 1 << (level - 1);
    std::array<Content, 8> contents;
    unsigned bits = 0;
    for (unsigned child = 0; child < 8; ++child) {
      const Content& inside = contents[child] = content(corner_of(corner, child, half), half);
      bits |= (inside.is_mixed ? 3U : inside.value < 0 ? 1U : inside.value > 0 ? 2U : 0U) << (2 * child);
    }
    data += static_cast<char>(bits & 255U);
    data += static_cast<char>(bits >> 8U);
    for (unsigned child = 0; child < 8; ++child) {
      if (contents[child].is_mixed)
        write_states(corner_of(corner, child, half), level - 1);
      else if (!contents[child].is_unknown())
        ++nodes;
    }
  }

  /// Writes a node with what is below it, and returns its log-odds: of an inner node, the largest of its children.
  float write_probabilities(const Eigen::Vector3i& corner, int level) {
    ++nodes;
    const Content inside = content(corner, 1 << level);
    const std::size_t place = data.size();
    data.append(sizeof(float) + 1, '\0');
    float log_odds = -std::numeric_limits<float>::infinity();
    if (!inside.is_mixed) {
      log_odds = FreeSpace::log_odds(inside.value);
    } else {
      const int half = 1 << (level - 1);
      unsigned bits = 0;
      for (unsigned child = 0; child < 8; ++child) {
        const Eigen::Vector3i lowest = corner_of(corner, child, half);
        if (content(lowest, half).is_unknown()) continue;
        bits |= 1U << child;
        log_odds = std::max(log_odds, write_probabilities(lowest, level - 1));
      }
      data[place + sizeof(float)] = static_cast<char>(bits);
    }
    std::memcpy(data.data() + place, &log_odds, sizeof(log_odds));
    return log_odds;
  }

  static Eigen::Vector3i corner_of(const Eigen::Vector3i& corner, unsigned child, int half) {
    return corner + half * Eigen::Vector3i(child & 1U, (child >> 1U) & 1U, (child >> 2U) & 1U);
  }

  int value_at(const Eigen::Vector3i& cell) const {
    const int evidence = space_.evidence(cell);
    return with_probabilities_ ? evidence : (evidence > 0) - (evidence < 0);
  }

  Content content(const Eigen::Vector3i& corner, int side) const {
    const Eigen::Vector3i low = (corner - first_).cwiseMax(0);
    const Eigen::Vector3i high = (corner - first_ + Eigen::Vector3i::Constant(side)).cwiseMin(space_.size());
    if ((low.array() >= high.array()).any()) return {};
    const bool is_inside = ((high - low).array() == side).all();
    const int first = is_inside ? value_at(low) : 0;
    for (int z = low.z(); z < high.z(); ++z)
      for (int y = low.y(); y < high.y(); ++y)
        for (int x = low.x(); x < high.x(); ++x)
          if (value_at(Eigen::Vector3i(x, y, z)) != first) return {0, true};
    return {first, false};
  }

  const Eigen::Vector3i root_ = Eigen::Vector3i::Constant(-(1 << (octree_depth - 1)));
  const FreeSpace& space_;
  Eigen::Vector3i first_;  // cell of the grid's corner, as counted from the world's origin
  bool with_probabilities_;
};

std::string octree(const FreeSpace& space, const Eigen::Vector3i& first, bool with_probabilities) {
  OctreeWriter writer(space, first, with_probabilities);
  writer.write();
  std::array<char, 64> resolution{};
  std::snprintf(resolution.data(), resolution.size(), "%.9g", space.resolution());
  return std::string("# Octomap OcTree ") + (with_probabilities ? "file" : "binary file") +
         "\n# (feel free to add / change comments, but leave the first line as it is!)\n#\nid OcTree\nsize " +
         std::to_string(writer.nodes) + "\nres " + resolution.data() + "\ndata\n" + writer.data;
}

}  // namespace

std::string FreeSpace::octomap() const { return octree(*this, first_cell(), false); }
std::string FreeSpace::octomap_probabilities() const { return octree(*this, first_cell(), true); }

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
