// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "holdfast/core/module.hpp"

namespace holdfast::test {

/// An interface of our own, for plugins of the tests.
class Number : public Module {
 public:
  static constexpr const char* kind = "number";
  virtual double number() const = 0;
};

}  // namespace holdfast::test
