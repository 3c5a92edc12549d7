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

/// Stamps of one list with one time: stamps[front, end), lowest index first. Neighbours are the groups before and after
/// it in time that still hold a stamp.
struct Group {
  std::size_t front, end;
  std::ptrdiff_t previous, next;
};

/// Two neighbouring groups of different lists, with the stamps in front when the pair was found.
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

}  // namespace

// On the time line the nearest pair of what is left always stands side by side: a stamp between the two would be nearer
// to one of them. So a queue of neighbours is enough, and taking a pair makes at most one new pair of neighbours.
std::vector<std::pair<std::size_t, std::size_t>> associate_stamps(std::span<const double> a, std::span<const double> b,
                                                                  double max_difference) {
  const std::vector<Stamp> stamps = merge(a, b);
  std::vector<Group> groups;
  for (std::size_t i = 0; i < stamps.size(); ++i) {
    if (i > 0 && stamps[i].time == stamps[i - 1].time && stamps[i].in_b == stamps[i - 1].in_b) {
      ++groups.back().end;
      continue;
    }
    const auto number = static_cast<std::ptrdiff_t>(groups.size());
    groups.push_back({i, i + 1, number - 1, number + 1});
  }
  if (!groups.empty()) groups.back().next = -1;

  std::priority_queue<Candidate, std::vector<Candidate>, std::greater<>> queue;
  const auto offer = [&](std::ptrdiff_t before, std::ptrdiff_t after) {
    if (before < 0 || after < 0) return;
    const Stamp& first = stamps[groups[before].front];
    const Stamp& second = stamps[groups[after].front];
    const double difference = second.time - first.time;
    if (first.in_b == second.in_b || !(difference < max_difference)) return;
    queue.push(
        {difference, first.in_b ? second.index : first.index, first.in_b ? first.index : second.index, before, after});
  };
  for (std::size_t i = 1; i < groups.size(); ++i)
    offer(static_cast<std::ptrdiff_t>(i) - 1, static_cast<std::ptrdiff_t>(i));

  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  const auto remove_front = [&](std::ptrdiff_t number) {
    Group& group = groups[number];
    if (++group.front < group.end) return;
    if (group.previous >= 0) groups[group.previous].next = group.next;
    if (group.next >= 0) groups[group.next].previous = group.previous;
  };
  const auto is_current = [&](const Candidate& candidate) {
    const Group& before = groups[candidate.before];
    const Group& after = groups[candidate.after];
    if (before.front == before.end || after.front == after.end) return false;
    const Stamp& first = stamps[before.front];
    return (first.in_b ? stamps[after.front] : first).index == candidate.index_a &&
           (first.in_b ? first : stamps[after.front]).index == candidate.index_b;
  };
  while (!queue.empty()) {
    const Candidate nearest = queue.top();
    queue.pop();
    if (!is_current(nearest)) continue;
    pairs.emplace_back(nearest.index_a, nearest.index_b);
    remove_front(nearest.before);
    remove_front(nearest.after);
    // Offer again every neighbourhood whose stamps in front have changed; what stands in the queue twice is found
    // stale.
    const bool before_left = groups[nearest.before].front < groups[nearest.before].end;
    const bool after_left = groups[nearest.after].front < groups[nearest.after].end;
    const std::ptrdiff_t before = before_left ? nearest.before : groups[nearest.before].previous;
    const std::ptrdiff_t after = after_left ? nearest.after : groups[nearest.after].next;
    offer(before, after);
    if (before_left) offer(groups[nearest.before].previous, nearest.before);
    if (after_left) offer(nearest.after, groups[nearest.after].next);
  }
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

}  // namespace holdfast
