// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <thread>

#include "holdfast/interfaces/frame_source.hpp"

namespace holdfast {

/// Hands a signal (interrupted()) on to a source that is read in this thread, which may wait for a camera then. The
/// source must live longer.
class SourceInterrupter {
 public:
  explicit SourceInterrupter(FrameSource& source);

 private:
  std::jthread thread_;
};

}  // namespace holdfast
