// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/bench/robustness.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "holdfast/bench/error_text.hpp"
#include "holdfast/bench/tables.hpp"

namespace holdfast {

namespace {

constexpr std::array line_colours = {plot_colour::blue,   plot_colour::vermilion, plot_colour::green,
                                     plot_colour::orange, plot_colour::purple,    plot_colour::sky};

std::vector<std::string> distinct_kinds(const std::vector<RobustnessCurve>& curves) {
  std::vector<std::string> kinds;
  for (const RobustnessCurve& curve : curves)
    if (std::find(kinds.begin(), kinds.end(), curve.kind) == kinds.end()) kinds.push_back(curve.kind);
  return kinds;
}

std::string strength_label(const RobustnessCurve& curve) {
  return curve.kind + (curve.unit.empty() ? "" : " [" + curve.unit + "]");
}

class CurveMaker {
 public:
  CurveMaker(const RunPlan& plan, const Analysis& analysis) : plan_(plan), analysis_(analysis) {
    for (std::size_t a = 0; a < plan.matrix.axes.size(); ++a)
      if (plan.matrix.axes[a].name == perturbation_axis) axis_ = a;
  }

  std::vector<RobustnessCurve> curves() const {
    std::vector<RobustnessCurve> curves;
    if (!axis_) return curves;
    for (const std::string& kind : kinds())
      for (std::size_t first = 0; first < plan_.variants.size(); ++first) {
        if (!is_first_of_its_method(first)) continue;
        RobustnessCurve curve{kind, unit_of_kind(kind), method(first), {}};
        for (std::size_t variant = 0; variant < plan_.variants.size(); ++variant)
          if (is_same_method(first, variant))
            if (const auto strength = strength_of(variant, kind)) curve.points.push_back(point(variant, *strength));
        std::stable_sort(curve.points.begin(), curve.points.end(),
                         [](const auto& a, const auto& b) { return a.strength < b.strength; });
        curves.push_back(std::move(curve));
      }
    return curves;
  }

 private:
  const Axis& axis() const { return plan_.matrix.axes[*axis_]; }
  const AxisValue& value_of(std::size_t variant) const {
    const Variant& of = plan_.variants[variant];
    return axis().values[of.is_external() ? of.perturbation.value_or(0) : of.choices[*axis_]];
  }

  std::vector<std::string> kinds() const {
    std::vector<std::string> kinds;
    for (const AxisValue& value : axis().values)
      if (value.perturbation && std::find(kinds.begin(), kinds.end(), value.perturbation->first) == kinds.end())
        kinds.push_back(value.perturbation->first);
    return kinds;
  }
  std::string unit_of_kind(const std::string& kind) const {
    const auto unit = plan_.perturbation_units.find(kind);
    return unit == plan_.perturbation_units.end() ? "" : unit->second;
  }

  bool is_same_method(std::size_t a, std::size_t b) const {
    if (plan_.variants[a].is_external() || plan_.variants[b].is_external())
      return plan_.variants[a].system == plan_.variants[b].system;
    std::vector<std::size_t> first = plan_.variants[a].choices, second = plan_.variants[b].choices;
    first[*axis_] = second[*axis_] = 0;
    return first == second;
  }
  bool is_first_of_its_method(std::size_t variant) const {
    for (std::size_t other = 0; other < variant; ++other)
      if (is_same_method(variant, other)) return false;
    return true;
  }
  std::string method(std::size_t variant) const {
    if (const auto system = plan_.variants[variant].system) return plan_.matrix.systems[*system].name;
    std::string name;
    for (std::size_t a = 0; a < plan_.matrix.axes.size(); ++a)
      if (a != *axis_)
        name += (name.empty() ? "" : "+") + plan_.matrix.axes[a].values[plan_.variants[variant].choices[a]].name;
    return name.empty() ? "base" : name;
  }
  std::optional<double> strength_of(std::size_t variant, const std::string& kind) const {
    const AxisValue& value = value_of(variant);
    if (value.name == unperturbed) return 0.0;
    if (value.perturbation && value.perturbation->first == kind) return value.perturbation->second;
    return std::nullopt;
  }

  RobustnessPoint point(std::size_t variant, double strength) const {
    RobustnessPoint point;
    point.strength = strength;
    std::vector<double> errors, coverages;
    for (const Cell& cell : analysis_.cells) {
      if (cell.variant != variant) continue;
      errors.push_back(cell.error(Quantity::ate));
      coverages.push_back(cell.coverage.median);
      point.runs += cell.runs.size();
      point.counted += cell.counted;
    }
    point.error = spread_of(errors).median;
    point.coverage = spread_of(coverages).mean;
    return point;
  }

