// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/inference/object_output.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "holdfast/core/error.hpp"

namespace holdfast {

namespace {

constexpr std::size_t most_candidates = 3000;

/// The numbers of a list of boxes, for either order of its dimensions.
struct Table {
  const float* data = nullptr;
  std::ptrdiff_t row_step = 0, column_step = 1;

  float at(int row, int column) const { return data[row * row_step + column * column_step]; }
};

struct Candidate {
  int box = 0, class_number = 0;
  float score = 0.0F;
};

/// Reads one frame's outputs; see decode_objects().
class ObjectReader {
 public:
  ObjectReader(const std::vector<cv::Mat>& outputs, const ObjectLayout& layout, const cv::Size& input, int names,
               const std::filesystem::path& model)
      : outputs_(outputs), layout_(layout), input_(input), names_(names), model_(model), count_(count_of(layout)) {
    if (count_ == 0) return;
    boxes_ =
        table(layout.boxes, layout.is_transposed ? layout.width : count_, layout.is_transposed ? count_ : layout.width);
    if (layout.is_transposed) std::swap(boxes_.row_step, boxes_.column_step);
    const bool has_numbers = layout.numbers.has_value();
    const int columns = has_numbers ? 1 : layout.classes + (layout.preset.scores == ScoreForm::logits ? 0 : 1);
    if (layout.scores) scores_ = table(*layout.scores, count_, columns);
    if (has_numbers) numbers_ = table(*layout.numbers, count_, 1);
    if (layout.masks) check_masks(outputs_[*layout.masks]);
  }

  std::vector<Candidate> candidates(float min_score) const {
    std::vector<Candidate> found;
    for (int box = 0; box < count_; ++box) {
      Candidate candidate = best_class(box);
      candidate.box = box;
      if (candidate.class_number >= 0 && candidate.score >= min_score) found.push_back(candidate);
    }
    std::stable_sort(found.begin(), found.end(),
                     [](const Candidate& a, const Candidate& b) { return a.score > b.score; });
    if (found.size() > most_candidates) found.resize(most_candidates);
    return found;
  }

  std::vector<Detection> detections(const std::vector<Candidate>& candidates) const {
    const bool is_fraction = has_fractions(candidates);
    std::vector<Detection> result;
    for (const Candidate& candidate : candidates) {
      if (candidate.class_number >= names_)
        fail("gives an object of class " + std::to_string(candidate.class_number) + "; expected numbers below " +
             std::to_string(names_) + ", for the names in `classes`; correct `classes` or `family`");
      const cv::Rect2f box = clipped_box(candidate.box, is_fraction);
      if (box.width <= 0.0F || box.height <= 0.0F) continue;
      result.push_back({candidate.class_number, candidate.score, box, coefficients(candidate.box), candidate.box});
    }
    return result;
  }

 private:
  [[noreturn]] void fail(const std::string& message) const { throw InputError({model_.string()}, message); }

  /// The number of boxes of this image.
  int count_of(const ObjectLayout& layout) const {
    if (layout.count > 0) return layout.count;
    const std::size_t numbers = layout.boxes < outputs_.size() ? outputs_[layout.boxes].total() : 0;
    constexpr std::size_t most = std::size_t{1} << 22;
    return static_cast<int>(std::min(numbers / static_cast<std::size_t>(layout.width), most));
  }

  void check_masks(const cv::Mat& masks) const {
    const auto boxes = static_cast<std::size_t>(count_);
    if (masks.dims == 4 && masks.type() == CV_32FC1 && masks.isContinuous() && masks.total() > 0 &&
        masks.total() == boxes * static_cast<std::size_t>(masks.size[2]) * static_cast<std::size_t>(masks.size[3]))
      return;
    fail("gives masks of " + std::to_string(masks.total()) + " numbers for " + std::to_string(boxes) +
         " boxes; expected an image for each");
  }

