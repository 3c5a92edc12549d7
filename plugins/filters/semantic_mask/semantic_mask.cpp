// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <optional>

#include "holdfast/core/cell_mask.hpp"
#include "holdfast/core/error.hpp"
#include "holdfast/interfaces/dynamic_filter.hpp"
#include "holdfast/plugin/did_you_mean.hpp"
#include "holdfast/plugin/plugin.hpp"
#include "holdfast/settings/semantic_mask.hpp"

namespace holdfast {

void SemanticMaskSettings::describe(ParameterTable<SemanticMaskSettings>& table) {
  using S = SemanticMaskSettings;
  table.add("classes", &S::classes,
            "names of the segmenter's movable classes; empty = as the segmenter specifies, or `person` if it does not");
  table
      .add(
          "movable", &S::movable,
          "how much some classes move, such as { chair: 0.3 }: 1 as those of `classes`, 0 as the background; the prior "
          "between is interpolated, without `dilate` and `edge`; takes precedence over `classes`")
      .range(0, 1);
  table
      .add("dilate", &S::dilate, "features within this distance of a mask belong to it unless their depth is behind it")
      .range(0, 40)
      .unit("px");
  table.add("edge", &S::edge, "features within this distance of a mask belong to it for any depth")
      .range(0, 40)
      .unit("px");
  table.add("depth_margin", &S::depth_margin, "depth difference from which on a feature is behind the adjacent mask")
      .range(0, 10)
      .unit("m");
  table.add("movable_log_odds", &S::movable_log_odds, "prior of a feature on a mask, times the confidence of the mask")
      .range(-20, 0);
  table
      .add("background_log_odds", &S::background_log_odds,
           "prior of all other features, times the confidence of the mask")
      .range(0, 20);
}

namespace {

/// A segmentation as a raster of pixels; without confidences labels are certain, and without depth nothing is known of
/// it.
struct PixelLabels {
  const cv::Mat& labels;
  const cv::Mat& confidences;
  const cv::Mat& depths;
  int columns, rows;

  std::uint8_t label(int column, int row) const { return labels.at<std::uint8_t>(row, column); }
  std::uint8_t confidence(int column, int row) const {
    return confidences.empty() ? std::uint8_t{255} : confidences.at<std::uint8_t>(row, column);
  }
  float depth(int column, int row) const { return depths.empty() ? 0.0F : depths.at<float>(row, column); }
};

/// A propagated mask as a raster of cells.
struct CellLabels {
  const CoarseView& view;
  int columns, rows;

  std::size_t index(int column, int row) const { return static_cast<std::size_t>(row * columns + column); }
  std::uint8_t label(int column, int row) const { return view.mask.labels[index(column, row)]; }
  std::uint8_t confidence(int column, int row) const { return view.mask.confidence[index(column, row)]; }
  float depth(int column, int row) const { return view.depth[index(column, row)]; }
};

/// Where labels count for a feature, in steps of the raster.
struct Neighbourhood {
  int reach;                ///< columns and rows on each side
  int edge;                 ///< as far, depth is not asked
  int stride;               ///< between the labels that are looked at
  bool has_movable = true;  ///< false: it is known that none of them is movable
};

/// Adds a negative prior to features on masks of movable classes.
class SemanticMask final : public DynamicFilter {
 public:
  SemanticMask(const SemanticMaskSettings& settings, const CreationContext&) : settings_(settings) {
    for (std::size_t confidence = 0; confidence < movable_log_odds_.size(); ++confidence)
      movable_log_odds_[confidence] =
          static_cast<float>(settings.movable_log_odds * static_cast<double>(confidence) / 255.0);
  }

