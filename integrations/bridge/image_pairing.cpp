// SPDX-License-Identifier: BSD-3-Clause
#include "image_pairing.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

namespace holdfast::bridge {

namespace {

/// Images of one kind that are kept; those of a kind that nothing pairs with must not fill the memory.
constexpr std::size_t most_images = 8;

}  // namespace

double ImageSet::arrival() const { return std::max({colour.arrival, depth.arrival, right.arrival}); }

ImagePairing::ImagePairing(bool has_depth, bool has_right, Stamp tolerance) : tolerance_(tolerance) {
  topic(ImageKind::colour).is_needed = true;
  topic(ImageKind::depth).is_needed = has_depth;
  topic(ImageKind::right).is_needed = has_right;
}

void ImagePairing::add(ImageKind kind, StampedImage image) {
  Topic& t = topic(kind);
  if (!t.is_needed) return;
  if (kind == ImageKind::colour && last_ && image.stamp <= *last_) return;
  if (t.newest && image.stamp > *t.newest) {
    const auto step = static_cast<double>(image.stamp - *t.newest);
    // A gap is no period: the average follows it slowly.
    t.period = t.period == 0.0 ? step : 0.9 * t.period + 0.1 * std::min(step, 2.0 * t.period);
  }
  t.newest = t.newest ? std::max(*t.newest, image.stamp) : image.stamp;
  const auto place = std::upper_bound(t.images.begin(), t.images.end(), image.stamp,
                                      [](Stamp stamp, const StampedImage& other) { return stamp < other.stamp; });
  t.images.insert(place, std::move(image));
  if (t.images.size() <= most_images) return;
  if (kind == ImageKind::colour)
    drop_oldest_colour();
  else
    t.images.pop_front();
}

ImagePairing::Answer ImagePairing::find(const Topic& topic, Stamp stamp, std::size_t& best) const {
  Stamp smallest = tolerance_ + 1;
  for (std::size_t i = 0; i < topic.images.size(); ++i) {
    const Stamp difference = std::llabs(topic.images[i].stamp - stamp);
    if (difference < smallest) smallest = difference, best = i;
  }
  const bool has_later = !topic.images.empty() && topic.images.back().stamp >= stamp;
  if (smallest > tolerance_) return has_later ? Answer::none : Answer::wait;
  constexpr double largest_share = 0.45;  // of a period; the stamps of cameras jitter
  const bool is_near = static_cast<double>(smallest) < largest_share * topic.period;
  return has_later || is_near ? Answer::found : Answer::wait;
}

std::optional<ImageSet> ImagePairing::next() {
  Topic& colours = topic(ImageKind::colour);
  while (!colours.images.empty()) {
    const Stamp stamp = colours.images.front().stamp;
    std::array<std::size_t, 3> best{};
    bool is_waiting = false, is_alone = false;
    for (const ImageKind kind : {ImageKind::depth, ImageKind::right}) {
      const Topic& t = topic(kind);
      if (!t.is_needed) continue;
      const Answer answer = find(t, stamp, best[static_cast<std::size_t>(kind)]);
      is_waiting = is_waiting || answer == Answer::wait;
      is_alone = is_alone || answer == Answer::none;
    }
    if (is_alone) {
      drop_oldest_colour();
      continue;
    }
    if (is_waiting) return std::nullopt;
    ImageSet set;
    for (const ImageKind kind : {ImageKind::colour, ImageKind::depth, ImageKind::right}) {
      Topic& t = topic(kind);
      if (!t.is_needed) continue;
      const auto place = t.images.begin() + static_cast<std::ptrdiff_t>(best[static_cast<std::size_t>(kind)]);
      (kind == ImageKind::colour ? set.colour : kind == ImageKind::depth ? set.depth : set.right) = std::move(*place);
      t.images.erase(t.images.begin(), place + 1);
    }
    last_ = stamp;
    return set;
  }
  return std::nullopt;
}

void ImagePairing::drop_oldest_colour() {
  Topic& colours = topic(ImageKind::colour);
  last_ = colours.images.front().stamp;
  colours.images.pop_front();
  ++unpaired_;
}

void ImagePairing::clear() {
  for (Topic& t : topics_) t.images.clear(), t.newest.reset(), t.period = 0.0;
  last_.reset();
}

}  // namespace holdfast::bridge
