// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pybind11/pybind11.h>

#include <memory>
#include <string>

#include "holdfast/core/error.hpp"
#include "holdfast/core/map_snapshot.hpp"
#include "holdfast/interfaces/dynamic_filter.hpp"
#include "holdfast/interfaces/observer.hpp"

namespace holdfast::python {

/// Something of C++ that Python may look at during one call only. Python may keep the view: to use it later is an error
/// of Python, not of memory.
template <class Seen>
class View {
 public:
  explicit View(Seen& seen, const char* name) : seen_(&seen), name_(name) {}
  Seen& get() const {
    if (seen_ == nullptr)
      throw Error(std::string(name_) +
                  ": is valid during the call only that it was given to; copy what is needed later");
    return *seen_;
  }
  void end() { seen_ = nullptr; }

 private:
  Seen* seen_;
  const char* name_;
};

using FeaturesView = View<const Frame>;
using ContextView = View<const FilterContext>;
using EvidenceView = View<StaticEvidence>;
using MapView = View<const ObservedMap>;

/// The snapshot as a holdfast.MapSnapshot. The lock must be held.
pybind11::object shown_snapshot(const MapSnapshot& snapshot);

/// Hands a view to Python and ends it with the call. The lock must be held in its life.
template <class Seen>
class Shown {
 public:
  Shown(Seen& seen, const char* name) : view_(std::make_shared<View<Seen>>(seen, name)) {}
  ~Shown() { view_->end(); }
  Shown(const Shown&) = delete;
  Shown& operator=(const Shown&) = delete;
  const std::shared_ptr<View<Seen>>& view() const { return view_; }

 private:
  std::shared_ptr<View<Seen>> view_;
};

}  // namespace holdfast::python
