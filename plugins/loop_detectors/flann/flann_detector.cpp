// SPDX-License-Identifier: BSD-3-Clause
#include "flann_detector.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "holdfast/core/error.hpp"
#include "holdfast/core/random.hpp"

namespace holdfast::flann_plugin {

namespace {

constexpr std::uint64_t seed_stream = 0x706c616365;  // of this plugin among those that fork the run's seed

std::uint64_t weighted(std::uint64_t vote, float weight) {
  if (weight == 1.0F) return vote;
  return static_cast<std::uint64_t>(std::llround(static_cast<double>(vote) * static_cast<double>(weight)));
}

}  // namespace

FlannDetector::FlannDetector(const FlannSettings& settings, const CreationContext& context)
    : settings_(settings), seed_(Random(context.seed).fork(seed_stream).next()) {}

void FlannDetector::begin_vocabulary(const DescriptorType& type) {
  constexpr double radius_share = 0.64;  // of the strict distance: 32 of 50 bits
  const double radius = settings_.radius > 0.0 ? settings_.radius : radius_share * type.strict_distance;
  type_ = type;
  vocabulary_.emplace(type, seed_, static_cast<float>(radius), settings_.probes, settings_.checks);
}

void FlannDetector::add(KeyFrameId keyframe, const DescriptorView& descriptors) {
  HOLDFAST_CHECK(!slots_.contains(keyframe),
                 "keyframe " << keyframe.slot << "." << keyframe.generation << " was added before");
  if (!vocabulary_ && !descriptors.empty()) begin_vocabulary(descriptors.type());
  look_up(descriptors);
  looked_up_ = false;

  // All were looked up before the first is inserted: whether the lookups come from query() makes no difference.
  std::vector<WordId> words;
  words.reserve(lookups_.size());
  for (std::size_t i = 0; i < lookups_.size(); ++i) {
    const Lookup& lookup = lookups_[i];
    words.push_back(lookup.count > 0 ? lookup.words[0]
                                     : vocabulary_->insert(looked_up_descriptors_.row(i), lookup.bucket));
  }
  if (vocabulary_) vocabulary_->split_full_buckets();
  std::sort(words.begin(), words.end());
  words.erase(std::unique(words.begin(), words.end()), words.end());

  std::uint32_t slot = static_cast<std::uint32_t>(entries_.size());
  if (free_slots_.empty()) {
    entries_.emplace_back();
  } else {
    slot = free_slots_.back();
    free_slots_.pop_back();
  }
  slots_.emplace(keyframe, slot);
  Entry& entry = entries_[slot];
  entry.keyframe = keyframe;
  entry.words.assign(words.begin(), words.end());
  for (const WordId word : entry.words) inverted_.add(word, slot);
}

void FlannDetector::remove(KeyFrameId keyframe) {
  const auto found = slots_.find(keyframe);
  if (found == slots_.end()) return;
  looked_up_ = false;
  const std::uint32_t slot = found->second;
  for (const WordId word : entries_[slot].words)
    if (inverted_.remove(word, slot)) vocabulary_->erase(word);
  if (vocabulary_) vocabulary_->drop_empty_buckets();
  entries_[slot] = {};
  free_slots_.push_back(slot);
  slots_.erase(found);
}

std::vector<PlaceMatch> FlannDetector::query_weighted(const DescriptorView& descriptors, std::span<const float> weights,
                                                      int max_count) const {
  HOLDFAST_CHECK(weights.empty() || weights.size() == descriptors.size(),
                 weights.size() << " weights for " << descriptors.size() << " descriptors");
  if (max_count <= 0 || slots_.empty()) return {};
  look_up(descriptors);
  tallies_.assign(entries_.size(), {});
  std::uint64_t total = 0;
  for (std::uint32_t i = 0; i < lookups_.size(); ++i) {
    voted_.clear();
    for (std::uint32_t k = 0; k < lookups_[i].count; ++k)
      for (const std::uint32_t slot : inverted_.keyframes(lookups_[i].words[k]))
        if (std::exchange(tallies_[slot].last_voter, i + 1) != i + 1) voted_.push_back(slot);
    std::uint64_t vote = weight(std::max<std::size_t>(voted_.size(), 1));
    if (!weights.empty()) vote = weighted(vote, weights[used_index(i, descriptors.size())]);
    total += vote;
    for (const std::uint32_t slot : voted_) tallies_[slot].votes += vote;
  }

  std::vector<PlaceMatch> matches;  // a keyframe with votes has a part of the total, which is not 0 then
  for (std::size_t slot = 0; slot < tallies_.size(); ++slot)
    if (const std::uint64_t votes = tallies_[slot].votes; votes > 0)
      matches.push_back({entries_[slot].keyframe, static_cast<double>(votes) / static_cast<double>(total)});
  const auto wanted = matches.begin() + std::min<std::ptrdiff_t>(max_count, std::ssize(matches));
  std::partial_sort(matches.begin(), wanted, matches.end(), [](const PlaceMatch& a, const PlaceMatch& b) {
    return a.score != b.score ? a.score > b.score : a.keyframe < b.keyframe;
  });
  matches.erase(wanted, matches.end());
  return matches;
}

/// Fills looked_up_descriptors_, which are those used of the given ones, and their lookups_.
void FlannDetector::look_up(const DescriptorView& descriptors) const {
  if (descriptors.empty() || !vocabulary_) {
    lookups_.clear();
    looked_up_ = false;
    return;
  }
  HOLDFAST_CHECK(descriptors.type().is_comparable(type_), "descriptors of " << to_string(descriptors.type())
                                                                            << ", the database has those of "
                                                                            << to_string(type_));
  DescriptorBlock used(descriptors.type());
  const std::size_t count = used_count(descriptors.size());
  used.reserve(count);
  for (std::size_t i = 0; i < count; ++i) used.append(descriptors, used_index(i, descriptors.size()));
  if (looked_up_ && used == looked_up_descriptors_) return;

  looked_up_descriptors_ = std::move(used);
  vocabulary_->find(looked_up_descriptors_, lookups_);
  looked_up_ = true;
}

std::size_t FlannDetector::used_count(std::size_t given) const {
  return std::min(given, static_cast<std::size_t>(settings_.descriptors));
}

/// log(1 + N / n) in 1/1024.
std::uint64_t FlannDetector::weight(std::size_t voted_for) const {
  const double ratio = static_cast<double>(slots_.size()) / static_cast<double>(voted_for);
  return static_cast<std::uint64_t>(std::lround(1024.0 * std::log1p(ratio)));
}

}  // namespace holdfast::flann_plugin
