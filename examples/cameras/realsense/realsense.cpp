// SPDX-License-Identifier: BSD-3-Clause
// A source of frames for a camera whose library Debian does not have: Intel RealSense by librealsense 2. The source for
// another camera, such as ../kinect2, differs in what is between the two lines of dashes: open it, ask
// for colour and depth of one size, wait for a pair, register the depth to the colour, and give the time of the camera.
//
// It is written after the documentation of librealsense 2.54 and compiled against its declarations; nobody has run it
// with a camera yet.
#include <librealsense2/rs.hpp>
#include <opencv2/core.hpp>
#include <optional>
#include <string>

#include "holdfast/core/error.hpp"
#include "holdfast/interfaces/frame_source.hpp"
#include "holdfast/plugin/plugin.hpp"

namespace {

using namespace holdfast;

struct RealsenseSettings {
  std::string serial;
  std::filesystem::path file;
  int width = 640, height = 480, frame_rate = 30;

  static void describe(ParameterTable<RealsenseSettings>& table) {
    using S = RealsenseSettings;
    table.add("serial", &S::serial, "serial number of the camera; empty = the first one");
    table.add("file", &S::file, "a recording of librealsense (.bag) in the place of a camera");
    table.add("width", &S::width, "of colour and depth").range(160, 1920).unit("px");
    table.add("height", &S::height, "of colour and depth").range(120, 1080).unit("px");
    table.add("frame_rate", &S::frame_rate, "of colour and depth").range(6, 90).unit("Hz");
  }
};

class RealsenseSource final : public FrameSource {
 public:
  RealsenseSource(const RealsenseSettings& settings, const CreationContext&) : settings_(settings) {
    try {
      open();
    } catch (const rs2::error& error) {
      throw InputError({place()}, std::string("cannot be opened: ") + error.what() +
                                      "; is it plugged in, and does `rs-enumerate-devices` know its size and rate?");
    }
  }

  SourceDescription describe() const override {
    SourceDescription description;
    description.name = place();
    description.has_depth = true;
    description.can_read_ahead = true;  // so that a thread fetches frames while others are tracked
    description.camera = camera_;
    return description;
  }

  // An exception of this function ends the run, and all that was done until then is written. The end of a recording is
  // no exception, but an empty frame.
  std::optional<SensorFrame> next() override {
    if (has_ended_) return std::nullopt;
    try {
      return read();
    } catch (const rs2::error& error) {
      has_ended_ = true;
      throw InputError({place()}, std::string("the camera gave no more frames: ") + error.what());
    }
  }
  std::vector<SkippedFrame> skipped() const override { return skipped_; }

 private:
  std::string place() const {
    if (!settings_.file.empty()) return settings_.file.string();
    return "RealSense" + (settings_.serial.empty() ? "" : ' ' + settings_.serial);
  }

  // ------------------------------------------------------------------------------------------------------------------
  void open() {
    rs2::config config;
    if (!settings_.file.empty())
      config.enable_device_from_file(settings_.file.string(), /*repeat_playback=*/false);
    else if (!settings_.serial.empty())
      config.enable_device(settings_.serial);
    const int width = settings_.width, height = settings_.height, rate = settings_.frame_rate;
    config.enable_stream(RS2_STREAM_COLOR, width, height, RS2_FORMAT_BGR8, rate);
    config.enable_stream(RS2_STREAM_DEPTH, width, height, RS2_FORMAT_Z16, rate);
    const rs2::pipeline_profile profile = pipeline_.start(config);
    metres_per_unit_ = profile.get_device().first<rs2::depth_sensor>().get_depth_scale();
    // A recording waits for us; a camera does not.
    if (!settings_.file.empty()) profile.get_device().as<rs2::playback>().set_real_time(false);

    const rs2_intrinsics lens = profile.get_stream(RS2_STREAM_COLOR).as<rs2::video_stream_profile>().get_intrinsics();
    camera_.name = place();
    camera_.width = lens.width;
    camera_.height = lens.height;
    camera_.fx = lens.fx;
    camera_.fy = lens.fy;
    camera_.cx = lens.ppx;
    camera_.cy = lens.ppy;
    camera_.frame_rate = rate;
    const float* k = lens.coeffs;
    const bool is_pinhole = k[0] == 0 && k[1] == 0 && k[2] == 0 && k[3] == 0 && k[4] == 0;
    if (!is_pinhole && lens.model != RS2_DISTORTION_BROWN_CONRADY)
      throw InputError({place()},
                       "its lens has a distortion that is not that of Brown and Conrady; choose another "
                       "size, which the camera may rectify itself");
    if (!is_pinhole) camera_.distortion = {.k1 = k[0], .k2 = k[1], .p1 = k[2], .p2 = k[3], .k3 = k[4]};
  }

  std::optional<SensorFrame> read() {
    rs2::frameset frames;
    constexpr unsigned patience = 5000;  // ms
    if (!pipeline_.try_wait_for_frames(&frames, patience)) {
      has_ended_ = true;
      if (!settings_.file.empty()) return std::nullopt;
      throw InputError({place()}, "gave no frame for 5 s; was it unplugged?");
    }
    const double depth_time = frames.get_depth_frame().get_timestamp();  // [ms], before the alignment makes a new one
    frames = align_to_colour_.process(frames);
    const rs2::video_frame colour = frames.get_color_frame();
    const rs2::depth_frame depth = frames.get_depth_frame();
    count_lost_frames(colour.get_frame_number(), colour.get_timestamp() * 1e-3);

    SensorFrame frame;
    frame.index = index_++;
    frame.timestamp = colour.get_timestamp() * 1e-3;
    frame.depth_delay = (depth_time - colour.get_timestamp()) * 1e-3;
    // Copies, because the library uses its buffers again.
    frame.colour = image_of(colour, CV_8UC3).clone();
    image_of(depth, CV_16UC1).convertTo(frame.depth, CV_32FC1, metres_per_unit_);
    return frame;
  }
  static cv::Mat image_of(const rs2::video_frame& frame, int type) {
    return {frame.get_height(), frame.get_width(), type, const_cast<void*>(frame.get_data()),
            static_cast<std::size_t>(frame.get_stride_in_bytes())};
  }
  // ------------------------------------------------------------------------------------------------------------------

  /// Frames that the camera numbered and we did not get are in run.json as skipped frames.
  void count_lost_frames(unsigned long long number, double stamp) {
    for (std::uint64_t lost = last_number_ == 0 ? number : last_number_ + 1; lost < number; ++lost)
      skipped_.push_back({index_++, stamp, place() + ": was not fetched in time"});
    last_number_ = number;
  }

  RealsenseSettings settings_;
  rs2::pipeline pipeline_;
  rs2::align align_to_colour_{RS2_STREAM_COLOR};
  double metres_per_unit_ = 0.001;
  Camera camera_;
  std::uint64_t index_ = 0, last_number_ = 0;
  bool has_ended_ = false;
  std::vector<SkippedFrame> skipped_;
};

}  // namespace

HOLDFAST_PLUGIN(realsense, registry) {
  registry.add<FrameSource, RealsenseSource, RealsenseSettings>(
      {.name = "realsense", .summary = "A camera of Intel RealSense, or a recording of one.", .paper = ""});
}
