// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <span>
#include <vector>

#include "centre_index.hpp"
#include "distances.hpp"
#include "holdfast/core/descriptor.hpp"
#include "holdfast/core/random.hpp"

namespace holdfast::flann_plugin {

using WordId = std::uint32_t;

/// Where a descriptor falls in the vocabulary.
struct Lookup {
  static constexpr std::size_t most_words = 4;

  std::array<WordId, most_words> words{};  ///< the nearest within the radius, nearest first; equal ones as met
  std::uint32_t count = 0;                 ///< how many there are
  std::uint32_t bucket = 0;                ///< where the descriptor would be inserted
};

/// Words that come and go: descriptors that stand for what looks like them. They lie in buckets around centres; FLANN
/// finds the nearest centres, and the words of these buckets are compared one by one, so a search costs about the same
/// at any size. A bucket that grows too full is split in two, around the bitwise majorities of its halves (k-means with
/// Hamming distance: Grana et al., "A fast approach for integrating ORB descriptors in the bag of words model", SPIE
/// 8667, 2013): of all descriptors a majority has the least sum of distances to its words, so that the same thing seen
/// again mostly falls on the same side. An erased word leaves nothing behind, and nothing is ever rebuilt but the small
/// index of centres.
class Vocabulary {
 public:
  /// `radius`: how far a descriptor may be from its word [bits]; `probes`: buckets searched, at most 64; `checks`: see
  /// CentreIndex.
  Vocabulary(std::uint64_t seed, int radius, int probes, int checks);

  Lookup find(const Descriptor& descriptor) const;
  /// The same for many, which is quicker than one by one.
  void find(std::span<const Descriptor> descriptors, std::vector<Lookup>& lookups) const;
  /// A new word, in the bucket that find() named. Its id may have been that of an erased word.
  WordId insert(const Descriptor& descriptor, std::uint32_t bucket);
  void erase(WordId word);
  /// Splits the buckets that insert() has filled too far. Lookups made before may name a bucket that is no longer the
  /// nearest; that costs a little recall, nothing else.
  void split_full_buckets();

  /// Gives up the empty buckets once they are the larger part. No lookup made before may be used afterwards.
  void drop_empty_buckets();

  std::size_t size() const { return bucket_of_word_.size() - free_words_.size(); }
  std::size_t buckets() const { return buckets_.size(); }

 private:
  struct Bucket {
    std::vector<Descriptor> descriptors;
    std::vector<WordId> words;
  };

  struct Nearest {
    std::array<int, Lookup::most_words> distances{};  // of Lookup::words
  };

  void prefetch(std::uint32_t bucket) const;
  void compare(const Descriptor& descriptor, const Bucket& bucket, Lookup& lookup, Nearest& nearest) const;
  void append(const Descriptor& descriptor, WordId word, std::uint32_t bucket);
  void split(std::uint32_t bucket);

  CentreIndex empty_index() const;

  std::uint64_t seed_;
  int checks_;
  CentreIndex centres_;
  std::deque<Bucket> buckets_;                // one per centre
  std::deque<std::uint32_t> bucket_of_word_;  // by WordId
  std::vector<WordId> free_words_;
  std::vector<std::uint32_t> full_;
  std::size_t empty_buckets_ = 0;
  mutable std::vector<std::uint32_t> nearest_;    // buckets of many descriptors, probes_ each
  mutable std::vector<std::uint16_t> distances_;  // of such a comparison
  DistanceKernels kernels_ = distance_kernels();
  Random random_;
  int radius_;
  std::size_t probes_;
};

}  // namespace holdfast::flann_plugin
