// SPDX-License-Identifier: BSD-3-Clause
#include <atomic>
#include <limits>

#include "bad/faulty.hpp"
#include "holdfast/core/error.hpp"
#include "holdfast/interfaces/dynamic_filter.hpp"

namespace holdfast::bad {

namespace {

std::atomic<int> calls = 0;

/// Distrusts what is near.
class FaultyFilter final : public DynamicFilter {
 public:
  FaultyFilter(std::string fault, const CreationContext&) : fault_(std::move(fault)) {}

  Needs needs() const override {
    return {.depth = fault_ != "hides_its_needs" && (fault_ != "changes_its_needs" || applied_ == 0)};
  }

  void apply(const FilterContext& context, StaticEvidence& evidence) override {
    ++applied_;
    if (fault_ == "starts_anew") evidence.reset(context.frame.size());
    if (fault_ == "names_itself") evidence.begin_stage("itself");
    if (fault_ == "needs_previous" && context.previous == nullptr) __builtin_trap();
    if (fault_ == "needs_depth" && context.sensor_frame.depth.empty()) throw CheckError("no depth");
    for (std::size_t i = 0; i < context.frame.size(); ++i)
      if (context.frame.has_depth(i) && context.frame.depth[i] < 2.0F) evidence.add(i, -1.0F);
    if (context.frame.size() > 0) {
      if (fault_ == "no_number") evidence.add(0, std::numeric_limits<float>::quiet_NaN());
      if (fault_ == "counts_calls") evidence.add(0, static_cast<float>(++calls));
    }
    if (fault_ == "invents_points") evidence.add_point({4000000, 1}, -1.0F);
    if (fault_ == "numbers_from_zero") evidence.add_object({});
    if (fault_ == "writes") const_cast<std::uint8_t*>(context.sensor_frame.colour.data)[0] ^= 255;
    if (fault_ == "cells_without_end" && !evidence.cells().empty())
      evidence.add_cell(0, std::numeric_limits<float>::infinity());
  }

 private:
  std::string fault_;
  int applied_ = 0;
};

}  // namespace

void add_filters(Registry& registry) {
  add_faults<DynamicFilter, FaultyFilter>(
      registry,
      {"sound", "changes_its_needs", "hides_its_needs", "starts_anew", "names_itself", "needs_previous", "needs_depth",
       "no_number", "counts_calls", "invents_points", "numbers_from_zero", "writes", "cells_without_end"});
}

}  // namespace holdfast::bad
