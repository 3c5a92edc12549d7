// SPDX-License-Identifier: BSD-3-Clause
#include "vocabulary.hpp"

#include <algorithm>
#include <array>
#include <span>

#include "holdfast/core/error.hpp"
#include "holdfast/core/hamming.hpp"

namespace holdfast::flann_plugin {

namespace {

constexpr std::size_t most_words_of_bucket = 96;
constexpr std::size_t most_probes = 64;

/// A quarter more, so that not half of the memory of ten thousands of buckets lies idle.
template <class T>
void push_tightly(std::vector<T>& values, const T& value) {
  if (values.size() == values.capacity()) values.reserve(values.size() + values.size() / 4 + 4);
  values.push_back(value);
}

template <class T>
void swap_out(std::vector<T>& values, std::size_t position) {
  values[position] = values.back();
  values.pop_back();
  if (values.capacity() > 2 * values.size() + 8) values.shrink_to_fit();
}

}  // namespace

Vocabulary::Vocabulary(std::uint64_t seed, int probes, int checks)
    : centres_(Random(seed).fork(1).next(), checks),
      random_(Random(seed).fork(2)),
      probes_(std::min(static_cast<std::size_t>(std::max(probes, 1)), most_probes)) {}

Lookup Vocabulary::find(const Descriptor& descriptor) const {
  std::array<std::uint32_t, most_probes> nearest;
  const std::size_t count = centres_.find(descriptor, std::span(nearest).first(probes_));
  Lookup lookup;
  if (count > 0) lookup.bucket = nearest[0];
  for (std::size_t i = 0; i < count; ++i) {
    const Bucket& bucket = buckets_[nearest[i]];
    const NearestDescriptors best = nearest_descriptors(descriptor, bucket.descriptors.data(),
                                                        std::span(positions_).first(bucket.descriptors.size()));
    if (best.best_index < 0 || best.best_distance >= lookup.distance) continue;
    lookup.word = bucket.words[static_cast<std::size_t>(best.best_index)];
    lookup.distance = best.best_distance;
  }
  return lookup;
}

WordId Vocabulary::insert(const Descriptor& descriptor, std::uint32_t bucket) {
  if (buckets_.empty()) {
    centres_.add(descriptor);
    buckets_.emplace_back();
  }
  HOLDFAST_CHECK(bucket < buckets_.size(), "bucket " << bucket << " of " << buckets_.size());
  WordId word = static_cast<WordId>(bucket_of_word_.size());
  if (free_words_.empty()) {
    bucket_of_word_.push_back(bucket);
  } else {
    word = free_words_.back();
    free_words_.pop_back();
  }
  append(descriptor, word, bucket);
  if (buckets_[bucket].words.size() == most_words_of_bucket + 1) full_.push_back(bucket);
  return word;
}

void Vocabulary::erase(WordId word) {
  HOLDFAST_CHECK(word < bucket_of_word_.size(), "word " << word << " of " << bucket_of_word_.size());
  Bucket& bucket = buckets_[bucket_of_word_[word]];
  const auto found = std::find(bucket.words.begin(), bucket.words.end(), word);
  HOLDFAST_CHECK(found != bucket.words.end(), "word " << word << " was erased before");
  take_out(bucket, static_cast<std::size_t>(found - bucket.words.begin()));
  free_words_.push_back(word);
}

void Vocabulary::split_full_buckets() {
  for (std::size_t i = 0; i < full_.size(); ++i) split(full_[i]);
  full_.clear();
}

void Vocabulary::append(const Descriptor& descriptor, WordId word, std::uint32_t bucket) {
  push_tightly(buckets_[bucket].descriptors, descriptor);
  push_tightly(buckets_[bucket].words, word);
  bucket_of_word_[word] = bucket;
  while (positions_.size() < buckets_[bucket].words.size())
    positions_.push_back(static_cast<std::uint32_t>(positions_.size()));
}

void Vocabulary::take_out(Bucket& bucket, std::size_t position) {
  swap_out(bucket.descriptors, position);
  swap_out(bucket.words, position);
}

void Vocabulary::split(std::uint32_t number) {
  Bucket old = std::move(buckets_[number]);
  buckets_[number] = {};
  const Descriptor old_centre = centres_[number];
  const Descriptor new_centre = old.descriptors[random_.below(static_cast<std::uint32_t>(old.descriptors.size()))];
  const std::uint32_t other = centres_.add(new_centre);
  buckets_.emplace_back();
  for (std::size_t i = 0; i < old.words.size(); ++i) {
    const Descriptor& descriptor = old.descriptors[i];
    const bool moves = hamming_distance(descriptor, new_centre) < hamming_distance(descriptor, old_centre);
    append(descriptor, old.words[i], moves ? other : number);
  }
  for (const std::uint32_t half : {number, other})
    if (buckets_[half].words.size() > most_words_of_bucket && buckets_[half].words.size() < old.words.size())
      full_.push_back(half);
}

}  // namespace holdfast::flann_plugin
