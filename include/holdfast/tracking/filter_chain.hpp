// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "holdfast/core/frame.hpp"
#include "holdfast/interfaces/dynamic_filter.hpp"

namespace holdfast {

/// The dynamic filters of a run, one after the other. Empty, it says nothing and every feature keeps full weight.
class FilterChain {
 public:
  void add(std::string name, std::unique_ptr<DynamicFilter> filter) {
    names_.push_back(std::move(name));
    filters_.push_back(std::move(filter));
  }
  bool empty() const { return filters_.empty(); }
  std::size_t size() const { return filters_.size(); }
  const std::string& name(std::size_t i) const { return names_[i]; }
  const DynamicFilter& filter(std::size_t i) const { return *filters_[i]; }

  /// Collects the evidence of all filters and sets frame.static_probability: 1 where nothing was said, otherwise the
  /// logistic function of the log-odds.
  void apply(const FilterContext& context, Frame& frame);
  const StaticEvidence& evidence() const { return evidence_; }

 private:
  std::vector<std::string> names_;
  std::vector<std::unique_ptr<DynamicFilter>> filters_;
  StaticEvidence evidence_;
};

}  // namespace holdfast
