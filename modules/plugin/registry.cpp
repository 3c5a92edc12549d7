// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/plugin/registry.hpp"

#include "holdfast/plugin/did_you_mean.hpp"

namespace holdfast {

void Registry::add(ModuleEntry entry) {
  auto& of_this_kind = entries_[entry.kind];
  if (const auto found = of_this_kind.find(entry.description.name); found != of_this_kind.end())
    throw PluginError(entry.kind + " module '" + entry.description.name + "' of " + entry.origin +
                      " cannot be registered: the name is taken by one of " + found->second.origin +
                      "; rename one of them");
  std::string name = entry.description.name;
  of_this_kind.emplace(std::move(name), std::move(entry));
}

const ModuleEntry* Registry::find(const std::string& kind, const std::string& name) const {
  const auto of_this_kind = entries_.find(kind);
  if (of_this_kind == entries_.end()) return nullptr;
  const auto found = of_this_kind->second.find(name);
  return found == of_this_kind->second.end() ? nullptr : &found->second;
}

std::vector<const ModuleEntry*> Registry::of_kind(const std::string& kind) const {
  std::vector<const ModuleEntry*> found;
  if (const auto of_this_kind = entries_.find(kind); of_this_kind != entries_.end())
    for (const auto& [name, entry] : of_this_kind->second) found.push_back(&entry);
  return found;
}

std::vector<std::string> Registry::kinds() const {
  std::vector<std::string> names;
  for (const auto& [kind, entries] : entries_) names.push_back(kind);
  return names;
}

std::vector<std::string> Registry::names(const std::string& kind) const {
  std::vector<std::string> names;
  for (const ModuleEntry* entry : of_kind(kind)) names.push_back(entry->description.name);
  return names;
}

void Registry::add_left_out(const std::string& kind, const std::string& name, const std::string& option) {
  left_out_[kind][name] = option;
}

void Registry::add_unusable(const std::string& kind, const std::string& name, const std::string& reason) {
  unusable_[kind + '/' + name] = reason;
}

std::string Registry::absence(const std::string& kind, const std::string& name) const {
  if (const auto found = unusable_.find(kind + '/' + name); found != unusable_.end()) return found->second;
  const auto of_this_kind = left_out_.find(kind);
  if (of_this_kind == left_out_.end() || find(kind, name) != nullptr) return "";
  const auto found = of_this_kind->second.find(name);
  if (found == of_this_kind->second.end()) return "";
  return "it was left out of this build; configure Holdfast with -D" + found->second + "=ON";
}

std::vector<std::string> Registry::left_out(const std::string& kind) const {
  std::vector<std::string> names;
  if (const auto of_this_kind = left_out_.find(kind); of_this_kind != left_out_.end())
    for (const auto& [name, option] : of_this_kind->second) names.push_back(name);
  return names;
}

std::string Registry::suggestion(const std::string& kind, const std::string& name) const {
  const std::string reason = absence(kind, name);
  return reason.empty() ? did_you_mean(name, names(kind)) : reason;
}

const ModuleEntry& Registry::require(const std::string& kind, const std::string& name) const {
  if (const ModuleEntry* entry = find(kind, name)) return *entry;
  throw PluginError("no " + kind + " module is called '" + name + "'; " + suggestion(kind, name));
}

}  // namespace holdfast
