// SPDX-License-Identifier: BSD-3-Clause
// Place recognition in rooms that changed between two visits, by descriptors alone and with classes:
//
//     place_changes SEGMENTER WEIGHTS FIRST SECOND [FIRST SECOND]...
//
// SEGMENTER, FIRST, SECOND: as in a configuration, "truth" or "{ unet: {} }" and "{ simulated: { scene: ... } }".
// WEIGHTS: class_weights of `flann`, "chair=0.1,monitor=0.1"; several sets are separated by ';'. FIRST and SECOND are
// recordings of two visits to a room with true poses in the same frame, a keyframe in each frame.
//
// The views of the first visit are the database, those of the second are asked for in order and then added, as in a run
// that continues a map. Printed for each pair of visits, and for all together with one threshold:
// - recognition: recall of the best candidate of the first visit while none is wrong (precision 100 %); a candidate is
//   right if it shows at least 0.2 of the query, recall counts queries for which a candidate shows at least 0.3
//   (place_views.hpp); by score, and by score relative to the least similar neighbour of the same visit;
// - loops: queries with a candidate (the three best with a relative score of at least LoopClosingSettings::score_share)
//   that passes the verification of loop closing; right within 0.2 m and 5 degrees of the true pose. Recall counts
//   those with more inliers than any wrong one, which are printed.
#include <algorithm>
#include <cstdio>
#include <exception>
#include <memory>
#include <string>
#include <vector>

#include "class_weights.hpp"
#include "flann_detector.hpp"
#include "holdfast/interfaces/optimizer.hpp"
#include "holdfast/interfaces/place_weights.hpp"
#include "holdfast/plugin/builtin.hpp"
#include "place_check.hpp"
#include "plausibility.hpp"
#include "visit.hpp"

namespace holdfast {
namespace {

/// A candidate must show at least this share of a query for the query to count in the recall.
constexpr double possible_share = 0.3;

/// The map of the first visit at its true poses: each feature with depth is a point.
std::vector<KeyFrameId> build_map(const Visit& visit, Map& map) {
  std::vector<KeyFrameId> ids;
  map.set_classes(visit.classes);
  for (const Frame& frame : visit.frames) {
    const KeyFrameId id = map.add_keyframe(frame);
    const Eigen::Isometry3d T_world_camera = frame.T_world_camera();
    for (std::uint32_t i = 0; i < frame.size(); ++i) {
      if (!frame.has_depth(i)) continue;
      const MapPointId point = map.add_point(T_world_camera * frame.camera_point(i), map.keyframe(id).sequence);
      map.add_observation(point, id, i);
      map.update_point(point);
    }
    ids.push_back(id);
  }
  return ids;
}

struct Answer {
  double score = 0.0, relative = 0.0;
  bool is_right = false, is_possible = false;
  double inliers = 0.0;  ///< of the candidate that passed the verification
  bool is_closed = false, closes_right = false;
};

/// Recall of loops while none with more inliers is wrong.
double loop_recall(const std::vector<Answer>& answers) {
  double wrong = 0.0;
  int possible = 0, recalled = 0;
  for (const Answer& answer : answers)
    if (answer.is_closed && !answer.closes_right) wrong = std::max(wrong, answer.inliers);
  for (const Answer& answer : answers) {
    possible += answer.is_possible ? 1 : 0;
    recalled += answer.is_possible && answer.closes_right && answer.inliers > wrong ? 1 : 0;
  }
  return possible > 0 ? static_cast<double>(recalled) / possible : 0.0;
}

/// Recall while no answer with a larger value is wrong.
double recall(const std::vector<Answer>& answers, double Answer::*value) {
  double wrong = 0.0;
  int possible = 0, recalled = 0;
  for (const Answer& answer : answers)
    if (!answer.is_right) wrong = std::max(wrong, answer.*value);
  for (const Answer& answer : answers) {
    possible += answer.is_possible ? 1 : 0;
    recalled += answer.is_possible && answer.is_right && answer.*value > wrong ? 1 : 0;
  }
  return possible > 0 ? static_cast<double>(recalled) / possible : 0.0;
}

void print(const char* name, const std::vector<Answer>& answers) {
  int possible = 0, right = 0, wrong = 0;
  for (const Answer& answer : answers) {
    possible += answer.is_possible ? 1 : 0;
    right += answer.closes_right ? 1 : 0;
    wrong += answer.is_closed && !answer.closes_right ? 1 : 0;
  }
  std::printf(
      "  %-34s recognition %5.1f %%, relative %5.1f %%; loops %5.1f %%; of %d possible; "
      "loops without limit: %d right, %d wrong\n",
      name, 100.0 * recall(answers, &Answer::score), 100.0 * recall(answers, &Answer::relative),
      100.0 * loop_recall(answers), possible, right, wrong);
  std::fflush(stdout);
}

class Judge {
 public:
  Judge(const Visit& first, const Visit& second, Optimizer& optimizer)
      : first_(first), second_(second), optimizer_(optimizer), ids_(build_map(first, map_)) {
    shared_.resize(second.views.size());
    for (std::size_t q = 0; q < second.views.size(); ++q)
      for (const PlaceView& view : first.views) shared_[q].push_back(shared_view(first.camera, second.views[q], view));
  }