  Table table(std::size_t output, int rows, int columns) const {
    const auto expected = static_cast<std::size_t>(rows) * static_cast<std::size_t>(columns);
    const bool is_there = output < outputs_.size() && rows > 0 && columns > 0;
    const cv::Mat values = is_there ? outputs_[output] : cv::Mat();
    if (!is_there || values.type() != CV_32FC1 || !values.isContinuous() || values.total() != expected)
      fail("gives an output of " + std::to_string(values.total()) + " numbers; expected " + std::to_string(rows) +
           " x " + std::to_string(columns) + ", as for the first image");
    return {values.ptr<float>(), columns, 1};
  }

  float probability(float value) const {
    constexpr float slack = 1e-3F;
    if (!(value >= -slack && value <= 1.0F + slack))
      fail("gives a score of " + std::to_string(value) + "; expected probabilities, 0 to 1, of the family " +
           layout_.preset.title + "; correct `family`, `scale`, `mean` or `standard_deviation`");
    return std::clamp(value, 0.0F, 1.0F);
  }
  float finite(float value) const {
    if (!(std::abs(value) <= 1e30F))
      fail("gives numbers that are not finite; expected boxes and scores; check `scale`, `mean` and the weights");
    return value;
  }

  /// Number of a class, or -1 for those of the background.
  int class_of(float value) const {
    if (!(value >= 0.0F && value <= 1e6F && value == std::floor(value)))
      fail("gives the class number " + std::to_string(value) + "; expected whole numbers from 0; correct `family`");
    return static_cast<int>(value);
  }

  Candidate best_class(int box) const {
    switch (layout_.preset.scores) {
      case ScoreForm::probabilities:
        return best_probability(boxes_, box, 4);
      case ScoreForm::objectness: {
        Candidate best = best_probability(boxes_, box, 5);
        best.score *= probability(boxes_.at(box, 4));
        return best;
      }
      case ScoreForm::cell: {
        Candidate best = best_probability(boxes_, box, 5);
        best.score = std::pow(probability(boxes_.at(box, 0)), 0.6F) * std::pow(best.score, 0.4F);
        return best;
      }
      case ScoreForm::best:
        return {box, class_of(boxes_.at(box, 5)), probability(boxes_.at(box, 4))};
      case ScoreForm::background_first:
        return best_probability(scores_, box, 1);
      case ScoreForm::numbered:
        return {box, class_of(numbers_.at(box, 0)) - 1, probability(scores_.at(box, 0))};
      case ScoreForm::logits: {
        Candidate best = highest(box, layout_.classes);
        best.score = 1.0F / (1.0F + std::exp(-best.score));
        return best;
      }
      case ScoreForm::softmax:
        return best_share(box);
    }
    return {};
  }

  Candidate best_probability(const Table& scores, int box, int first) const {
    Candidate best{box, 0, -1.0F};
    for (int i = 0; i < layout_.classes; ++i) {
      const float score = probability(scores.at(box, first + i));
      if (score > best.score) best.class_number = i, best.score = score;
    }
    return best;
  }

  Candidate highest(int box, int classes) const {
    Candidate best{box, 0, finite(scores_.at(box, 0))};
    for (int i = 1; i < classes; ++i)
      if (const float score = finite(scores_.at(box, i)); score > best.score) best.class_number = i, best.score = score;
    return best;
  }

  /// The best class but the last one, which means none, with its share of all.
  Candidate best_share(int box) const {
    Candidate best = highest(box, layout_.classes);
    const float top = std::max(best.score, finite(scores_.at(box, layout_.classes)));
    float sum = 0.0F;
    for (int i = 0; i <= layout_.classes; ++i) sum += std::exp(scores_.at(box, i) - top);
    best.score = std::exp(best.score - top) / sum;
    return best;
  }

  bool has_fractions(const std::vector<Candidate>& candidates) const {
    if (layout_.preset.unit != BoxUnit::either) return layout_.preset.unit == BoxUnit::fractions;
    constexpr float most = 2.0F;
    return std::all_of(candidates.begin(), candidates.end(), [&](const Candidate& candidate) {
      for (int i = 0; i < 4; ++i)
        if (boxes_.at(candidate.box, i) > most) return false;
      return true;
    });
  }

