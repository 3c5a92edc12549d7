// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <span>
#include <vector>

#include "centre_index.hpp"
#include "holdfast/core/descriptor_distance.hpp"
#include "holdfast/core/random.hpp"

namespace holdfast::flann_plugin {

using WordId = std::uint32_t;

/// Result of the search for a descriptor in the vocabulary.
struct Lookup {
  static constexpr std::size_t most_words = 4;

  std::array<WordId, most_words> words{};  ///< nearest words within the radius, nearest first
  std::uint32_t count = 0;                 ///< number of words
  std::uint32_t bucket = 0;                ///< where the descriptor would be inserted
};

/// An incremental vocabulary of visual words, which are descriptors that represent similar ones. Words are stored in
/// buckets around centres: FLANN finds the nearest centres, and the words of their buckets are compared one by one, so
/// that the cost of a search is nearly independent of the size. A bucket that becomes too large is split around the
/// bitwise majorities of its halves (k-means with Hamming distance: Grana et al., "A fast approach for integrating ORB
/// descriptors in the bag of words model", SPIE 8667, 2013). A majority minimises the sum of distances to its words, so
/// that observations of the same feature usually belong to the same half. Erased words leave no trace, and only the
/// small index of centres is ever rebuilt. Descriptors of any type are words; those of numbers are split around their
/// means (k-means).
class Vocabulary {
 public:
  /// `radius`: maximum distance between a descriptor and its word; `probes`: number of searched buckets, at most 64;
  /// `checks`: see CentreIndex.
  Vocabulary(const DescriptorType& type, std::uint64_t seed, float radius, int probes, int checks);

  /// A descriptor is given by its first unit of memory, here and below.
  Lookup find(const Descriptor256* descriptor) const;
  /// Searches many descriptors, which is faster than one by one.
  void find(const DescriptorView& descriptors, std::vector<Lookup>& lookups) const;
  /// Inserts a new word into the bucket that find() returned. Ids of erased words are reused.
  WordId insert(const Descriptor256* descriptor, std::uint32_t bucket);
  void erase(WordId word);
  /// Splits the buckets that have become too large. Earlier lookups may then refer to a bucket that is no longer the
  /// nearest one, which only reduces the recall slightly.
  void split_full_buckets();

  /// Removes empty buckets if they are the majority. Earlier lookups are invalid afterwards.
  void drop_empty_buckets();

  std::size_t size() const { return bucket_of_word_.size() - free_words_.size(); }
  std::size_t buckets() const { return buckets_.size(); }

 private:
  struct Bucket {
    std::vector<Descriptor256> descriptors;  // units_ for each word
    std::vector<WordId> words;
  };

  struct Nearest {
    std::array<float, Lookup::most_words> distances{};  // of Lookup::words
  };

  void prefetch(std::uint32_t bucket) const;
  void compare(const Descriptor256* descriptor, const Bucket& bucket, Lookup& lookup, Nearest& nearest) const;
  void append(const Descriptor256* descriptor, WordId word, std::uint32_t bucket);
  void split(std::uint32_t bucket);

  CentreIndex empty_index() const;

  DescriptorType type_;
  DescriptorDistances kernels_;
  std::size_t units_;  // of memory, per descriptor
  std::uint64_t seed_;
  int checks_;
  CentreIndex centres_;
  std::deque<Bucket> buckets_;                // one per centre
  std::deque<std::uint32_t> bucket_of_word_;  // by WordId
  std::vector<WordId> free_words_;
  std::vector<std::uint32_t> full_;
  std::size_t empty_buckets_ = 0;
  mutable std::vector<std::uint32_t> nearest_;  // buckets of many descriptors, probes_ each
  mutable std::vector<float> distances_;        // of such a comparison
  Random random_;
  float radius_;
  std::size_t probes_;
};

}  // namespace holdfast::flann_plugin
