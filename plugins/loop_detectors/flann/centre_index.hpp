// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <span>

#include "holdfast/core/descriptor.hpp"

namespace holdfast::flann_plugin {

/// Approximate nearest neighbours by Hamming distance among a growing set of descriptors: FLANN's hierarchical
/// clustering of binary features (Muja and Lowe, "Fast matching of binary features", CRV 2012).
///
/// FLANN seeds this clustering from std::random_device, so that its results differ between runs. Here the cluster
/// centres are drawn by a generator of the index (FLANN's chooser, specialised for the distance type of this plugin):
/// the same seed and additions give the same results, independent of the rest of the process; std::rand is not used.
class CentreIndex {
 public:
  /// `checks`: minimum number of centres that a search compares before it stops.
  CentreIndex(std::uint64_t seed, int checks);
  ~CentreIndex();
  CentreIndex(CentreIndex&& other) noexcept;
  CentreIndex& operator=(CentreIndex&& other) noexcept;

  /// Adds a centre and returns its index, from 0. Rebuilds the FLANN index whenever the number of centres has doubled.
  std::uint32_t add(const Descriptor& centre);
  /// Replaces a centre. The clusters are updated at the next rebuild, so that the new descriptor should be near.
  void move(std::uint32_t number, const Descriptor& centre) { centres_[number] = centre; }
  std::uint32_t size() const { return static_cast<std::uint32_t>(centres_.size()); }
  const Descriptor& operator[](std::uint32_t number) const { return centres_[number]; }

  /// Fills `nearest`, nearest first, and returns their number.
  std::size_t find(const Descriptor& descriptor, std::span<std::uint32_t> nearest) const;

 private:
  struct Tree;

  std::deque<Descriptor> centres_;  // FLANN keeps pointers to them
  std::unique_ptr<Tree> tree_;
  std::uint64_t seed_;
  int checks_;
};

}  // namespace holdfast::flann_plugin
