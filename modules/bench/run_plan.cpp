// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/bench/run_plan.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "cell_configuration.hpp"
#include "holdfast/plugin/did_you_mean.hpp"
#include "missing_data.hpp"

namespace holdfast {

namespace {

class Planner {
 public:
  Planner(Matrix matrix, Registry& registry, const std::vector<SectionDescription>& sections,
          std::vector<Diagnostic>& diagnostics, const std::string& only,
          const std::function<void(const Configuration&)>& try_out)
      : registry_(registry), diagnostics_(diagnostics), only_(only), try_out_(try_out) {
    plan_.matrix = std::move(matrix);
    for (const SectionDescription& section : sections)
      if (section.name == perturbation_axis)
        for (const Parameter& parameter : section.parameters)
          plan_.perturbation_units[parameter.name] = parameter.unit_name;
    configurations_.emplace(plan_.matrix, registry, sections, found_);
  }

  RunPlan plan() {
    make_variants();
    check_axes();
    check_exclusions();
    check_sequence_overrides();
    find_baselines();
    plan_.recordings.resize(matrix().sequences.size());
    for (std::size_t sequence = 0; sequence < matrix().sequences.size(); ++sequence)
      for (std::size_t variant = 0; variant < plan_.variants.size(); ++variant)
        if (!is_excluded(variant, sequence) && is_asked_for(variant, sequence)) add_cell(variant, sequence);
    if (only_.empty() && plan_.runs.empty() && found_.empty() && diagnostics_.empty())
      found_.push_back({{matrix().file.string()}, "every run is excluded; expected at least one"});
    move_each_once(found_, diagnostics_);
    std::vector<Diagnostic> missing;
    move_each_once(plan_.missing, missing);
    plan_.missing = std::move(missing);
    return std::move(plan_);
  }

 private:
  const Matrix& matrix() const { return plan_.matrix; }
  void complain(const SourceLocation& location, const std::string& message) { found_.push_back({location, message}); }

  /// The same mistake shows in many cells.
  static void move_each_once(const std::vector<Diagnostic>& from, std::vector<Diagnostic>& to) {
    for (const Diagnostic& diagnostic : from) {
      const std::string text = diagnostic.to_string();
      if (std::none_of(to.begin(), to.end(), [&](const Diagnostic& other) { return other.to_string() == text; }))
        to.push_back(diagnostic);
    }
  }

  void make_variants() {
    const bool has_configurations = matrix().base || !matrix().axes.empty();
    std::vector<Variant> product(has_configurations ? 1 : 0);
    for (const Axis& axis : matrix().axes) {
      std::vector<Variant> longer;
      for (const Variant& variant : product)
        for (std::size_t i = 0; i < axis.values.size(); ++i) {
          Variant& next = longer.emplace_back(variant);
          next.choices.push_back(i);
          next.name += (next.name.empty() ? "" : "+") + axis.values[i].name;
          next.alone = next.alone || axis.values[i].timing;
        }
      product = std::move(longer);
    }
    if (matrix().axes.empty() && has_configurations)
      product.front().name = std::filesystem::path(matrix().base->text).stem().string();
    for (std::size_t i = 0; i < matrix().systems.size(); ++i) {
      Variant variant;
      variant.name = matrix().systems[i].name;
      variant.system = i;
      variant.alone = matrix().systems[i].timing;
      const Axis* axis = perturbations();
      if (axis == nullptr) product.push_back(variant);
      for (std::size_t value = 0; axis != nullptr && value < axis->values.size(); ++value) {
        Variant& perturbed = product.emplace_back(variant);
        perturbed.perturbation = value;
        if (axis->values[value].name != unperturbed) perturbed.name += "+" + axis->values[value].name;
      }
    }
    for (std::size_t i = 0; i < product.size(); ++i)
      for (std::size_t j = 0; j < i; ++j)
        if (product[i].name == product[j].name && product[i].is_external())
          complain(matrix().systems[*product[i].system].location,
                   "the system '" + product[i].name + "' is named like a variant of the axes; name it otherwise");
    plan_.variants = std::move(product);
  }

