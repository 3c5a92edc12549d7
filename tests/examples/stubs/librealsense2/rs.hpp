// SPDX-License-Identifier: BSD-3-Clause
// What examples/cameras/realsense uses of librealsense 2, declared so that it can be compiled where the library is not.
#pragma once

#include <stdexcept>
#include <string>

enum rs2_stream { RS2_STREAM_DEPTH, RS2_STREAM_COLOR };
enum rs2_format { RS2_FORMAT_Z16, RS2_FORMAT_BGR8 };
enum rs2_distortion { RS2_DISTORTION_NONE, RS2_DISTORTION_BROWN_CONRADY };
struct rs2_intrinsics {
  int width, height;
  float ppx, ppy, fx, fy;
  rs2_distortion model;
  float coeffs[5];
};

namespace rs2 {

class error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

class video_frame {
 public:
  int get_width() const;
  int get_height() const;
  int get_stride_in_bytes() const;
  const void* get_data() const;
  double get_timestamp() const;
  unsigned long long get_frame_number() const;
};
class depth_frame : public video_frame {};

class frameset {
 public:
  video_frame get_color_frame() const;
  depth_frame get_depth_frame() const;
};

class align {
 public:
  explicit align(rs2_stream to);
  frameset process(frameset frames);
};

class depth_sensor {
 public:
  float get_depth_scale() const;
};
class playback {
 public:
  void set_real_time(bool real_time) const;
};
class device {
 public:
  template <class Sensor>
  Sensor first() const {
    return {};
  }
  template <class Kind>
  Kind as() const {
    return {};
  }
};

class video_stream_profile {
 public:
  rs2_intrinsics get_intrinsics() const;
};
class stream_profile {
 public:
  template <class Kind>
  Kind as() const {
    return {};
  }
};
class pipeline_profile {
 public:
  device get_device() const;
  stream_profile get_stream(rs2_stream stream) const;
};

class config {
 public:
  void enable_device(const std::string& serial);
  void enable_device_from_file(const std::string& file, bool repeat_playback);
  void enable_stream(rs2_stream stream, int width, int height, rs2_format format, int rate);
};

class pipeline {
 public:
  pipeline_profile start(const config& settings);
  bool try_wait_for_frames(frameset* frames, unsigned timeout_ms) const;
};

}  // namespace rs2
