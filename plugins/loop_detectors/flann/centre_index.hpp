// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "holdfast/core/descriptor_distance.hpp"

namespace holdfast::flann_plugin {

/// Approximate nearest neighbours among a growing set of descriptors of any type: FLANN's hierarchical clustering (Muja
/// and Lowe, "Fast matching of binary features", CRV 2012), whose centres are members of the set, so that it needs
/// nothing but a distance.
///
/// FLANN seeds this clustering from std::random_device, so that its results differ between runs. Here the cluster
/// centres are drawn by a generator of the index (FLANN's chooser, specialised for the distance type of this plugin):
/// the same seed and additions give the same results, independent of the rest of the process; std::rand is not used.
class CentreIndex {
 public:
  /// `checks`: minimum number of centres that a search compares before it stops.
  CentreIndex(const DescriptorType& type, std::uint64_t seed, int checks);
  ~CentreIndex();
  CentreIndex(CentreIndex&& other) noexcept;
  CentreIndex& operator=(CentreIndex&& other) noexcept;

  // Descriptors are given by their first units of memory.

  /// Adds a centre and returns its index, from 0. Rebuilds the FLANN index whenever the number of centres has doubled.
  std::uint32_t add(const Descriptor256* centre);
  /// Replaces a centre. The clusters are updated at the next rebuild, so that the new descriptor should be near.
  void move(std::uint32_t number, const Descriptor256* centre);
  std::uint32_t size() const { return size_; }
  const Descriptor256* operator[](std::uint32_t number) const { return row(number); }

  /// Fills `nearest`, nearest first, and returns their number.
  std::size_t find(const Descriptor256* descriptor, std::span<std::uint32_t> nearest) const;

 private:
  struct Tree;

  static constexpr std::uint32_t rows_of_chunk = 64;

  Descriptor256* row(std::uint32_t number) const {
    return chunks_[number / rows_of_chunk].get() + (number % rows_of_chunk) * units_;
  }

  DescriptorDistances distances_;
  std::size_t units_;
  std::vector<std::unique_ptr<Descriptor256[]>> chunks_;  // FLANN keeps pointers to the centres
  std::uint32_t size_ = 0;
  std::unique_ptr<Tree> tree_;
  std::uint64_t seed_;
  int checks_;
};

}  // namespace holdfast::flann_plugin