  void check_axes() {
    const Axis* with_configurations = nullptr;
    for (const Axis& axis : matrix().axes) {
      const bool names_files = std::any_of(axis.values.begin(), axis.values.end(),
                                           [](const AxisValue& value) { return value.configuration.has_value(); });
      if (names_files && with_configurations != nullptr)
        complain(axis.location, "the axes '" + with_configurations->name + "' and '" + axis.name +
                                    "' both name configurations; expected one of them to");
      if (names_files) with_configurations = &axis;
      for (const AxisValue& value : axis.values)
        for (const KeyValue& change : value.overrides) {
          if (change.key == "run.seed")
            complain(change.location, "seeds are given by `seeds` of the matrix, not by an axis");
          if (change.key == "run.mode" && matrix().mode)
            complain(change.location, "'run.mode' is an axis, and the matrix has `mode` too; remove one of them");
          if (change.key.starts_with("source.") || change.key == "source")
            if (change.key.find('.') == change.key.rfind('.'))
              complain(change.location, "the source is given by `sequences`, not by an axis");
        }
    }
  }

  /// The axis `perturbation`, the only one that external systems have, or nullptr.
  const Axis* perturbations() const {
    for (const Axis& axis : matrix().axes)
      if (axis.name == perturbation_axis) return &axis;
    return nullptr;
  }

  std::vector<std::string> axis_names() const {
    std::vector<std::string> names;
    for (const Axis& axis : matrix().axes) names.push_back(axis.name);
    return names;
  }
  std::vector<std::string> value_names(const Axis& axis) const {
    std::vector<std::string> names;
    for (const AxisValue& value : axis.values) names.push_back(value.name);
    return names;
  }
  /// What an exclusion may say for a key.
  std::vector<std::string> names_of(const std::string& key) const {
    std::vector<std::string> names;
    if (key == "sequence")
      for (const MatrixSequence& sequence : matrix().sequences) names.push_back(sequence.name);
    if (key == "system")
      for (const ExternalSystem& system : matrix().systems) names.push_back(system.name);
    for (const Axis& axis : matrix().axes)
      if (axis.name == key) names = value_names(axis);
    return names;
  }

  void check_name(const PlacedText& name, const std::vector<std::string>& known, const std::string& what) {
    if (std::find(known.begin(), known.end(), name.text) == known.end())
      complain(name.location, "there is no " + what + " '" + name.text + "'; " + did_you_mean(name.text, known));
  }

  void check_exclusions() {
    std::vector<std::string> keys = axis_names();
    keys.insert(keys.end(), {"sequence", "system"});
    for (const Exclusion& exclusion : matrix().exclusions)
      for (const Exclusion::Condition& condition : exclusion.conditions) {
        if (std::find(keys.begin(), keys.end(), condition.key.text) == keys.end()) {
          check_name(condition.key, keys, "axis");
          continue;
        }
        const bool is_axis = condition.key.text != "sequence" && condition.key.text != "system";
        for (const PlacedText& value : condition.values)
          check_name(value, names_of(condition.key.text),
                     is_axis ? "value of the axis '" + condition.key.text + "'" : condition.key.text);
      }
  }

  bool meets(const Exclusion::Condition& condition, const Variant& variant, std::size_t sequence) const {
    const auto is_one = [&](const std::string& name) {
      return std::any_of(condition.values.begin(), condition.values.end(),
                         [&](const PlacedText& value) { return value.text == name; });
    };
    if (condition.key.text == "sequence") return is_one(matrix().sequences[sequence].name);
    if (condition.key.text == "system") return variant.is_external() && is_one(matrix().systems[*variant.system].name);
    if (variant.perturbation && condition.key.text == perturbation_axis)
      return is_one(perturbations()->values[*variant.perturbation].name);
    for (std::size_t i = 0; i < variant.choices.size(); ++i)
      if (matrix().axes[i].name == condition.key.text) return is_one(matrix().axes[i].values[variant.choices[i]].name);
    return false;
  }

