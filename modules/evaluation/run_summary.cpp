// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/evaluation/run_summary.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <string_view>

#include "holdfast/core/health_reason_names.hpp"

namespace holdfast {

void RunSummary::add(const FrameResult& result, double decode_seconds) {
  ++frames_;
  ++statuses_[result.status];
  ++health_[result.health.state];
  for (const HealthReason reason : reasons_in(result.health.reasons)) ++reasons_[reason];
  largest_jump_ = std::max(largest_jump_, result.health.jump);
  if (result.status == TrackingStatus::lost || result.status == TrackingStatus::waiting) ++failures_[result.failure];
  if (result.status == TrackingStatus::tracked) {
    inliers_ += static_cast<std::uint64_t>(result.inliers);
    ++fallbacks_[result.fallback];
    if (result.method == TrackingMethod::recovered) ++recovered_;
    if (result.method == TrackingMethod::relocalised) ++relocalised_;
    if (result.method == TrackingMethod::flow) ++by_flow_;
  }
  stage("decode").add(decode_seconds);
  add(result.times);
  tracking_seconds_.push_back(result.tracking_seconds);
}

void RunSummary::add(const StageTimes& background) {
  for (const StageTimes::Entry& entry : background.entries()) stage(std::string(entry.stage)).add(entry.seconds);
}

namespace {
template <class Key>
std::uint64_t count_in(const std::map<Key, std::uint64_t>& counts, Key key) {
  const auto found = counts.find(key);
  return found == counts.end() ? 0 : found->second;
}
}  // namespace

std::uint64_t RunSummary::count(TrackingStatus status) const { return count_in(statuses_, status); }
std::uint64_t RunSummary::count(TrackingFallback fallback) const { return count_in(fallbacks_, fallback); }
std::uint64_t RunSummary::count(HealthState state) const { return count_in(health_, state); }

double RunSummary::mean_inliers() const {
  const std::uint64_t tracked_frames = count(TrackingStatus::tracked);
  return tracked_frames == 0 ? 0.0 : static_cast<double>(inliers_) / static_cast<double>(tracked_frames);
}

DurationRecord& RunSummary::stage(const std::string& name) {
  for (Stage& known : stages_)
    if (known.name == name) return known.seconds;
  return stages_.emplace_back(Stage{name, {}}).seconds;
}

namespace {
StageRow row_of(const std::string& name, const DurationRecord& seconds) {
  StageRow row{.stage = name, .frames = seconds.count()};
  if (seconds.empty()) return row;
  row.median = seconds.median();
  row.p95 = seconds.percentile(95.0);
  row.maximum = seconds.maximum();
  row.total = seconds.total();
  return row;
}

/// The place of a stage's part in the pipeline. A stage outside of tracking is called by its part.
int part_of(std::string_view stage) {
  constexpr std::array<std::string_view, 4> parts{"segmentation", "mapping: ", "loops: ", "dense map: "};
  const auto* const found =
      std::find_if(parts.begin(), parts.end(), [&](std::string_view part) { return stage.starts_with(part); });
  return found == parts.end() ? 0 : static_cast<int>(found - parts.begin()) + 1;
}
}  // namespace

std::vector<StageRow> RunSummary::stages() const {
  std::vector<StageRow> rows;
  double total = 0.0;
  for (const Stage& known : stages_) {
    rows.push_back(row_of(known.name, known.seconds));
    total += rows.back().total;
  }
  std::stable_sort(rows.begin(), rows.end(),
                   [](const StageRow& a, const StageRow& b) { return part_of(a.stage) < part_of(b.stage); });
  for (StageRow& row : rows) row.share = total > 0.0 ? row.total / total : 0.0;
  return rows;
}

StageRow RunSummary::tracking() const {
  DurationRecord seconds;
  for (const double frame : tracking_seconds_) seconds.add(frame);
  StageRow row = row_of("tracking", seconds);
  double total = 0.0;
  for (const Stage& known : stages_) total += known.seconds.total();
  row.share = total > 0.0 ? row.total / total : 0.0;
  return row;
}

std::string stage_table(const RunSummary& summary) {
  char line[160];
  std::snprintf(line, sizeof(line), "%-28s %7s %10s %9s %9s %7s\n", "stage", "frames", "median ms", "p95 ms", "max ms",
                "share");
  std::string text = line;
  const auto add = [&](const StageRow& row, const std::string& name) {
    std::snprintf(line, sizeof(line), "%-28s %7zu %10.3f %9.3f %9.3f %6.1f%%\n", name.c_str(), row.frames,
                  row.median * 1e3, row.p95 * 1e3, row.maximum * 1e3, row.share * 100);
    text += line;
  };
  for (const StageRow& row : summary.stages()) add(row, row.stage);
  add(summary.tracking(), "tracking (all its stages)");
  return text;
}

}  // namespace holdfast
