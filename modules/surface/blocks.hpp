// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <tuple>
#include <utility>
#include <vector>

#include "block_tree.hpp"
#include "holdfast/core/mesh_vertex.hpp"

namespace holdfast::surface {

/// 8^3 voxels: sums over views. Voxel (x, y, z) is entry 64 x + 8 y + z; its position is that of its corner with the
/// smallest coordinates, (8 * coordinates + (x, y, z)) * SurfaceSettings::voxel.
struct Block {
  static constexpr int side = 8, size = side * side * side;
  static constexpr int truncation_units = 256;  ///< of a distance of SurfaceSettings::truncation
  static constexpr int colour_limit = 255;      ///< observations, so that their sum fits 16 bits
  static constexpr float free_below = -1.2F;    ///< balance

  struct Colour {
    std::uint16_t red = 0, green = 0, blue = 0, count = 0;
  };

  /// Views by the class that they gave to a voxel, for the first four classes. The counts are sums, so that a view can
  /// be taken out again.
  struct Votes {
    static constexpr std::uint8_t unknown = MeshVertex::unknown_class;
    std::array<std::uint8_t, 4> label{}, count{};

    void add(std::uint8_t voted, int sign) {
      const auto find = [&](const auto& condition) {
        std::size_t i = 0;
        while (i < label.size() && !condition(i)) ++i;
        return i;
      };
      std::size_t i = find([&](std::size_t k) { return count[k] > 0 && label[k] == voted; });
      if (i == label.size() && sign > 0) i = find([&](std::size_t k) { return count[k] == 0; });
      if (i == label.size()) return;
      if (sign > 0 && count[i] == 255)
        for (std::uint8_t& one : count) one /= 2;
      label[i] = voted;
      count[i] = static_cast<std::uint8_t>(count[i] + sign);
    }
    /// The class with most votes, the smallest label of several; unknown without any.
    std::uint8_t winner() const {
      std::uint8_t best = unknown, most = 0;
      for (std::size_t i = 0; i < label.size(); ++i)
        if (count[i] > most || (count[i] == most && most > 0 && label[i] < best)) best = label[i], most = count[i];
      return best;
    }
  };

  Eigen::Vector3i coordinates = Eigen::Vector3i::Zero();
  std::uint64_t birth = 0;                           ///< position in the order of creation
  std::uint64_t version = 0;                         ///< Blocks::version() of the last change
  std::array<std::int32_t, size> distance{};         ///< sum of weight * distance
  std::array<float, size> balance{};                 ///< see SurfaceField, in units of a view with the number `last`
  std::array<std::uint16_t, size> weight{};          ///< sum
  std::array<std::uint16_t, size> last{};            ///< largest number of a view in the balance
  std::array<std::uint8_t, size> views{};            ///< that observed the surface as static
  std::array<std::uint8_t, size> moving{};           ///< that observed a surface as dynamic
  std::unique_ptr<std::array<Colour, size>> colour;  ///< near the surface
  std::unique_ptr<std::array<Votes, size>> votes;    ///< the same, where views have classes

  static constexpr int index(int x, int y, int z) { return (x * side + y) * side + z; }

  bool is_observed(std::size_t at, int minimum_views) const {
    return weight[at] > 0 && views[at] >= minimum_views && 2 * views[at] > moving[at];
  }
  /// Mean distance of an observed voxel, from -1 to 1.
  float mean(std::size_t at) const {
    return static_cast<float>(distance[at]) / (static_cast<float>(weight[at]) * static_cast<float>(truncation_units));
  }
  /// Whether a surface was observed at a voxel that has become free.
  bool is_gone(std::size_t at, int minimum_views) const {
    return balance[at] < free_below && is_observed(at, minimum_views) && mean(at) < 0.5F;
  }

  /// Truncated distance from -1 to 1, or NaN where nothing is known.
  float value(int i, int minimum_views) const {
    const auto at = static_cast<std::size_t>(i);
    const bool is_free = balance[at] < free_below;
    if (is_observed(at, minimum_views)) return is_free ? std::max(mean(at), 0.5F) : mean(at);
    return is_free ? 1.0F : std::numeric_limits<float>::quiet_NaN();
  }
};

/// The class of a voxel, or MeshVertex::unknown_class.
inline std::uint8_t label_of(const Block& block, std::size_t voxel) {
  return block.votes ? (*block.votes)[voxel].winner() : Block::Votes::unknown;
}

/// All blocks, in the order of their creation, and the tree that finds them by their coordinates.
class Blocks {
 public:
  Block& at(const Eigen::Vector3i& coordinates) {
    const std::int32_t found = tree_.find(coordinates);
    if (found >= 0) return *blocks_[static_cast<std::size_t>(found)];
    tree_.set(coordinates, static_cast<std::int32_t>(blocks_.size()));
    coordinates_.push_back(coordinates);
    blocks_.push_back(std::make_unique<Block>());
    blocks_.back()->coordinates = coordinates;
    blocks_.back()->birth = births_++;
    blocks_.back()->version = version_;
    return *blocks_.back();
  }
  /// Position in list(), or -1.
  std::int32_t find(const Eigen::Vector3i& coordinates) const { return tree_.find(coordinates); }
  const std::vector<std::unique_ptr<Block>>& list() const { return blocks_; }
  /// Block::coordinates of list(), side by side in memory.
  const std::vector<Eigen::Vector3i>& coordinates() const { return coordinates_; }
  std::uint64_t births() const { return births_; }
  /// Number of changes so far.
  std::uint64_t version() const { return version_; }
  void begin_change() { ++version_; }

  /// A block that was removed.
  struct Removal {
    Eigen::Vector3i coordinates;
    std::uint64_t version = 0;
  };
  /// The last removal of each block that was removed.
  const std::vector<Removal>& removals() const { return removals_; }

  template <class Condition>
  void remove_if(const Condition& condition) {
    const std::size_t before = removals_.size();
    begin_change();
    std::erase_if(blocks_, [&](const std::unique_ptr<Block>& block) {
      if (!condition(*block)) return false;
      removals_.push_back({block->coordinates, version_});
      return true;
    });
    if (removals_.size() == before) return;
    tree_.clear();
    coordinates_.clear();
    for (std::size_t i = 0; i < blocks_.size(); ++i) {
      coordinates_.push_back(blocks_[i]->coordinates);
      tree_.set(blocks_[i]->coordinates, static_cast<std::int32_t>(i));
    }
    forget_earlier_removals();
  }

 private:
  void forget_earlier_removals() {
    const auto values = [](const Removal& r) {
      return std::tuple(r.coordinates.x(), r.coordinates.y(), r.coordinates.z());
    };
    std::stable_sort(removals_.begin(), removals_.end(),
                     [&](const Removal& a, const Removal& b) { return values(a) < values(b); });
    // Of those at one place the last one stays.
    const auto last = std::unique(removals_.rbegin(), removals_.rend(),
                                  [&](const Removal& a, const Removal& b) { return values(a) == values(b); });
    removals_.erase(removals_.begin(), last.base());
  }

  BlockTree tree_;
  std::vector<std::unique_ptr<Block>> blocks_;
  std::vector<Eigen::Vector3i> coordinates_;
  std::vector<Removal> removals_;
  std::uint64_t births_ = 0, version_ = 0;
};

}  // namespace holdfast::surface