  bool is_excluded(std::size_t variant, std::size_t sequence) const {
    return std::any_of(matrix().exclusions.begin(), matrix().exclusions.end(), [&](const Exclusion& exclusion) {
      return !exclusion.conditions.empty() &&
             std::all_of(exclusion.conditions.begin(), exclusion.conditions.end(),
                         [&](const auto& condition) { return meets(condition, plan_.variants[variant], sequence); });
    });
  }

  /// An override below a module that nobody has would never count, and nobody would notice.
  void check_sequence_overrides() {
    const auto& sections = choice_sections();
    for (const MatrixSequence& sequence : matrix().sequences)
      for (const KeyValue& change : sequence.overrides) {
        const std::size_t first = change.key.find('.');
        const std::string section = change.key.substr(0, first);
        if (section == "source" || section == "camera")
          complain(change.location, "write '" + section + "' of the sequence itself, not among its overrides");
        if (first == std::string::npos || std::find(sections.begin(), sections.end(), section) == sections.end())
          continue;
        const std::string module = change.key.substr(first + 1, change.key.find('.', first + 1) - first - 1);
        overridden_modules_.push_back({section, {module, change.location}});
      }
  }

  void find_baselines() {
    std::vector<std::string> names;
    for (const Variant& variant : plan_.variants) names.push_back(variant.name);
    const auto index_of = [&](const PlacedText& name) -> std::optional<std::size_t> {
      check_name(name, names, "variant");
      const auto found = std::find(names.begin(), names.end(), name.text);
      return found == names.end() ? std::nullopt
                                  : std::optional(static_cast<std::size_t>(std::distance(names.begin(), found)));
    };
    if (matrix().baseline_is_variant) {
      if (const auto baseline = index_of(matrix().baseline.front()))
        for (std::size_t i = 0; i < plan_.variants.size(); ++i)
          if (i != *baseline) plan_.variants[i].baseline = baseline;
    } else {
      find_baselines_by_axes();
    }
    for (std::size_t i = 0; i < plan_.variants.size(); ++i)
      if (plan_.variants[i].baseline) plan_.comparisons.emplace_back(*plan_.variants[i].baseline, i);
    for (const auto& [before, after] : matrix().comparisons) {
      const auto first = index_of(before), second = index_of(after);
      if (first && second && first == second)
        complain(after.location, "'" + after.text + "' is compared with itself");
      else if (first && second)
        plan_.comparisons.emplace_back(*first, *second);
    }
    for (const auto& [variant, column] : matrix().analysis.columns) index_of(variant);
  }

  /// `baseline: { axis: value }`: a variant is measured against the one with these values and otherwise its own.
  void find_baselines_by_axes() {
    std::vector<std::pair<std::size_t, std::size_t>> fixed;
    const std::vector<std::string> axes = axis_names();
    for (std::size_t i = 0; i < matrix().baseline.size(); ++i) {
      const PlacedText axis{matrix().baseline_axes[i], matrix().baseline[i].location};
      check_name(axis, axes, "axis");
      for (std::size_t a = 0; a < axes.size(); ++a) {
        if (axes[a] != axis.text) continue;
        const auto values = value_names(matrix().axes[a]);
        check_name(matrix().baseline[i], values, "value of the axis '" + axis.text + "'");
        const auto value = std::find(values.begin(), values.end(), matrix().baseline[i].text);
        if (value != values.end()) fixed.emplace_back(a, static_cast<std::size_t>(value - values.begin()));
      }
    }
    if (fixed.empty()) return;
    find_unperturbed_systems(fixed);
    for (std::size_t i = 0; i < plan_.variants.size(); ++i) {
      if (plan_.variants[i].is_external()) continue;
      std::vector<std::size_t> choices = plan_.variants[i].choices;
      for (const auto& [axis, value] : fixed) choices[axis] = value;
      for (std::size_t j = 0; j < plan_.variants.size(); ++j)
        if (j != i && plan_.variants[j].choices == choices && !plan_.variants[j].is_external())
          plan_.variants[i].baseline = j;
    }
  }

