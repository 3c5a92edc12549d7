// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <unordered_map>
#include <vector>

#include "holdfast/interfaces/loop_detector.hpp"
#include "holdfast/settings/flann.hpp"
#include "inverted_file.hpp"
#include "vocabulary.hpp"

namespace holdfast::flann_plugin {

/// Place recognition with an incremental bag of words: words are descriptors seen before, found by FLANN, whatever
/// their type; no vocabulary file, no training (after Garcia-Fidalgo and Ortiz, "iBoW-LCD: An appearance-based
/// loop-closure detection approach using incremental bags of binary words", RA-L 3(4), 2018).
///
/// Every descriptor i of a query votes for the n_i of N keyframes with a word within the radius, with a weight that
/// decreases with n_i (the inverse document frequency of Nister and Stewenius, "Scalable recognition with a vocabulary
/// tree", CVPR 2006, equation 4; one is added so that it is never zero, and n_i is 1 without such keyframes):
///
///     weight_i = w_i log(1 + N / n_i),   score of a keyframe = sum of the weights that voted for it / sum of all
///     weights
///
/// where w_i is the weight of the descriptor's class, 1 by default: features on what changes between visits neither
/// vote much nor lower the score of the right place much. The score is thus the fraction of the query's descriptors,
/// weighted by rarity, that the keyframe has as well; it lies between 0 and 1 and does not depend on the number of
/// descriptors of the keyframe. Up to four words per descriptor are used, because the approximate search may have
/// created several words for one feature. Weights are rounded to 1/1024, so that sums are exact in any order. Keyframes
/// without a vote are omitted.
///
/// Results depend on the settings, the seed and the sequence of add() and remove() only. Cost: see README.md.
class FlannDetector final : public LoopDetector {
 public:
  explicit FlannDetector(const FlannSettings& settings, const CreationContext& context = {});

  /// Throws CheckError if the keyframe is already in the database, or if its descriptors cannot be compared with those
  /// of the others.
  void add(KeyFrameId keyframe, const DescriptorView& descriptors) override;
  /// Removes a keyframe, and the words that no other keyframe has. An unknown keyframe is ignored, because a keyframe
  /// may be culled before it is added.
  void remove(KeyFrameId keyframe) override;
  std::vector<PlaceMatch> query(const DescriptorView& descriptors, int max_count) const override {
    return query_weighted(descriptors, {}, max_count);
  }
  std::vector<std::pair<std::string, double>> class_weights() const override { return settings_.class_weights; }
  /// Throws CheckError unless there is a weight for each descriptor, or none.
  std::vector<PlaceMatch> query_weighted(const DescriptorView& descriptors, std::span<const float> weights,
                                         int max_count) const override;

  std::size_t keyframes() const { return slots_.size(); }
  std::size_t words() const { return vocabulary_ ? vocabulary_->size() : 0; }

 private:
  struct Entry {
    KeyFrameId keyframe;
    std::vector<WordId> words;  // each once
  };
  struct Tally {
    std::uint64_t votes = 0;
    std::uint32_t last_voter = 0;  // number of the descriptor that voted last, from 1
  };

  void look_up(const DescriptorView& descriptors) const;
  void begin_vocabulary(const DescriptorType& type);
  std::uint64_t weight(std::size_t voted_for) const;
  /// Number of descriptors used of so many, and the place of one of them among those given.
  std::size_t used_count(std::size_t given) const;
  std::size_t used_index(std::size_t used, std::size_t given) const { return used * given / used_count(given); }

  FlannSettings settings_;
  std::uint64_t seed_;
  std::optional<Vocabulary> vocabulary_;  // begins with the first descriptors, which tell the type
  DescriptorType type_;                   // of the vocabulary
  InvertedFile inverted_;
  std::vector<Entry> entries_;  // by slot; free ones have an invalid id
  std::vector<std::uint32_t> free_slots_;
  std::unordered_map<KeyFrameId, std::uint32_t> slots_;

  // Words of the last query, because the queried keyframe is usually added next; invalid after any change.
  mutable bool looked_up_ = false;
  mutable DescriptorBlock looked_up_descriptors_;
  mutable std::vector<Lookup> lookups_;
  mutable std::vector<Tally> tallies_;        // by slot
  mutable std::vector<std::uint32_t> voted_;  // slots that one descriptor votes for
};

}  // namespace holdfast::flann_plugin
