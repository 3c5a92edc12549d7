// SPDX-License-Identifier: BSD-3-Clause
#include "vocabulary.hpp"

#include <algorithm>
#include <array>
#include <span>
#include <utility>

#include "descriptor_mean.hpp"
#include "holdfast/core/error.hpp"

namespace holdfast::flann_plugin {

namespace {

constexpr std::size_t most_words_of_bucket = 256;
constexpr std::size_t most_probes = 64;
constexpr std::size_t least_buckets_to_drop = 16;
constexpr int rounds_of_split = 4;
constexpr std::uint32_t no_bucket = ~0U;
constexpr std::size_t cache_line = 64;
constexpr std::size_t rows_ahead = 2;     // buckets
constexpr std::size_t headers_ahead = 8;  // buckets

/// Appends an entry of `length` values. Reserves a quarter more, so that not half of the memory of ten thousands of
/// buckets lies idle.
template <class T>
void push_tightly(std::vector<T>& values, const T* entry, std::size_t length) {
  if (values.size() + length > values.capacity()) values.reserve(values.size() + values.size() / 4 + 4 * length);
  values.insert(values.end(), entry, entry + length);
}

/// Moves the last entry of `length` values to a position.
template <class T>
void swap_out(std::vector<T>& values, std::size_t position, std::size_t length) {
  std::copy(values.end() - static_cast<std::ptrdiff_t>(length), values.end(),
            values.begin() + static_cast<std::ptrdiff_t>(position * length));
  values.resize(values.size() - length);
  if (values.capacity() > 2 * values.size() + 8 * length) values.shrink_to_fit();
}

}  // namespace

Vocabulary::Vocabulary(const DescriptorType& type, std::uint64_t seed, float radius, int probes, int checks)
    : type_(type),
      kernels_(type),
      units_(DescriptorView::units_of(type)),
      seed_(seed),
      checks_(checks),
      centres_(empty_index()),
      random_(Random(seed).fork(2)),
      radius_(radius),
      probes_(std::min(static_cast<std::size_t>(std::max(probes, 1)), most_probes)) {}

void Vocabulary::find(const DescriptorView& descriptors, std::vector<Lookup>& lookups) const {
  // First all centres, then all buckets: so the centres stay in the cache, and buckets are fetched ahead of their use.
  // In a large map each is a miss of the cache, and waiting for one after the other would be most of the time.
  nearest_.assign(descriptors.size() * probes_, no_bucket);
  for (std::size_t i = 0; i < descriptors.size(); ++i)
    centres_.find(descriptors.row(i), std::span(nearest_).subspan(i * probes_, probes_));

  lookups.assign(descriptors.size(), {});
  Nearest nearest;
  for (std::size_t i = 0; i < nearest_.size(); ++i) {
    if (i + headers_ahead < nearest_.size() && nearest_[i + headers_ahead] != no_bucket)
      __builtin_prefetch(&buckets_[nearest_[i + headers_ahead]]);
    if (i + rows_ahead < nearest_.size() && nearest_[i + rows_ahead] != no_bucket) prefetch(nearest_[i + rows_ahead]);
    Lookup& lookup = lookups[i / probes_];
    if (i % probes_ == 0) {
      nearest.distances.fill(0);
      lookup.bucket = nearest_[i] != no_bucket ? nearest_[i] : 0;
    }
    if (nearest_[i] != no_bucket) compare(descriptors.row(i / probes_), buckets_[nearest_[i]], lookup, nearest);
  }
}

Lookup Vocabulary::find(const Descriptor256* descriptor) const {
  std::vector<Lookup> lookups;
  find(DescriptorView(type_, descriptor, 1), lookups);
  return lookups[0];
}

void Vocabulary::prefetch(std::uint32_t bucket) const {
  const auto* bytes = reinterpret_cast<const char*>(buckets_[bucket].descriptors.data());
  const std::size_t size = buckets_[bucket].descriptors.size() * sizeof(Descriptor256);
  for (std::size_t offset = 0; offset < size; offset += cache_line) __builtin_prefetch(bytes + offset);
}

/// Puts the words of a bucket that are within the radius where they belong among those found so far.
void Vocabulary::compare(const Descriptor256* descriptor, const Bucket& bucket, Lookup& lookup,
                         Nearest& nearest) const {
  const std::size_t size = bucket.words.size();
  kernels_.of_rows(descriptor, bucket.descriptors.data(), size, distances_.data());
  for (std::size_t k = 0; k < size; ++k) {
    const float distance = distances_[k];
    if (distance > radius_) continue;
    std::size_t place = lookup.count;
    while (place > 0 && distance < nearest.distances[place - 1]) --place;
    if (place == Lookup::most_words) continue;
    if (lookup.count < Lookup::most_words) ++lookup.count;
    for (std::size_t j = lookup.count - 1; j > place; --j) {
      nearest.distances[j] = nearest.distances[j - 1];
      lookup.words[j] = lookup.words[j - 1];
    }
    nearest.distances[place] = distance;
    lookup.words[place] = bucket.words[k];
  }
}

WordId Vocabulary::insert(const Descriptor256* descriptor, std::uint32_t bucket) {
  if (buckets_.empty()) {
    centres_.add(descriptor);
    buckets_.emplace_back();
    ++empty_buckets_;
  }
  HOLDFAST_CHECK(bucket < buckets_.size(), "bucket " << bucket << " of " << buckets_.size());
  WordId word = static_cast<WordId>(bucket_of_word_.size());
  if (free_words_.empty()) {
    bucket_of_word_.push_back(bucket);
  } else {
    word = free_words_.back();
    free_words_.pop_back();
  }
  if (buckets_[bucket].words.empty()) --empty_buckets_;
  append(descriptor, word, bucket);
  if (buckets_[bucket].words.size() == most_words_of_bucket + 1) full_.push_back(bucket);
  return word;
}

void Vocabulary::erase(WordId word) {
  HOLDFAST_CHECK(word < bucket_of_word_.size(), "word " << word << " of " << bucket_of_word_.size());
  Bucket& bucket = buckets_[bucket_of_word_[word]];
  const auto found = std::find(bucket.words.begin(), bucket.words.end(), word);
  HOLDFAST_CHECK(found != bucket.words.end(), "word " << word << " was erased before");
  const auto position = static_cast<std::size_t>(found - bucket.words.begin());
  swap_out(bucket.descriptors, position, units_);
  swap_out(bucket.words, position, 1);
  if (bucket.words.empty()) ++empty_buckets_;
  free_words_.push_back(word);
}

void Vocabulary::split_full_buckets() {
  for (std::size_t i = 0; i < full_.size(); ++i) split(full_[i]);
  full_.clear();
}

void Vocabulary::append(const Descriptor256* descriptor, WordId word, std::uint32_t bucket) {
  push_tightly(buckets_[bucket].descriptors, descriptor, units_);
  push_tightly(buckets_[bucket].words, &word, 1);
  bucket_of_word_[word] = bucket;
  distances_.resize(std::max(distances_.size(), buckets_[bucket].words.size()));
}

void Vocabulary::drop_empty_buckets() {
  if (2 * empty_buckets_ <= buckets_.size() || buckets_.size() < least_buckets_to_drop) return;
  CentreIndex centres = empty_index();
  std::deque<Bucket> buckets;
  for (std::uint32_t number = 0; number < buckets_.size(); ++number) {
    if (buckets_[number].words.empty()) continue;
    const std::uint32_t renumbered = centres.add(centres_[number]);
    for (const WordId word : buckets_[number].words) bucket_of_word_[word] = renumbered;
    buckets.push_back(std::move(buckets_[number]));
  }
  centres_ = std::move(centres);
  buckets_ = std::move(buckets);
  empty_buckets_ = 0;
}

CentreIndex Vocabulary::empty_index() const { return {type_, Random(seed_).fork(1).next(), checks_}; }

void Vocabulary::split(std::uint32_t number) {
  const Bucket old = std::exchange(buckets_[number], {});
  const DescriptorView descriptors(type_, old.descriptors.data(), old.words.size());
  const Descriptor256* any = descriptors.row(random_.below(static_cast<std::uint32_t>(descriptors.size())));
  std::vector<float>& from_any = distances_;
  kernels_.of_rows(any, descriptors.row(0), descriptors.size(), from_any.data());
  const auto farthest =
      std::max_element(from_any.begin(), from_any.begin() + static_cast<std::ptrdiff_t>(descriptors.size()));
  DescriptorBlock centres(type_);
  centres.append(DescriptorView(type_, any, 1), 0);
  centres.append(descriptors, static_cast<std::size_t>(farthest - from_any.begin()));
  std::vector<bool> second(descriptors.size());
  for (int round = 0; round < rounds_of_split; ++round) {
    std::array<DescriptorMean, 2> means{DescriptorMean(type_), DescriptorMean(type_)};
    for (std::size_t i = 0; i < descriptors.size(); ++i) {
      const Descriptor256* row = descriptors.row(i);
      second[i] = kernels_.of_two(row, centres.row(1)) < kernels_.of_two(row, centres.row(0));
      means[second[i]].add(row);
    }
    for (std::size_t k = 0; k < 2; ++k) means[k].write(centres.row(k));
  }

  const std::uint32_t other = centres_.add(centres.row(1));
  centres_.move(number, centres.row(0));
  buckets_.emplace_back();
  for (std::size_t i = 0; i < old.words.size(); ++i)
    append(descriptors.row(i), old.words[i], second[i] ? other : number);
  for (const std::uint32_t half : {number, other}) empty_buckets_ += buckets_[half].words.empty() ? 1 : 0;
  for (const std::uint32_t half : {number, other})
    if (buckets_[half].words.size() > most_words_of_bucket && buckets_[half].words.size() < old.words.size())
      full_.push_back(half);
}

}  // namespace holdfast::flann_plugin