  /// `baseline: { perturbation: none }` is one of external systems, too.
  void find_unperturbed_systems(const std::vector<std::pair<std::size_t, std::size_t>>& fixed) {
    if (fixed.size() != 1 || &matrix().axes[fixed.front().first] != perturbations()) return;
    for (Variant& variant : plan_.variants)
      for (std::size_t j = 0; j < plan_.variants.size(); ++j)
        if (variant.is_external() && plan_.variants[j].system == variant.system && &plan_.variants[j] != &variant &&
            plan_.variants[j].perturbation == fixed.front().second)
          variant.baseline = j;
  }

  bool is_asked_for(std::size_t variant, std::size_t sequence) const {
    return only_.empty() ||
           only_.starts_with(plan_.variants[variant].name + "/" + matrix().sequences[sequence].name + "/");
  }

  void add_cell(std::size_t variant, std::size_t sequence) {
    if (plan_.variants[variant].is_external())
      add_external_cell(variant, sequence);
    else
      add_own_cell(variant, sequence);
  }

  PlannedRun run_of(std::size_t variant, std::size_t sequence, const std::string& name) const {
    PlannedRun run;
    run.variant = variant;
    run.sequence = sequence;
    run.id = plan_.variants[variant].name + "/" + matrix().sequences[sequence].name + "/" + name;
    run.alone = matrix().timing || plan_.variants[variant].alone;
    run.time_limit = matrix().time_limit;
    return run;
  }

  void add_own_cell(std::size_t variant, std::size_t sequence) {
    std::vector<const AxisValue*> values;
    for (std::size_t i = 0; i < matrix().axes.size(); ++i)
      values.push_back(&matrix().axes[i].values[plan_.variants[variant].choices[i]]);
    const MatrixSequence& on = matrix().sequences[sequence];
    std::optional<Configuration> configuration = configurations_->build(values, on);
    check_overridden_modules();
    if (!configuration) return;
    check_camera(on, *configuration);
    if (const auto missing = missing_data(on, *configuration, registry_))
      plan_.missing.push_back(*missing);
    else
      try_out(*configuration);
    for (const std::uint64_t seed : matrix().seeds)
      for (int repeat = 1; repeat <= matrix().repeats; ++repeat) {
        PlannedRun run = run_of(variant, sequence, "seed" + std::to_string(seed) + "-repeat" + std::to_string(repeat));
        run.seed = seed;
        run.repeat = repeat;
        configuration->run.seed = seed;
        run.request = to_yaml(*configuration);
        plan_.runs.push_back(std::move(run));
      }
  }

  /// Makes the modules once for each segmenter with its filters.
  void try_out(const Configuration& configuration) {
    if (!try_out_ || !only_.empty() || configuration.filters.empty() || configuration.segmenter.name == "none") return;
    std::vector<ModuleChoice> modules = configuration.filters;
    modules.push_back(configuration.segmenter);
    const auto are_same = [](const ModuleChoice& a, const ModuleChoice& b) {
      return a.name == b.name && a.values == b.values;
    };
    for (const std::vector<ModuleChoice>& others : tried_out_)
      if (std::equal(modules.begin(), modules.end(), others.begin(), others.end(), are_same)) return;
    tried_out_.push_back(std::move(modules));
    try {
      try_out_(configuration);
    } catch (const ConfigurationError& error) {
      found_.insert(found_.end(), error.diagnostics().begin(), error.diagnostics().end());
    } catch (const Error& error) {
      plan_.missing.push_back({{}, error.what()});
    }
  }

  /// Asked after a configuration was built: its plugins may have brought the module.
  void check_overridden_modules() {
    for (const auto& [section, module] : overridden_modules_)
      check_name(module, registry_.names(section), section + " module");
    overridden_modules_.clear();
  }