  cv::Rect2f clipped_box(int box, bool is_fraction) const {
    if (!layout_.has_boxes) return {0.0F, 0.0F, static_cast<float>(input_.width), static_cast<float>(input_.height)};
    if (layout_.preset.box == BoxForm::cell) return cell_box(box);
    double left = finite(boxes_.at(box, 0)), top = finite(boxes_.at(box, 1));
    double right = finite(boxes_.at(box, 2)), bottom = finite(boxes_.at(box, 3));
    if (layout_.preset.box == BoxForm::centre) {
      const double width = right, height = bottom;
      left -= 0.5 * width, top -= 0.5 * height;
      right = left + width, bottom = top + height;
    }
    const double columns = input_.width, rows = input_.height;
    const double x = is_fraction ? columns : 1.0, y = is_fraction ? rows : 1.0;
    const auto place = [](double value, double unit, double limit) { return std::clamp(value * unit, 0.0, limit); };
    const cv::Point2d first(place(left, x, columns), place(top, y, rows));
    const cv::Point2d last(place(right, x, columns), place(bottom, y, rows));
    return {static_cast<float>(first.x), static_cast<float>(first.y), static_cast<float>(last.x - first.x),
            static_cast<float>(last.y - first.y)};
  }

  cv::Rect2f cell_box(int box) const {
    const int columns = layout_.grid_columns, rows = count_ / columns;
    const auto sigmoid = [](double value) { return 1.0 / (1.0 + std::exp(-value)); };
    const double x = (box % columns + std::tanh(finite(boxes_.at(box, 1)))) / columns;
    const double y = (box / columns + std::tanh(finite(boxes_.at(box, 2)))) / rows;
    const double half_width = 0.5 * sigmoid(finite(boxes_.at(box, 3)));
    const double half_height = 0.5 * sigmoid(finite(boxes_.at(box, 4)));
    const auto place = [](double value, int size) { return static_cast<float>(std::clamp(value, 0.0, 1.0) * size); };
    const cv::Point2f first(place(x - half_width, input_.width), place(y - half_height, input_.height));
    const cv::Point2f last(place(x + half_width, input_.width), place(y + half_height, input_.height));
    return {first.x, first.y, last.x - first.x, last.y - first.y};
  }

  std::vector<float> coefficients(int box) const {
    std::vector<float> result;
    if (!layout_.prototypes) return result;
    for (int i = layout_.width - layout_.coefficients; i < layout_.width; ++i)
      result.push_back(finite(boxes_.at(box, i)));
    return result;
  }

  const std::vector<cv::Mat>& outputs_;
  const ObjectLayout& layout_;
  cv::Size input_;
  int names_;
  const std::filesystem::path& model_;
  int count_;
  Table boxes_, scores_, numbers_;
};

}  // namespace

std::vector<Detection> decode_objects(const std::vector<cv::Mat>& outputs, const ObjectLayout& layout,
                                      const cv::Size& input, double min_score, int names,
                                      const std::filesystem::path& model) {
  const ObjectReader reader(outputs, layout, input, names, model);
  return reader.detections(reader.candidates(static_cast<float>(min_score)));
}

double overlap(const cv::Rect2f& a, const cv::Rect2f& b) {
  const double width = std::min(double{a.x} + a.width, double{b.x} + b.width) - std::max(a.x, b.x);
  const double height = std::min(double{a.y} + a.height, double{b.y} + b.height) - std::max(a.y, b.y);
  const double shared = std::max(0.0, width) * std::max(0.0, height);
  const double both = double{a.width} * a.height + double{b.width} * b.height - shared;
  return both > 0.0 ? shared / both : 0.0;
}

void suppress_duplicates(std::vector<Detection>& objects, double max_overlap, std::size_t most) {
  std::vector<Detection> kept;
  for (Detection& object : objects) {
    if (kept.size() == most) break;
    const bool is_duplicate =
        max_overlap < 1.0 && std::any_of(kept.begin(), kept.end(), [&](const Detection& better) {
          return better.class_number == object.class_number && overlap(better.box, object.box) > max_overlap;
        });
    if (!is_duplicate) kept.push_back(std::move(object));
  }
  objects = std::move(kept);
}

}  // namespace holdfast
