// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/core/association.hpp"

#include <algorithm>
#include <cmath>
#include <queue>
#include <tuple>

namespace holdfast {

namespace {

struct Stamp {
  double time;
  bool in_b;
  std::size_t index;
};

/// The stamps of one list that have the same time: stamps[front, end), lowest index first. `previous` and `next` are
/// the adjacent groups in time that are not empty.
struct Group {
  std::size_t front, end;
  std::ptrdiff_t previous, next;
};

/// A pair of adjacent groups of different lists, with their first stamps at the time of insertion into the queue.
struct Candidate {
  double difference;
  std::size_t index_a, index_b;
  std::ptrdiff_t before, after;

  bool operator>(const Candidate& other) const {
    return std::tie(difference, index_a, index_b) > std::tie(other.difference, other.index_a, other.index_b);
  }
};

std::vector<Stamp> merge(std::span<const double> a, std::span<const double> b) {
  std::vector<Stamp> stamps;
  stamps.reserve(a.size() + b.size());
  for (std::size_t i = 0; i < a.size(); ++i)
    if (std::isfinite(a[i])) stamps.push_back({a[i], false, i});
  for (std::size_t i = 0; i < b.size(); ++i)
    if (std::isfinite(b[i])) stamps.push_back({b[i], true, i});
  std::sort(stamps.begin(), stamps.end(), [](const Stamp& left, const Stamp& right) {
    return std::tie(left.time, left.in_b, left.index) < std::tie(right.time, right.in_b, right.index);
  });
  return stamps;
}

/// Takes the nearest pairs of two lists of stamps one by one.
///
/// The nearest pair among the remaining stamps is always adjacent in time, because a stamp between the two would be
/// nearer to one of them. A priority queue of adjacent pairs is therefore sufficient, and taking a pair creates at most
/// one new adjacent pair.
class StampMatcher {
 public:
  StampMatcher(std::span<const double> a, std::span<const double> b, double max_difference)
      : stamps_(merge(a, b)), max_difference_(max_difference) {
    group_equal_stamps();
    for (std::size_t i = 1; i < groups_.size(); ++i)
      offer(static_cast<std::ptrdiff_t>(i) - 1, static_cast<std::ptrdiff_t>(i));
  }

  std::vector<std::pair<std::size_t, std::size_t>> match() {
    std::vector<std::pair<std::size_t, std::size_t>> pairs;
    while (!queue_.empty()) {
      const Candidate nearest = queue_.top();
      queue_.pop();
      if (!is_current(nearest)) continue;
      pairs.emplace_back(nearest.index_a, nearest.index_b);
      take(nearest);
    }
    std::sort(pairs.begin(), pairs.end());
    return pairs;
  }

 private:
  void group_equal_stamps() {
    for (std::size_t i = 0; i < stamps_.size(); ++i) {
      if (i > 0 && stamps_[i].time == stamps_[i - 1].time && stamps_[i].in_b == stamps_[i - 1].in_b) {
        ++groups_.back().end;
        continue;
      }
      const auto number = static_cast<std::ptrdiff_t>(groups_.size());
      groups_.push_back({i, i + 1, number - 1, number + 1});
    }
    if (!groups_.empty()) groups_.back().next = -1;
  }

  void offer(std::ptrdiff_t before, std::ptrdiff_t after) {
    if (before < 0 || after < 0) return;
    const Stamp& first = stamps_[groups_[before].front];
    const Stamp& second = stamps_[groups_[after].front];
    const double difference = second.time - first.time;
    if (first.in_b == second.in_b || !(difference < max_difference_)) return;
    queue_.push(
        {difference, first.in_b ? second.index : first.index, first.in_b ? first.index : second.index, before, after});
  }

  /// Whether the first stamps of both groups are still those of the candidate's insertion.
  bool is_current(const Candidate& candidate) const {
    const Group& before = groups_[candidate.before];
    const Group& after = groups_[candidate.after];
    if (before.front == before.end || after.front == after.end) return false;
    const Stamp& first = stamps_[before.front];
    return (first.in_b ? stamps_[after.front] : first).index == candidate.index_a &&
           (first.in_b ? first : stamps_[after.front]).index == candidate.index_b;
  }

  void remove_front(std::ptrdiff_t number) {
    Group& group = groups_[number];
    if (++group.front < group.end) return;
    if (group.previous >= 0) groups_[group.previous].next = group.next;
    if (group.next >= 0) groups_[group.next].previous = group.previous;
  }

  void take(const Candidate& nearest) {
    remove_front(nearest.before);
    remove_front(nearest.after);
    // Insert every pair whose first stamps have changed; the outdated entries are recognised when they are popped.
    const bool before_left = groups_[nearest.before].front < groups_[nearest.before].end;
    const bool after_left = groups_[nearest.after].front < groups_[nearest.after].end;
    const std::ptrdiff_t before = before_left ? nearest.before : groups_[nearest.before].previous;
    const std::ptrdiff_t after = after_left ? nearest.after : groups_[nearest.after].next;
    offer(before, after);
    if (before_left) offer(groups_[nearest.before].previous, nearest.before);
    if (after_left) offer(nearest.after, groups_[nearest.after].next);
  }

  std::vector<Stamp> stamps_;
  double max_difference_;
  std::vector<Group> groups_;
  std::priority_queue<Candidate, std::vector<Candidate>, std::greater<>> queue_;
};

}  // namespace

std::vector<std::pair<std::size_t, std::size_t>> associate_stamps(std::span<const double> a, std::span<const double> b,
                                                                  double max_difference) {
  return StampMatcher(a, b, max_difference).match();
}

}  // namespace holdfast
