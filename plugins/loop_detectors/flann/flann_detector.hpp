// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "holdfast/interfaces/loop_detector.hpp"
#include "inverted_file.hpp"
#include "settings.hpp"
#include "vocabulary.hpp"

namespace holdfast::flann_plugin {

/// Place recognition with an incremental bag of binary words: words are descriptors seen before, found by FLANN; no
/// vocabulary file, no training (after Garcia-Fidalgo and Ortiz, "iBoW-LCD: An appearance-based loop-closure detection
/// approach using incremental bags of binary words", RA-L 3(4), 2018).
///
/// Score of keyframe d for query q, with counts q_w and d_w of word w, N keyframes, n_w of them with word w:
///
///     score = sum_w weight_w min(q_w, d_w) / sum_w weight_w q_w,     weight_w = log(1 + N / n_w)
///
/// This is the L1 similarity of term-frequency, inverse-document-frequency vectors (Nister and Stewenius, "Scalable
/// recognition with a vocabulary tree", CVPR 2006, equation 5; Galvez-Lopez and Tardos, "Bags of binary words for fast
/// place recognition in image sequences", T-RO 28(5), 2012, equation 2), with the query's length taken for both: the
/// share of the query, rare things counting more, that the keyframe has too. It lies in 0 to 1. Descriptors of the
/// query that are no known word count in the denominator with n_w = 1. Weights are rounded to whole 1/1024, so that
/// sums are exact in any order. Keyframes without a common word are left out.
///
/// Results depend on the settings, the seed and the sequence of add() and remove() only. Costs: see README.md.
class FlannDetector final : public LoopDetector {
 public:
  explicit FlannDetector(const FlannSettings& settings, const CreationContext& context = {});

  /// Throws CheckError when the keyframe is there already.
  void add(KeyFrameId keyframe, std::span<const Descriptor> descriptors) override;
  /// Forgets a keyframe, and the words that no other has. One that is not there is passed over: a keyframe may be
  /// culled before it was ever added.
  void remove(KeyFrameId keyframe) override;
  std::vector<PlaceMatch> query(std::span<const Descriptor> descriptors, int most) const override;

  std::size_t keyframes() const { return slots_.size(); }
  std::size_t words() const { return vocabulary_.size(); }

 private:
  struct Entry {
    KeyFrameId keyframe;
    std::vector<WordId> words;  // each once
  };
  struct WordCount {
    WordId word;
    std::uint32_t count;
  };

  void look_up(std::span<const Descriptor> descriptors) const;
  std::uint64_t weight(std::size_t keyframes_with_word) const;

  FlannSettings settings_;
  Vocabulary vocabulary_;
  InvertedFile inverted_;
  std::vector<Entry> entries_;  // by slot; free ones have an invalid id
  std::vector<std::uint32_t> free_slots_;
  std::unordered_map<KeyFrameId, std::uint32_t> slots_;

  // What the last query looked up, since the keyframe asked for is mostly added next; void after any change.
  mutable bool looked_up_ = false;
  mutable std::vector<Descriptor> looked_up_descriptors_;
  mutable std::vector<Lookup> lookups_;
  mutable std::vector<std::uint64_t> votes_;  // by slot
};

}  // namespace holdfast::flann_plugin