  const RunPlan& plan_;
  const Analysis& analysis_;
  std::optional<std::size_t> axis_;
};

std::string point_text(const RobustnessPoint& point) {
  std::string text = error_text(point.error) + ", " + percent_text(100.0 * point.coverage, 1);
  if (point.counted < point.runs)
    text +=
        ", " + std::to_string(point.runs - point.counted) + " of " + std::to_string(point.runs) + " without a figure";
  return text;
}

}  // namespace

std::vector<RobustnessCurve> robustness_curves(const RunPlan& plan, const Analysis& analysis) {
  return CurveMaker(plan, analysis).curves();
}

ReportTable robustness_table(const std::vector<RobustnessCurve>& curves) {
  const auto text = [](double value) { return std::isfinite(value) ? shortest_text(value) : ""; };
  ReportTable table{
      "", {"perturbation", "unit", "method", "strength", "runs", "counted", "ate_rmse_m", "coverage"}, {}, {}};
  for (const RobustnessCurve& curve : curves)
    for (const RobustnessPoint& point : curve.points)
      table.rows.push_back({curve.kind, curve.unit, curve.method, text(point.strength), std::to_string(point.runs),
                            std::to_string(point.counted), text(point.error), text(point.coverage)});
  return table;
}

std::string robustness_text(const std::vector<RobustnessCurve>& curves) {
  std::string text;
  for (const std::string& kind : distinct_kinds(curves)) {
    ReportTable table{"", {}, {}, {}};
    std::vector<double> strengths;
    for (const RobustnessCurve& curve : curves)
      for (const RobustnessPoint& point : curve.points)
        if (curve.kind == kind && std::find(strengths.begin(), strengths.end(), point.strength) == strengths.end())
          strengths.push_back(point.strength);
    std::sort(strengths.begin(), strengths.end());
    for (const double strength : strengths) table.rows.push_back({shortest_text(strength)});
    for (const RobustnessCurve& curve : curves) {
      if (curve.kind != kind) continue;
      if (table.header.empty()) table.header.push_back(strength_label(curve));
      table.header.push_back(curve.method);
      for (std::size_t i = 0; i < strengths.size(); ++i) {
        const auto point = std::find_if(curve.points.begin(), curve.points.end(),
                                        [&](const auto& each) { return each.strength == strengths[i]; });
        table.rows[i].push_back(point == curve.points.end() ? "" : point_text(*point));
      }
    }
    text += to_markdown(table) + "\n";
  }
  return text;
}

std::vector<RobustnessPlot> robustness_plots(const std::vector<RobustnessCurve>& curves) {
  std::vector<RobustnessPlot> plots;
  for (const std::string& kind : distinct_kinds(curves)) {
    RobustnessPlot error{kind + "_error", {}}, coverage{kind + "_coverage", {}};
    error.plot.y_label = "ATE RMSE [m]";
    coverage.plot.y_label = "coverage [%]";
    std::size_t colour = 0;
    for (const RobustnessCurve& curve : curves) {
      if (curve.kind != kind) continue;
      PlotLine errors, coverages;
      errors.label = coverages.label = curve.method;
      errors.colour = coverages.colour = line_colours[colour++ % line_colours.size()];
      for (const RobustnessPoint& point : curve.points) {
        errors.x.push_back(point.strength);
        coverages.x.push_back(point.strength);
        errors.y.push_back(point.error);
        coverages.y.push_back(100.0 * point.coverage);
        if (std::isfinite(point.error)) error.plot.points.push_back({"", errors.colour, point.strength, point.error});
        if (std::isfinite(point.coverage))
          coverage.plot.points.push_back({"", coverages.colour, point.strength, 100.0 * point.coverage});
      }
      error.plot.lines.push_back(std::move(errors));
      coverage.plot.lines.push_back(std::move(coverages));
      error.plot.x_label = coverage.plot.x_label = strength_label(curve);
    }
    for (RobustnessPlot* each : {&error, &coverage}) {
      each->plot.y_from_zero = true;
      each->plot.width = 460;
      each->plot.height = 300;
      plots.push_back(std::move(*each));
    }
  }
  return plots;
}

}  // namespace holdfast
