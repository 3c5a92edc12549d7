// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <span>

#include "holdfast/core/descriptor.hpp"

namespace holdfast::flann_plugin {

/// Descriptors that only ever become more, and the nearest of them by Hamming distance, approximately: FLANN's
/// hierarchical clustering of binary features (Muja and Lowe, "Fast matching of binary features", CRV 2012).
///
/// FLANN itself seeds this clustering from std::random_device, so that no two runs agree. Here the centres of clusters
/// are drawn by a generator of ours (FLANN's chooser, specialised for our distance type), which belongs to the index:
/// same seed and same additions, same answers, whatever else happens in the process; std::rand is not touched.
class CentreIndex {
 public:
  /// `checks`: how many centres a search compares with before it stops, at least.
  CentreIndex(std::uint64_t seed, int checks);
  ~CentreIndex();
  CentreIndex(CentreIndex&& other) noexcept;
  CentreIndex& operator=(CentreIndex&& other) noexcept;

  /// The number of the new one, counted from 0. Now and then, whenever their number has doubled, rebuilds the index.
  std::uint32_t add(const Descriptor& centre);
  /// Puts another descriptor in a centre's place. The clusters follow at the next rebuild, so let it be near.
  void move(std::uint32_t number, const Descriptor& centre) { centres_[number] = centre; }
  std::uint32_t size() const { return static_cast<std::uint32_t>(centres_.size()); }
  const Descriptor& operator[](std::uint32_t number) const { return centres_[number]; }

  /// Fills `nearest`, nearest first, and returns how many there are.
  std::size_t find(const Descriptor& descriptor, std::span<std::uint32_t> nearest) const;

 private:
  struct Tree;

  std::deque<Descriptor> centres_;  // FLANN keeps pointers to them
  std::unique_ptr<Tree> tree_;
  std::uint64_t seed_;
  int checks_;
};

}  // namespace holdfast::flann_plugin
