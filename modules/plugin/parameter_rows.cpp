// SPDX-License-Identifier: BSD-3-Clause
#include <deque>

#include "holdfast/plugin/parameter_table.hpp"

namespace holdfast::detail {

struct ParameterRows::Rows : std::deque<Parameter> {};  // a deque: add() returns references

ParameterRows::ParameterRows() : rows_(std::make_unique<Rows>()) {}
ParameterRows::~ParameterRows() = default;

Parameter& ParameterRows::add(std::string name, ParameterType type, ParameterValue default_value, std::string help) {
  Parameter& parameter = rows_->emplace_back();
  parameter.name = std::move(name);
  parameter.type = type;
  parameter.default_value = std::move(default_value);
  parameter.help = std::move(help);
  return parameter;
}

std::size_t ParameterRows::size() const { return rows_->size(); }

const ParameterValue* ParameterRows::find(const ParameterValues& values, std::size_t row) const {
  const auto found = values.find((*rows_)[row].name);
  return found == values.end() ? nullptr : &found->second;
}

void ParameterRows::set(ParameterValues& values, std::size_t row, ParameterValue value) const {
  values[(*rows_)[row].name] = std::move(value);
}

std::vector<Parameter> ParameterRows::parameters() const { return {rows_->begin(), rows_->end()}; }

}  // namespace holdfast::detail