  Needs needs() const override { return {.segmentation = true}; }
  std::vector<std::string> movable_classes(const std::vector<std::string>& specified) const override {
    std::vector<std::string> names = fully_movable(specified);
    std::erase_if(names, [this](const std::string& name) { return share_of(name).value_or(1.0) < mostly_movable; });
    for (const auto& [name, share] : settings_.movable)
      if (share >= mostly_movable && std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
    return names;
  }
  std::vector<std::string> named_classes() const override {
    std::vector<std::string> names;
    for (const auto& [name, share] : settings_.movable) names.push_back(name);
    return names;
  }

  void apply(const FilterContext& context, StaticEvidence& evidence) override {
    if (context.classes == nullptr) return;
    find_movable(*context.classes, context.movable);
    if (context.segmentation != nullptr && !context.segmentation->empty())
      apply_exact(context, evidence);
    else if (!context.frame.coarse.mask.empty())
      apply_propagated(context.frame, evidence);
    evaluate_cells(context.frame.coarse.mask, evidence);
  }

 private:
  std::vector<std::string> fully_movable(const std::vector<std::string>& specified) const {
    if (!settings_.classes.empty()) return settings_.classes;
    return specified.empty() ? std::vector<std::string>{"person"} : specified;
  }
  /// The configured share of a class that moves seldom.
  std::optional<double> share_of(const std::string& name) const {
    for (const auto& [known, share] : settings_.movable)
      if (known == name) return share;
    return std::nullopt;
  }

  /// Throws InputError for a class that the segmenter does not have.
  void find_movable(const std::vector<std::string>& classes, const std::vector<std::string>* said_by_segmenter) {
    movable_.fill(0);
    seldom_.fill(0);
    static_log_odds_.fill(settings_.background_log_odds);
    const auto label_of = [&](const std::string& name, const char* parameter) {
      const auto found = std::find(classes.begin(), classes.end(), name);
      if (found == classes.end())
        throw InputError({std::string("filters: semantic_mask: ") + parameter},
                         "the segmenter has no class '" + name + "'; " + did_you_mean(name, classes));
      return static_cast<std::size_t>(found - classes.begin());
    };
    for (const std::string& name :
         fully_movable(said_by_segmenter != nullptr ? *said_by_segmenter : std::vector<std::string>()))
      movable_[label_of(name, "classes")] = 1;
    for (const auto& [name, share] : settings_.movable) {
      const std::size_t label = label_of(name, "movable");
      movable_[label] = share >= 1.0 ? 1 : 0;
      seldom_[label] = share >= mostly_movable ? 1 : 0;
      static_log_odds_[label] =
          settings_.background_log_odds + share * (settings_.movable_log_odds - settings_.background_log_odds);
    }
  }

  void add_evidence(StaticEvidence& evidence, std::size_t feature, double log_odds, std::uint8_t confidence) const {
    evidence.add(feature, static_cast<float>(log_odds * confidence / 255.0), StaticEvidence::Kind::prior);
  }

  /// Marks the tiles of an image of labels in which any pixel is movable.
  void mark_movable_tiles(const cv::Mat& labels) {
    tile_columns_ = (labels.cols + tile - 1) / tile;
    movable_tiles_.assign(static_cast<std::size_t>(tile_columns_ * ((labels.rows + tile - 1) / tile)), 0);
    for (int row = 0; row < labels.rows; ++row) {
      const std::uint8_t* const label = labels.ptr<std::uint8_t>(row);
      std::uint8_t* const tiles = &movable_tiles_[static_cast<std::size_t>((row / tile) * tile_columns_)];
      for (int first = 0; first < labels.cols; first += tile) {
        const int last = std::min(first + tile, labels.cols);
        if (tiles[first / tile] == 0) tiles[first / tile] = is_any_movable(label + first, label + last);
      }
    }
  }

  /// Whether any of up to `tile` labels is movable. Most are background, which is recognised as a whole.
  bool is_any_movable(const std::uint8_t* first, const std::uint8_t* last) const {
    static constexpr std::array<std::uint8_t, tile> background{};
    if (movable_[0] == 0 && last - first == tile && std::memcmp(first, background.data(), tile) == 0) return false;
    return std::any_of(first, last, [&](std::uint8_t label) { return movable_[label] != 0; });
  }

  /// Whether a tile within `reach` pixels of a pixel of the image is marked.
  bool is_near_movable_tile(const cv::Mat& labels, int x, int y, int reach) const {
    const int last_column = std::min(x + reach, labels.cols - 1) / tile;
    const int last_row = std::min(y + reach, labels.rows - 1) / tile;
    for (int row = std::max(0, y - reach) / tile; row <= last_row; ++row)
      for (int column = std::max(0, x - reach) / tile; column <= last_column; ++column)
        if (movable_tiles_[static_cast<std::size_t>(row * tile_columns_ + column)] != 0) return true;
    return false;
  }

  /// Gives a feature at a position of a raster of labels, pixels or cells, the prior of its class. It is movable if a
  /// movable label within `reach` is not in front of it; within `edge`, depth is not asked. Raster has columns, rows,
  /// and label(), confidence() and depth() of a column and a row.
  template <class Raster>
  void judge(const Raster& raster, int x, int y, const Neighbourhood& near, float depth, std::size_t feature,
             StaticEvidence& evidence) const {
    const std::uint8_t label = raster.label(x, y);
    bool movable = movable_[label] != 0;
    std::uint8_t certainty = raster.confidence(x, y);
    for (int dy = -near.reach; dy <= near.reach && !movable && near.has_movable; dy += near.stride)
      for (int dx = -near.reach; dx <= near.reach && !movable; dx += near.stride) {
        const int column = x + dx, row = y + dy;
        if (column < 0 || row < 0 || column >= raster.columns || row >= raster.rows) continue;
        if (movable_[raster.label(column, row)] == 0) continue;
        if (std::max(std::abs(dx), std::abs(dy)) > near.edge && lies_behind(depth, raster.depth(column, row))) continue;
        movable = true;
        certainty = raster.confidence(column, row);
      }
    if (movable || label != CellMask::unknown)
      add_evidence(evidence, feature, movable ? settings_.movable_log_odds : static_log_odds_[label], certainty);
  }

  void apply_exact(const FilterContext& context, StaticEvidence& evidence) {
    const PixelLabels raster{context.segmentation->labels, context.segmentation->confidence, context.sensor_frame.depth,
                             context.segmentation->labels.cols, context.segmentation->labels.rows};
    mark_movable_tiles(raster.labels);
    const Frame& frame = context.frame;
    for (std::size_t i = 0; i < frame.size(); ++i) {
      const int x = static_cast<int>(std::lround(frame.features.x[i]));
      const int y = static_cast<int>(std::lround(frame.features.y[i]));
      if (x < 0 || y < 0 || x >= raster.columns || y >= raster.rows) continue;
      const Neighbourhood near{settings_.dilate, settings_.edge, 2,
                               is_near_movable_tile(raster.labels, x, y, settings_.dilate)};
      judge(raster, x, y, near, frame.depth[i], i, evidence);
    }
  }

  /// Marks the cells within `reach` columns and rows of a movable one.
  void mark_near_movable(const CellMask& mask, const CoarseGrid& grid, int reach) {
    const int columns = grid.columns, rows = grid.rows;
    const auto row_of = [columns](std::vector<std::uint8_t>& cells, int row) {
      return cells.data() + static_cast<std::ptrdiff_t>(row) * columns;
    };
    movable_cells_.resize(mask.labels.size());
    for (std::size_t cell = 0; cell < mask.labels.size(); ++cell) movable_cells_[cell] = movable_[mask.labels[cell]];
    beside_movable_ = movable_cells_;
    for (int row = 0; row < rows; ++row) {
      const std::uint8_t* from = row_of(movable_cells_, row);
      std::uint8_t* to = row_of(beside_movable_, row);
      for (int shift = 1; shift <= std::min(reach, columns - 1); ++shift) {
        for (int column = shift; column < columns; ++column) to[column] |= from[column - shift];
        for (int column = shift; column < columns; ++column) to[column - shift] |= from[column];
      }
    }
    near_movable_ = beside_movable_;
    for (int row = 0; row < rows; ++row)
      for (int other = std::max(0, row - reach); other <= std::min(rows - 1, row + reach); ++other) {
        const std::uint8_t* from = row_of(beside_movable_, other);
        std::uint8_t* to = row_of(near_movable_, row);
        for (int column = 0; column < columns; ++column) to[column] |= from[column];
      }
  }

  void apply_propagated(const Frame& frame, StaticEvidence& evidence) {
    const CellLabels raster{frame.coarse, frame.coarse.grid.columns, frame.coarse.grid.rows};
    const CoarseGrid& grid = frame.coarse.grid;
    const auto cells = [](int pixels) { return (pixels + CoarseGrid::step / 2) / CoarseGrid::step; };
    Neighbourhood near{cells(settings_.dilate), cells(settings_.edge), 1};
    mark_near_movable(frame.coarse.mask, grid, near.reach);
    for (std::size_t i = 0; i < frame.size(); ++i) {
      const int column = grid.column_of(frame.x[i]), row = grid.row_of(frame.y[i]);
      if (column < 0 || row < 0 || column >= grid.columns || row >= grid.rows) continue;
      near.has_movable = near_movable_[raster.index(column, row)] != 0;
      judge(raster, column, row, near, frame.depth[i], i, evidence);
    }
  }

  void evaluate_cells(const CellMask& mask, StaticEvidence& evidence) const {
    for (std::size_t cell = 0; cell < mask.labels.size() && cell < evidence.cells().size(); ++cell)
      if (const std::uint8_t label = mask.labels[cell]; movable_[label] != 0)
        evidence.add_cell(cell, movable_log_odds_[mask.confidence[cell]]);
      else if (seldom_[label] != 0)
        evidence.add_cell(cell, static_cast<float>(static_log_odds_[label] * mask.confidence[cell] / 255.0));
  }

  bool lies_behind(float depth, float mask_depth) const {
    return depth > 0.0F && mask_depth > 0.0F && depth > mask_depth + static_cast<float>(settings_.depth_margin);
  }

  static constexpr int tile = 16;                // pixels
  static constexpr double mostly_movable = 0.5;  // share of a class from which on its surface is evidence of motion
  SemanticMaskSettings settings_;
  std::array<std::uint8_t, 256> movable_{};    // by label: share 1
  std::array<std::uint8_t, 256> seldom_{};     // by label: share below 1, and mostly movable
  std::array<double, 256> static_log_odds_{};  // by label, of what is not movable_
  std::vector<std::uint8_t> movable_tiles_;    // row by row
  int tile_columns_ = 0;
  std::array<float, 256> movable_log_odds_{};                                // by confidence
  std::vector<std::uint8_t> movable_cells_, beside_movable_, near_movable_;  // 1 = yes, by cell
};

}  // namespace

}  // namespace holdfast

HOLDFAST_PLUGIN(semantic_mask, registry) {
  registry.add<holdfast::DynamicFilter, holdfast::SemanticMask, holdfast::SemanticMaskSettings>(
      {.name = holdfast::SemanticMaskSettings::module,
       .summary = "Prior against features of movable classes, which measurements can outweigh.",
       .paper =
           "Zeng et al.: A Semantics-Guided Visual SLAM with U-Net for Complex Dynamic Indoor Environments. Remote "
           "Sensing 15, 5479, 2023, section 3.2"});
}
