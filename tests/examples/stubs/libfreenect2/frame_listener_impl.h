// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>

#include "libfreenect2.hpp"

namespace libfreenect2 {

using FrameMap = std::map<Frame::Type, Frame*>;

class SyncMultiFrameListener : public FrameListener {
 public:
  explicit SyncMultiFrameListener(unsigned int frame_types);
  ~SyncMultiFrameListener() override;
  bool waitForNewFrame(FrameMap& frames, int milliseconds);
  void release(FrameMap& frames);
};

}  // namespace libfreenect2
