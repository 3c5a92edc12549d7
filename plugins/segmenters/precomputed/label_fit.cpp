// SPDX-License-Identifier: BSD-3-Clause
#include "label_fit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "holdfast/core/median.hpp"
#include "holdfast/image_files/image_list.hpp"

namespace holdfast::precomputed_plugin {

namespace {

/// Stamps of one recording that were rounded differently.
constexpr double rounding = 2e-3;  // s

std::string seconds(double value) { return stamp_text(value) + " s"; }

double frame_interval(const std::vector<double>& frames) {
  std::vector<double> intervals;
  for (std::size_t i = 1; i < frames.size(); ++i) intervals.push_back(frames[i] - frames[i - 1]);
  return intervals.empty() ? 0.0 : upper_median(intervals);
}

/// The constant difference between label images and frames that are as many; 0 if it varies.
double constant_difference(const std::vector<LabelFile>& files, const std::vector<double>& frames) {
  constexpr std::size_t least = 3;
  if (files.size() != frames.size() || files.size() < least) return 0.0;
  double lowest = std::numeric_limits<double>::max(), highest = std::numeric_limits<double>::lowest();
  for (std::size_t i = 0; i < files.size(); ++i) {
    lowest = std::min(lowest, files[i].timestamp - frames[i]);
    highest = std::max(highest, files[i].timestamp - frames[i]);
  }
  return highest - lowest <= rounding ? 0.5 * (lowest + highest) : 0.0;
}

bool is_whole(double stamp) { return stamp >= 0.0 && stamp < 1e6 && stamp == std::floor(stamp); }

/// Whether the names of the label images are numbers of frames, which have other time stamps.
bool are_frame_numbers(const std::vector<LabelFile>& files, const std::vector<double>& frames) {
  return std::ranges::all_of(files, [](const LabelFile& file) { return is_whole(file.timestamp); }) &&
         !std::ranges::all_of(frames, is_whole);
}

/// Median distance from a frame to the nearest label image.
double nearest_distance(const std::vector<LabelFile>& files, const std::vector<double>& frames) {
  std::vector<double> distances;
  for (const double frame : frames)
    distances.push_back(
        std::abs(nearest_label_file(files, frame, std::numeric_limits<double>::infinity())->timestamp - frame));
  return upper_median(distances);
}

std::string advice_for(const LabelFit& fit, const std::vector<LabelFile>& files, const std::vector<double>& frames) {
  const double first = files.front().timestamp, last = files.back().timestamp;
  if (fit.shift != 0.0)
    return "every label image is " + seconds(std::abs(fit.shift)) + (fit.shift > 0.0 ? " later" : " earlier") +
           " than the frame of the same number; correct their time stamps";
  const std::string times = "the label images are of " + seconds(first) + " to " + seconds(last) + ", the frames of " +
                            seconds(frames.front()) + " to " + seconds(frames.back());
  if (are_frame_numbers(files, frames))
    return times +
           "; are the names numbers of frames? Name each image by the time stamp of its frame, or give lines "
           "'timestamp filename' in `segmenter.precomputed.list`";
  if (last < frames.front() || first > frames.back())
    return times + "; are they of this recording? Correct `segmenter.precomputed.path` or the time stamps";
  return "from a frame to the nearest label image it is " + seconds(nearest_distance(files, frames)) +
         " (median); `segmenter.precomputed.tolerance` accepts label images of other frames, which are as wrong as "
         "people have moved since";
}

}  // namespace

LabelFit fit_labels(const std::vector<LabelFile>& files, const std::vector<double>& frames, double tolerance) {
  LabelFit fit;
  fit.frames = frames.size();
  for (const double frame : frames) fit.found += nearest_label_file(files, frame, tolerance) != nullptr ? 1 : 0;
  fit.found_text = (fit.found == 0 ? "none" : std::to_string(fit.found)) + " of " + std::to_string(fit.frames) +
                   " frames " + (fit.found == 1 ? "has" : "have") + " a label image within " + seconds(tolerance);
  if (frames.empty()) return fit;
  const double difference = constant_difference(files, frames);
  if (std::abs(difference) > std::max(rounding, 0.5 * frame_interval(frames))) fit.shift = difference;
  fit.advice = advice_for(fit, files, frames);
  return fit;
}

}  // namespace holdfast::precomputed_plugin
