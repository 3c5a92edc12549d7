// SPDX-License-Identifier: BSD-3-Clause
// Precision and recall of place recognition with `flann` on recordings with true poses, and its cost on a drawn tour:
//
//     place_recall FOLDER STEP GAP SOURCE [STEP GAP SOURCE]...     writes FOLDER/place_recall.csv and .svg
//     place_recall FOLDER                                          writes FOLDER/place_cost.csv and .svg
//
// STEP: every so many frames is a keyframe. GAP [s]: keyframes younger than this are no candidates. SOURCE: as in a
// configuration, "{ simulated: { scene: examples/scenes/loop.yaml } }". Each keyframe is asked for, then added. Its
// best candidate is right when it shows at least 0.2 of what the query shows, by true poses and depth
// (place_views.hpp). Recall counts the queries for which a candidate shows at least 0.5. Without recordings the cost on
// a drawn tour is measured, in processor time.
#include <algorithm>
#include <cstdio>
#include <ctime>
#include <exception>
#include <filesystem>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "flann_detector.hpp"
#include "holdfast/core/trajectory.hpp"
#include "holdfast/evaluation/statistics.hpp"
#include "holdfast/evaluation/svg_plot.hpp"
#include "place_tour.hpp"
#include "place_views.hpp"

namespace holdfast {
namespace {

struct Answer {
  double score = 0.0;   ///< of the best candidate
  double shared = 0.0;  ///< what it shows of the query
  bool possible = false;
};

struct Judgement {
  std::vector<Answer> answers;
  std::vector<double> true_scores;   ///< of all candidates that show at least half
  std::vector<double> other_scores;  ///< of all candidates that show nothing
};

Judgement judge(const PlaceRecording& recording, double gap) {
  Judgement result;
  flann_plugin::FlannDetector detector({});
  const int count = static_cast<int>(recording.views.size());
  for (int i = 0; i < count; ++i) {
    const PlaceView& view = recording.views[static_cast<std::size_t>(i)];
    std::map<std::uint32_t, double> scores;
    for (const PlaceMatch& match : detector.query(view.descriptors, count)) scores[match.keyframe.slot] = match.score;
    Answer answer;
    for (std::uint32_t j = 0; j < static_cast<std::uint32_t>(i); ++j) {
      const PlaceView& other = recording.views[j];
      if (view.timestamp - other.timestamp < gap) break;
      const double shared = shared_view(recording.camera, view, other);
      if (shared >= 0.5) answer.possible = true;
      if (shared >= 0.5) result.true_scores.push_back(scores[j]);
      if (shared == 0.0) result.other_scores.push_back(scores[j]);
      if (scores[j] > answer.score) answer.score = scores[j], answer.shared = shared;
    }
    result.answers.push_back(answer);
    detector.add({static_cast<std::uint32_t>(i), 0}, view.descriptors);
  }
  return result;
}

double share(double part, double whole) { return whole > 0.0 ? part / whole : 0.0; }

/// Precision over recall as the threshold falls; one row of `csv` each.
PlotLine precision_recall(const PlaceRecording& recording, const Judgement& judgement, std::ostream& csv) {
  PlotLine line;
  line.label = recording.name;
  const auto possible = std::count_if(judgement.answers.begin(), judgement.answers.end(),
                                      [](const Answer& answer) { return answer.possible; });
  for (double threshold = 0.3; threshold > 0.004; threshold *= 0.95) {
    int right = 0, wrong = 0, recalled = 0;
    for (const Answer& answer : judgement.answers) {
      if (answer.score < threshold) continue;
      const bool is_right = answer.shared >= 0.2;
      ++(is_right ? right : wrong);
      if (is_right && answer.possible) ++recalled;
    }
    const double precision = right + wrong > 0 ? share(right, right + wrong) : 1.0;
    const double recall = share(recalled, static_cast<double>(possible));
    csv << recording.name << ';' << threshold << ';' << right << ';' << wrong << ';' << precision << ';' << recall
        << '\n';
    line.x.push_back(recall);
    line.y.push_back(precision);
  }
  std::printf("%s: %zu keyframes, %ld with a place to find\n", recording.name.c_str(), judgement.answers.size(),
              static_cast<long>(possible));
  if (!judgement.true_scores.empty())
    std::printf("  candidates that show half of the query: %zu, score 10 %% %.4f, median %.4f, 90 %% %.4f\n",
                judgement.true_scores.size(), percentile(judgement.true_scores, 10.0), median(judgement.true_scores),
                percentile(judgement.true_scores, 90.0));
  if (!judgement.other_scores.empty())
    std::printf("  candidates that show nothing of it: %zu, score median %.4f, 99 %% %.4f, largest %.4f\n",
                judgement.other_scores.size(), median(judgement.other_scores), percentile(judgement.other_scores, 99.0),
                percentile(judgement.other_scores, 100.0));
  return line;
}

/// Processor time of query and insertion while a drawn tour grows, in medians of the last fiftieth.
void write_cost(const std::filesystem::path& folder, std::uint32_t keyframes) {
  const PlaceTour tour;
  flann_plugin::FlannDetector detector({});
  PlotLine both, query;
  both.label = "query and insertion";
  query.label = "query";
  query.colour = plot_colour::orange;
  std::ostringstream csv;
  csv << "keyframes;query_ms;query_and_insertion_ms;words\n";
  std::vector<double> query_times, both_times;
  const std::uint32_t window = std::max(20U, keyframes / 50);
  const auto now = [] { return 1e3 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC; };
  for (std::uint32_t i = 0; i < keyframes; ++i) {
    const auto descriptors = tour.keyframe(i);
    const double begin = now();
    detector.query(descriptors, 30);
    query_times.push_back(now() - begin);
    detector.add({i, 0}, descriptors);
    both_times.push_back(now() - begin);
    if ((i + 1) % window != 0) continue;
    query.x.push_back(i + 1);
    query.y.push_back(median(query_times));
    both.x.push_back(i + 1);
    both.y.push_back(median(both_times));
    csv << i + 1 << ';' << query.y.back() << ';' << both.y.back() << ';' << detector.words() << '\n';
    query_times.clear();
    both_times.clear();
  }
  Plot plot;
  plot.title = "Cost as the map grows (drawn tour, 1000 descriptors given per keyframe)";
  plot.x_label = "keyframes in the map";
  plot.y_label = "processor time, median [ms]";
  plot.y_from_zero = true;
  plot.lines = {both, query};
  write_file_atomically(folder / "place_cost.svg", to_svg(plot));
  write_file_atomically(folder / "place_cost.csv", csv.str());
}

int run(int count, char** arguments) {
  if (count < 2 || (count - 2) % 3 != 0) {
    std::fprintf(stderr, "usage: place_recall FOLDER [STEP GAP SOURCE]...\n");
    return 2;
  }
  const std::filesystem::path folder = arguments[1];
  std::filesystem::create_directories(folder);
  if (count == 2) {
    write_cost(folder, 10000);
    return 0;
  }
  Plot plot;
  plot.title = "Precision over recall as the score threshold falls";
  plot.x_label = "recall";
  plot.y_label = "precision";
  plot.y_from_zero = true;
  std::ostringstream csv;
  csv << "recording;threshold;right;wrong;precision;recall\n";
  const char* colours[] = {plot_colour::blue, plot_colour::vermilion, plot_colour::green, plot_colour::purple};
  for (int i = 2; i < count; i += 3) {
    const PlaceRecording recording = read_recording(arguments[i + 2], std::stoi(arguments[i]));
    plot.lines.push_back(precision_recall(recording, judge(recording, std::stod(arguments[i + 1])), csv));
    plot.lines.back().colour = colours[plot.lines.size() % 4];
  }
  write_file_atomically(folder / "place_recall.svg", to_svg(plot));
  write_file_atomically(folder / "place_recall.csv", csv.str());
  return 0;
}

}  // namespace
}  // namespace holdfast

int main(int count, char** arguments) {
  try {
    return holdfast::run(count, arguments);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "place_recall: %s\n", error.what());
    return 1;
  }
}