  void add_external_cell(std::size_t variant, std::size_t sequence) {
    const ExternalSystem& system = matrix().systems[*plan_.variants[variant].system];
    std::vector<std::string> texts = system.command;
    texts.insert(texts.end(), {system.folder, system.trajectory});
    for (const auto& [name, value] : system.environment) texts.push_back(value);
    for (const std::string& text : texts)
      if (const auto unknown = unknown_placeholder(text))
        complain(system.location, "system '" + system.name + "' has the unknown placeholder {" + *unknown + "}; " +
                                      did_you_mean(*unknown, placeholder_names()));
    if (system.command.empty()) return;
    if (const auto missing = missing_program(system)) plan_.missing.push_back(*missing);
    nlohmann::ordered_json request = {{"command", system.command},
                                      {"folder", system.folder},
                                      {"environment", system.environment},
                                      {"trajectory", system.trajectory}};
    const std::optional<std::size_t> copy = copy_for(plan_.variants[variant], sequence);
    if (copy) {
      request["settings"] = system.settings;
      request["copy"] = plan_.copies[*copy].configuration;
    } else if (const std::optional<RecordedSequence>& recording = recording_of(plan_.variants[variant], sequence)) {
      request["sequence"] = recording->folder.string();
      request["settings"] = orb_slam2_settings(*recording, system.settings);
      request["associations"] = associations_text(*recording);
      if (!recording->truth.is_identity()) request["truth"] = recording->truth.frame();
    }
    const int repeats = system.repeats.value_or(matrix().repeats * static_cast<int>(matrix().seeds.size()));
    for (int repeat = 1; repeat <= repeats; ++repeat) {
      PlannedRun run = run_of(variant, sequence, "repeat" + std::to_string(repeat));
      run.repeat = repeat;
      run.copy = copy;
      run.time_limit = system.time_limit.value_or(matrix().time_limit);
      run.request = request.dump(1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
      plan_.runs.push_back(std::move(run));
    }
  }

  /// What the axis `perturbation` adds to a system's frames; nullptr when nothing.
  const AxisValue* perturbation_of(const Variant& variant) const {
    if (!variant.perturbation) return nullptr;
    const AxisValue& value = perturbations()->values[*variant.perturbation];
    return value.overrides.empty() && !value.configuration ? nullptr : &value;
  }

  /// A recording in TUM layout does not know its camera; other sources are asked when a run opens them.
  void check_camera(const MatrixSequence& sequence, const Configuration& configuration) {
    if (!configuration.unknown_camera || configuration.camera || !has_tum_layout(sequence)) return;
    complain(configuration.unknown_camera->location, configuration.unknown_camera->message);
  }

  static bool has_tum_layout(const MatrixSequence& sequence) { return sequence.source.find("tum") != nullptr; }

  /// Of frames that a system gets as they were recorded.
  const std::optional<RecordedSequence>& recording_of(const Variant& variant, std::size_t sequence) {
    static const std::optional<RecordedSequence> nothing;
    const MatrixSequence& on = matrix().sequences[sequence];
    if (perturbation_of(variant) != nullptr || !has_tum_layout(on)) return nothing;
    std::optional<RecordedSequence>& recording = plan_.recordings[sequence];
    if (!recording) {
      const auto configuration = configurations_->build_recording(on, nullptr);
      if (configuration) check_camera(on, *configuration);
      recording =
          recorded_sequence(on, registry_, configuration ? configuration->camera : std::nullopt, found_, plan_.missing);
    }
    return recording;
  }

  /// The copy of frames that a system cannot get as they were recorded; nothing when it can, or when something is
  /// wrong.
  std::optional<std::size_t> copy_for(const Variant& variant, std::size_t sequence) {
    const MatrixSequence& on = matrix().sequences[sequence];
    const AxisValue* perturbation = perturbation_of(variant);
    if (perturbation == nullptr && has_tum_layout(on)) return std::nullopt;
    if (on.source.find("kitti") != nullptr || on.source.find("euroc") != nullptr ||
        on.source.find("four_seasons") != nullptr) {
      complain(on.location,
               "sequence '" + on.name +
                   "' has stereo pairs, and external systems get colour and depth; exclude it: { system: " +
                   matrix().systems[*variant.system].name + ", sequence: " + on.name + " }");
      return std::nullopt;
    }
    if (perturbation != nullptr && !is_only_of_frames(*perturbation)) return std::nullopt;
    std::optional<Configuration> configuration = configurations_->build_recording(on, perturbation);
    if (!configuration) return std::nullopt;
    if (const auto missing = missing_data(on, *configuration, registry_)) {
      plan_.missing.push_back(*missing);
      return std::nullopt;
    }
    if (configuration->camera) require_plain_lens(*configuration->camera, on, found_);
    configuration->run.seed = matrix().seeds.front();
    RecordedCopy copy{on.name + "/" + (perturbation == nullptr ? unperturbed : perturbation->name), on.name,
                      to_yaml(*configuration)};
    for (std::size_t i = 0; i < plan_.copies.size(); ++i)
      if (plan_.copies[i].id == copy.id) return i;
    plan_.copies.push_back(std::move(copy));
    return plan_.copies.size() - 1;
  }

  /// Whether a value of the axis changes nothing but frames: an external system has no other parameters of ours.
  bool is_only_of_frames(const AxisValue& value) {
    if (value.configuration) {
      complain(value.configuration->location,
               "'" + value.name +
                   "' of the axis 'perturbation' names a configuration, which external systems do not "
                   "have; exclude it for them: { system: NAME, perturbation: " +
                   value.name + " }");
      return false;
    }
    for (const KeyValue& change : value.overrides)
      if (change.key != perturbation_axis && !change.key.starts_with(std::string(perturbation_axis) + ".")) {
        complain(change.location, "'" + value.name + "' of the axis 'perturbation' sets '" + change.key +
                                      "', which external systems do not have; exclude it for them: { system: NAME, "
                                      "perturbation: " +
                                      value.name + " }");
        return false;
      }
    return true;
  }

  Registry& registry_;
  std::vector<Diagnostic>& diagnostics_;
  const std::string& only_;
  const std::function<void(const Configuration&)>& try_out_;
  std::vector<std::vector<ModuleChoice>> tried_out_;
  std::vector<Diagnostic> found_;
  RunPlan plan_;
  std::optional<CellConfigurations> configurations_;
  std::vector<std::pair<std::string, PlacedText>> overridden_modules_;
};

}  // namespace

RunPlan make_run_plan(Matrix matrix, Registry& registry, const std::vector<SectionDescription>& sections,
                      std::vector<Diagnostic>& diagnostics, const std::string& only,
                      const std::function<void(const Configuration&)>& try_out) {
  return Planner(std::move(matrix), registry, sections, diagnostics, only, try_out).plan();
}

std::string plan_text(const RunPlan& plan) {
  std::string text;
  for (const PlannedRun& run : plan.runs) text += run.id + (run.alone ? "  (alone)" : "") + "\n";
  text += std::to_string(plan.runs.size()) + (plan.runs.size() == 1 ? " run" : " runs") + ": " +
          std::to_string(plan.variants.size()) + " variants, " + std::to_string(plan.matrix.sequences.size()) +
          " sequences, " + std::to_string(plan.matrix.seeds.size()) + " seeds, " + std::to_string(plan.matrix.repeats) +
          " repeats\n";
  if (plan.matrix.repeats > 1 && plan.matrix.mode && plan.matrix.mode->text == "sequential")
    text += "note: in sequential mode repeats of a seed give the same trajectory; they measure time only\n";
  if (!plan.missing.empty()) text += "\nmissing on this machine:\n";
  for (const Diagnostic& diagnostic : plan.missing) text += diagnostic.to_string() + "\n";
  return text;
}

}  // namespace holdfast