  std::vector<Answer> judge(const ClassWeights& class_weights) {
    FlannSettings settings;
    settings.class_weights = class_weights;
    flann_plugin::FlannDetector detector(settings);
    const PlaceWeights weights(detector, second_.classes);
    for (std::size_t i = 0; i < ids_.size(); ++i) detector.add(ids_[i], static_descriptors(first_.frames[i]));
    std::vector<Answer> answers;
    for (std::size_t q = 0; q < second_.frames.size(); ++q) {
      const DescriptorBlock descriptors = static_descriptors(second_.frames[q]);
      const std::vector<float> of_features = weights.of_static_features(second_.frames[q]);
      const int all = static_cast<int>(ids_.size() + q);
      answers.push_back(answer(q, detector.query_weighted(descriptors, of_features, all), weights));
      detector.add(id_of_query(q), descriptors);
    }
    return answers;
  }

 private:
  static KeyFrameId id_of_query(std::size_t query) { return {1000000U + static_cast<std::uint32_t>(query), 0}; }

  Answer answer(std::size_t q, const std::vector<PlaceMatch>& matches, const PlaceWeights& weights) {
    constexpr int verified = 3;
    Answer result;
    const double neighbour = least_neighbour(q, matches);
    result.is_possible = *std::max_element(shared_[q].begin(), shared_[q].end()) >= possible_share;
    int tried = 0;
    for (const PlaceMatch& match : matches) {
      const auto found = std::find(ids_.begin(), ids_.end(), match.keyframe);
      if (found == ids_.end()) continue;
      const auto candidate = static_cast<std::size_t>(found - ids_.begin());
      if (tried == 0) {
        result.score = match.score;
        result.relative = neighbour > 0.0 ? match.score / neighbour : 0.0;
        result.is_right = shared_[q][candidate] >= 0.2;
      }
      if (match.score < settings_.score_share * neighbour || tried++ == verified) break;
      if (verify(q, candidate, weights, result)) break;
    }
    return result;
  }

  /// Lowest score of earlier views of this visit that show at least 0.3 of the query, as covisible keyframes do.
  double least_neighbour(std::size_t q, const std::vector<PlaceMatch>& matches) const {
    double least = 0.0;  // matches are sorted by decreasing score
    for (const PlaceMatch& match : matches) {
      if (match.keyframe.slot < 1000000U) continue;
      const std::size_t other = match.keyframe.slot - 1000000U;
      if (shared_view(second_.camera, second_.views[q], second_.views[other]) >= 0.3) least = match.score;
    }
    return least;
  }

  bool verify(std::size_t q, std::size_t candidate, const PlaceWeights& weights, Answer& result) {
    std::vector<KeyFrameId> side = {ids_[candidate]};
    if (candidate > 0) side.push_back(ids_[candidate - 1]);
    if (candidate + 1 < ids_.size()) side.push_back(ids_[candidate + 1]);
    PlacePoints place = copy_points_seen_by(map_, side);
    if (!weights.are_uniform()) copy_votes(map_, place);
    const Frame& frame = second_.frames[q];
    const CheckedPlace checked = check_place(settings_, nearest_matcher(), optimizer_, frame,
                                             located_features(frame, map_), place, q + 1, weights);
    if (checked.verdict != LoopVerdict::closed) return false;
    const PoseChange error = pose_change(frame.T_camera_world, checked.T_camera_world);
    result.is_closed = true;
    result.closes_right = error.metres < 0.2 && error.degrees < 5.0;
    result.inliers = static_cast<double>(checked.inliers.size());
    if (!result.closes_right)
      std::printf(
          "    wrong: query %zu, candidate %zu that shows %.2f of it, off by %.2f m and %.1f degrees, %d inliers of "
          "%d, agreement %.2f\n",
          q, candidate, shared_[q][candidate], error.metres, error.degrees, static_cast<int>(checked.inliers.size()),
          checked.expected, checked.class_agreement);
    return true;
  }

  const Visit& first_;
  const Visit& second_;
  Optimizer& optimizer_;
  LoopClosingSettings settings_;
  Map map_;
  std::vector<KeyFrameId> ids_;
  std::vector<std::vector<double>> shared_;  // of a query by a view of the first visit
};

int run(int count, char** arguments) {
  if (count < 5 || count % 2 == 0) {
    std::fprintf(stderr, "usage: place_changes SEGMENTER WEIGHTS FIRST SECOND [FIRST SECOND]...\n");
    return 2;
  }
  Registry registry;
  register_builtin_plugins(registry);
  const auto optimizer = registry.create<Optimizer>("schur", {}, {});
  const std::vector<std::string> names = weight_sets(arguments[2]);
  std::vector<std::vector<Answer>> all(names.size());
  for (int i = 3; i + 1 < count; i += 2) {
    const Visit first = read_visit(arguments[i], arguments[1]), second = read_visit(arguments[i + 1], arguments[1]);
    std::printf("%s\n  against %s: %zu and %zu views\n", arguments[i + 1], arguments[i], first.views.size(),
                second.views.size());
    Judge judge(first, second, *optimizer);
    for (std::size_t k = 0; k < names.size(); ++k) {
      const std::vector<Answer> answers = judge.judge(class_weights_of(names[k]));
      print(names[k].c_str(), answers);
      all[k].insert(all[k].end(), answers.begin(), answers.end());
    }
  }
  std::printf("all\n");
  for (std::size_t k = 0; k < names.size(); ++k) print(names[k].c_str(), all[k]);
  return 0;
}

}  // namespace
}  // namespace holdfast

int main(int count, char** arguments) {
  try {
    return holdfast::run(count, arguments);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "place_changes: %s\n", error.what());
    return 1;
  }
}
