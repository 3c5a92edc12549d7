// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/config/reference.hpp"

#include <algorithm>
#include <cctype>
#include <map>
#include <nlohmann/json.hpp>

#include "holdfast/plugin/did_you_mean.hpp"

namespace holdfast {

namespace {

/// One entry of the reference: a module, or a plain section.
struct Entry {
  std::string kind;  // "section" for plain ones, "scene" for those of scene files
  bool is_module() const { return kind != "section" && kind != "scene"; }
  ModuleDescription description;
  std::string origin;
  std::vector<Parameter> parameters;
  std::string absence;  // why it cannot be made in this build; empty when it can
};

std::vector<Entry> all_entries(const Registry& registry, const std::vector<SectionDescription>& sections) {
  std::vector<Entry> entries;
  // Of some kinds the build may have left out all modules.
  std::vector<std::string> kinds = registry.kinds();
  kinds.insert(kinds.end(), choice_sections().begin(), choice_sections().end());
  kinds.insert(kinds.end(), {"filters", "observers"});
  std::sort(kinds.begin(), kinds.end());
  kinds.erase(std::unique(kinds.begin(), kinds.end()), kinds.end());
  for (const std::string& kind : kinds) {
    for (const ModuleEntry* module : registry.of_kind(kind))
      entries.push_back({kind, module->description, module->origin, module->parameters,
                         registry.absence(kind, module->description.name)});
    for (const std::string& name : registry.left_out(kind))
      entries.push_back(
          {kind, {.name = name, .summary = "A module of Holdfast."}, "", {}, registry.absence(kind, name)});
  }
  const auto add_section = [&](const std::string& name, const std::string& help, std::vector<Parameter> parameters,
                               const std::string& kind = "section") {
    entries.push_back({kind, {.name = name, .summary = help}, "built in", std::move(parameters), ""});
  };
  std::string cameras;
  for (const std::string& camera : camera_names()) cameras += (cameras.empty() ? "" : ", ") + camera;
  add_section("camera",
              "The camera: one of the names " + cameras +
                  ", or by numbers; auto = the source's own, else the one that the name of its folder says, such as "
                  "rgbd_dataset_freiburg1_xyz or rgbd_bonn_crowd.",
              ParameterTable<CameraSettings>().parameters());
  std::string sensors;
  for (const std::string& sensor : imu_names()) sensors += (sensors.empty() ? "" : ", ") + sensor;
  add_section("imu",
              "The IMU (gyroscope and accelerometer) of the camera: one of the names " + sensors +
                  ", or by numbers. In place of the source's own, if it has one. tracking.inertia says what its "
                  "measurements are used for.",
              ParameterTable<ImuSettings>().parameters());
  const auto add_sections = [&](bool plain) {
    for (const SectionDescription& section : sections)
      if ((section.kind == "section") == plain)
        add_section(section.name, section.help, section.parameters, section.kind);
  };
  add_sections(true);
  add_section("run", "How the pipeline runs.", ParameterTable<RunSettings>().parameters());
  add_sections(false);
  return entries;
}

std::string default_text(const Parameter& parameter) {
  return parameter.is_required ? "required" : to_string(parameter.default_value);
}

std::string range_text(const Parameter& parameter) {
  std::string text = parameter.range_text();
  for (std::size_t i = 0; i < parameter.allowed.size(); ++i) text += (i == 0 ? "" : " | ") + parameter.allowed[i];
  return text;
}

std::string brief_text(const std::vector<Entry>& entries) {
  std::string text, kind;
  for (const Entry& entry : entries) {
    if (entry.kind != kind) text += (kind.empty() ? "" : "\n") + (kind = entry.kind) + ":\n";
    std::string name = "  " + entry.description.name;
    name.resize(std::max<std::size_t>(name.size() + 1, 22), ' ');
    text += name + (entry.absence.empty() ? "" : "[not in this build] ") + entry.description.summary + "\n";
  }
  return text;
}

std::string full_text(const Entry& entry) {
  std::string text = entry.kind + ": " + entry.description.name + "\n  " + entry.description.summary + "\n";
  if (!entry.absence.empty()) text += "  Not in this build: " + entry.absence + "\n";
  if (!entry.description.paper.empty()) text += "  Paper: " + entry.description.paper + "\n";
  if (entry.is_module()) text += "  Licence: " + entry.description.licence + "; " + entry.origin + "\n";
  std::size_t width = 0;
  for (const Parameter& parameter : entry.parameters) width = std::max(width, parameter.name.size());
  for (const Parameter& parameter : entry.parameters) {
    std::string name = parameter.name;
    name.resize(width, ' ');
    text += "    " + name + "  " + to_string(parameter.type) + ", " +
            (parameter.is_required ? "required" : "default " + to_string(parameter.default_value));
    if (!parameter.unit_name.empty()) text += " [" + parameter.unit_name + "]";
    if (const std::string range = range_text(parameter); !range.empty()) text += ", " + range;
    text += "\n    " + std::string(width, ' ') + "  " + parameter.help + "\n";
  }
  return text;
}

std::string escaped(std::string text) {
  for (std::size_t i = 0; (i = text.find('|', i)) != std::string::npos; i += 2) text.insert(i, "\\");
  return text;
}

std::string heading_of(const std::string& kind) {
  return kind == "section" ? "Plain sections" : kind == "scene" ? "Scene files" : "`" + kind + "`";
}

/// How the section of a kind is written; empty for kinds that are not known here.
std::string use_of(const std::string& kind) {
  static const std::map<std::string, std::string> uses{
      {"source", "Where frames come from. One module, required."},
      {"features", "What is found in an image and matched. One module, required."},
      {"matcher", "Which features show the same point. One module; without the section `nearest`."},
      {"optimizer", "What solves for poses and points. One module, required."},
      {"segmenter", "What is where in an image. One module; without the section `none`."},
      {"loop_detector", "Which places look alike. One module; without the section `none`."},
      {"filters", "What belongs to the static world. A list, worked through in order; without the section empty."},
      {"observers", "Who watches the run. A list; without the section empty."},
      {"section",
       "Sections of parameters, without a choice of modules. Each may be left out, but `camera` where the source "
       "knows none."},
      {"scene", "What a scene file says, which the source `simulated` and `holdfast simulate` read."},
  };
  const auto found = uses.find(kind);
  return found == uses.end() ? "" : found->second;
}

/// The name of a heading in links, as hosts of Markdown make it.
std::string anchor_of(const std::string& heading) {
  std::string anchor;
  for (const char c : heading)
    if (c == ' ')
      anchor += '-';
    else if (c != '`' && c != '.')
      anchor += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return anchor;
}

std::string contents(const std::vector<Entry>& entries) {
  std::string text = "| Section | Entries |\n|---|---|", kind;
  for (const Entry& entry : entries) {
    const std::string heading = heading_of(entry.kind);
    const bool begins = entry.kind != kind;
    if (begins) text += (kind.empty() ? "\n| [" : " |\n| [") + heading + "](#" + anchor_of(heading) + ") | ";
    kind = entry.kind;
    // `none` stands under two kinds: its second heading is another one to links.
    const std::string& name = entry.description.name;
    const auto same = [&](const Entry& other) { return other.description.name == name; };
    const auto before = std::count_if(entries.begin(), entries.begin() + (&entry - entries.data()), same);
    text += (begins ? "[`" : ", [`") + name + "`](#" + anchor_of(name) +
            (before > 0 ? "-" + std::to_string(before) : "") + ")";
  }
  return text + " |\n";
}

std::string markdown(const std::vector<Entry>& entries) {
  std::string text, kind;
  for (const Entry& entry : entries) {
    if (entry.kind != kind) {
      kind = entry.kind;
      text += (text.empty() ? "## " : "\n## ") + heading_of(kind) + "\n";
      if (const std::string use = use_of(kind); !use.empty()) text += "\n" + use + "\n";
    }
    text += "\n### `" + entry.description.name + "`\n\n" + entry.description.summary + "\n";
    if (!entry.description.paper.empty()) text += "\nPaper: " + entry.description.paper + "\n";
    if (entry.is_module()) text += "\nLicence: " + entry.description.licence + "\n";
    if (entry.parameters.empty()) continue;
    text += "\n| parameter | type | default | range | unit | meaning |\n|---|---|---|---|---|---|\n";
    for (const Parameter& p : entry.parameters)
      text += "| `" + p.name + "` | " + to_string(p.type) + " | " + escaped(default_text(p)) + " | " +
              escaped(range_text(p)) + " | " + p.unit_name + " | " + escaped(p.help) + " |\n";
  }
  return text;
}

/// Everything, as a page of its own.
std::string markdown_page(const std::vector<Entry>& entries) {
  return "# Configuration reference\n\n"
         "Everything that a configuration can say, made by `holdfast modules --markdown` from the tables that check "
         "it. The\n"
         "rules of how it is said are in `docs/configuration.md`. *Required* means that there is no default.\n\n" +
         contents(entries) + "\n" + markdown(entries);
}

nlohmann::ordered_json to_json(const ParameterValue& value) {
  return std::visit(
      [](const auto& v) -> nlohmann::ordered_json {
        using Value = std::decay_t<decltype(v)>;
        if constexpr (std::is_same_v<Value, TextMap> || std::is_same_v<Value, RealMap>) {
          nlohmann::ordered_json map = nlohmann::ordered_json::object();
          for (const auto& [key, content] : v) map[key] = content;
          return map;
        } else {
          return v;
        }
      },
      value);
}

std::string json(const std::vector<Entry>& entries) {
  nlohmann::ordered_json all = nlohmann::ordered_json::array();
  for (const Entry& entry : entries) {
    nlohmann::ordered_json parameters = nlohmann::ordered_json::array();
    for (const Parameter& p : entry.parameters) {
      nlohmann::ordered_json row = {{"name", p.name}, {"type", to_string(p.type)}, {"required", p.is_required}};
      row["default"] = p.is_required ? nlohmann::ordered_json(nullptr) : to_json(p.default_value);
      row["minimum"] = p.minimum ? nlohmann::ordered_json(*p.minimum) : nlohmann::ordered_json(nullptr);
      row["maximum"] = p.maximum ? nlohmann::ordered_json(*p.maximum) : nlohmann::ordered_json(nullptr);
      row["allowed"] = p.allowed;
      row["unit"] = p.unit_name;
      row["help"] = p.help;
      parameters.push_back(row);
    }
    all.push_back({{"kind", entry.kind},
                   {"name", entry.description.name},
                   {"summary", entry.description.summary},
                   {"paper", entry.description.paper},
                   {"licence", entry.description.licence},
                   {"origin", entry.origin},
                   {"in_this_build", entry.absence.empty()},
                   {"parameters", parameters}});
  }
  return all.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace

std::string reference(const Registry& registry, const std::vector<SectionDescription>& sections,
                      const std::string& name, ReferenceFormat format) {
  std::vector<Entry> entries = all_entries(registry, sections);
  if (!name.empty()) {
    std::vector<std::string> names;
    for (const Entry& entry : entries) {
      names.push_back(entry.description.name);
      names.push_back(entry.kind);
    }
    std::erase_if(entries, [&](const Entry& e) { return e.description.name != name && e.kind != name; });
    if (entries.empty()) {
      std::sort(names.begin(), names.end());
      names.erase(std::unique(names.begin(), names.end()), names.end());
      throw Error("there is no module or section '" + name + "'; " + did_you_mean(name, names));
    }
  }
  if (format == ReferenceFormat::json) return json(entries);
  if (format == ReferenceFormat::markdown) return name.empty() ? markdown_page(entries) : markdown(entries);
  if (name.empty()) return brief_text(entries);
  std::string text;
  for (const Entry& entry : entries) text += (text.empty() ? "" : "\n") + full_text(entry);
  return text;
}

}  // namespace holdfast
