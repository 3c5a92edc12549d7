// SPDX-License-Identifier: BSD-3-Clause
// A source of frames for the Kinect 2 (Kinect for Xbox One) by libfreenect2, which Debian does not have. The camera
// gives colour of 1920x1080 and depth of 512x424 by two lenses; libfreenect2 moves the depth to the pixels of the
// colour, and this source makes both smaller, because there is a depth for every fourteenth pixel only.
//
// It is written after the documentation of libfreenect2 0.2 and compiled against its declarations; nobody has run it
// with a camera yet.
#include <libfreenect2/frame_listener_impl.h>
#include <libfreenect2/registration.h>
#include <libfreenect2/libfreenect2.hpp>

#include <cmath>
#include <memory>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <string>

#include "holdfast/core/error.hpp"
#include "holdfast/interfaces/frame_source.hpp"
#include "holdfast/plugin/plugin.hpp"

namespace {

using namespace holdfast;

constexpr int full_width = 1920, full_height = 1080;  // of the colour camera

struct Kinect2Settings {
  std::string serial;
  double scale = 0.5;
  double maximum_depth = 4.5;

  static void describe(ParameterTable<Kinect2Settings>& table) {
    using S = Kinect2Settings;
    table.add("serial", &S::serial, "serial number of the camera; empty = the first one");
    table.add("scale", &S::scale, "size of the images as a share of 1920x1080").range(0.25, 1.0);
    table.add("maximum_depth", &S::maximum_depth, "larger depth is left out").range(0.5, 10.0).unit("m");
  }
};

class Kinect2Source final : public FrameSource {
 public:
  Kinect2Source(const Kinect2Settings& settings, const CreationContext&) : settings_(settings) { open(); }
  ~Kinect2Source() override {
    device_->stop();
    device_->close();
  }

  SourceDescription describe() const override {
    SourceDescription description;
    description.name = place();
    description.has_depth = true;
    description.can_read_ahead = true;  // so that a thread fetches frames while others are tracked
    description.camera = camera_;
    return description;
  }

  // An exception of this function ends the run, and all that was done until then is written.
  std::optional<SensorFrame> next() override {
    if (has_ended_) return std::nullopt;
    for (;;) {
      libfreenect2::FrameMap images;
      constexpr int patience = 5000;  // ms
      if (!listener_.waitForNewFrame(images, patience)) {
        has_ended_ = true;
        throw InputError({place()}, "gave no frame for 5 s; was it unplugged, and is it at a port of USB 3?");
      }
      std::optional<SensorFrame> frame =
          read(*images.at(libfreenect2::Frame::Color), *images.at(libfreenect2::Frame::Depth));
      listener_.release(images);
      if (frame) return frame;
    }
  }
  std::vector<SkippedFrame> skipped() const override { return skipped_; }

 private:
  std::string place() const { return "Kinect 2" + (settings_.serial.empty() ? "" : ' ' + settings_.serial); }

  void open() {
    if (freenect2_.enumerateDevices() == 0)
      throw InputError({place()},
                       "was not found; plug it in at a port of USB 3, with its own power supply, and let the "
                       "user read it (the rules for udev come with libfreenect2)");
    const std::string serial = settings_.serial.empty() ? freenect2_.getDefaultDeviceSerialNumber() : settings_.serial;
    // Depth is computed by the best of what the library was built with: CUDA, OpenCL, OpenGL, or a whole core. The
    // variable LIBFREENECT2_PIPELINE of the environment chooses another.
    device_.reset(freenect2_.openDevice(serial));
    if (device_ == nullptr)
      throw InputError({place()}, "the camera '" + serial + "' cannot be opened; does another program use it?");
    libfreenect2::Freenect2Device::Config limits;
    limits.MaxDepth = static_cast<float>(settings_.maximum_depth);
    device_->setConfiguration(limits);
    device_->setColorFrameListener(&listener_);
    device_->setIrAndDepthFrameListener(&listener_);
    if (!device_->start()) throw InputError({place()}, "does not start; unplug it and plug it in again");

    // What the factory wrote into the camera is known once it runs. Its colour is taken to have no distortion.
    const libfreenect2::Freenect2Device::ColorCameraParams lens = device_->getColorCameraParams();
    registration_ = std::make_unique<libfreenect2::Registration>(device_->getIrCameraParams(), lens);
    const double scale = settings_.scale;
    camera_.name = "kinect2";
    camera_.width = static_cast<int>(std::lround(full_width * scale));
    camera_.height = static_cast<int>(std::lround(full_height * scale));
    camera_.fx = lens.fx * scale;
    camera_.fy = lens.fy * scale;
    // The centre of the first pixel is 0 in both sizes, and its corner the same place.
    camera_.cx = (lens.cx + 0.5) * scale - 0.5;
    camera_.cy = (lens.cy + 0.5) * scale - 0.5;
    camera_.frame_rate = 30.0;
  }

  /// Nothing for images that the camera marks as broken.
  std::optional<SensorFrame> read(libfreenect2::Frame& colour, libfreenect2::Frame& depth) {
    constexpr double tick = 0.125e-3;  // of the camera's clock [s]
    const double timestamp = colour.timestamp * tick;
    count_lost_frames(colour.sequence, timestamp);
    if (colour.status != 0 || depth.status != 0) {
      skipped_.push_back({index_++, timestamp, place() + ": gave a broken image"});
      return std::nullopt;
    }
    registration_->apply(&colour, &depth, &undistorted_, &registered_, /*enable_filter=*/true, &large_depth_);

    SensorFrame frame;
    frame.index = index_++;
    frame.timestamp = timestamp;
    // By the clock of the camera, which begins anew after six days: as a difference of 32 bits that may be negative.
    frame.depth_delay = static_cast<std::int32_t>(depth.timestamp - colour.timestamp) * tick;
    const cv::Size size(camera_.width, camera_.height);
    const cv::Mat four_channels(full_height, full_width, CV_8UC4, colour.data);
    cv::Mat full;
    cv::cvtColor(four_channels, full,
                 colour.format == libfreenect2::Frame::RGBX ? cv::COLOR_RGBA2BGR : cv::COLOR_BGRA2BGR);
    cv::resize(full, frame.colour, size, 0.0, 0.0, cv::INTER_AREA);
    frame.depth = small_depth(size);
    return frame;
  }

  /// Depth in metres at the centres of the smaller pixels. The mean of several would be a depth between two surfaces.
  cv::Mat small_depth(cv::Size size) const {
    // The library adds an empty row above and below.
    const cv::Mat full(full_height, full_width, CV_32FC1, large_depth_.data + sizeof(float) * full_width);
    cv::Mat depth(size, CV_32FC1);
    for (int y = 0; y < size.height; ++y) {
      const float* const row =
          full.ptr<float>(std::min(full_height - 1, (2 * y + 1) * full_height / (2 * size.height)));
      float* const out = depth.ptr<float>(y);
      for (int x = 0; x < size.width; ++x) {
        const float millimetres = row[std::min(full_width - 1, (2 * x + 1) * full_width / (2 * size.width))];
        out[x] = std::isfinite(millimetres) && millimetres > 0.0F ? millimetres * 1e-3F : 0.0F;
      }
    }
    return depth;
  }

  /// Frames that the camera numbered and we did not get are in run.json as skipped frames.
  void count_lost_frames(std::uint32_t number, double stamp) {
    constexpr std::uint32_t most_at_once = 300;  // a longer gap is a camera that paused
    if (last_number_ && number - *last_number_ <= most_at_once)
      for (std::uint32_t lost = *last_number_ + 1; lost < number; ++lost)
        skipped_.push_back({index_++, stamp, place() + ": was not fetched in time"});
    last_number_ = number;
  }

  Kinect2Settings settings_;
  libfreenect2::Freenect2 freenect2_;
  libfreenect2::SyncMultiFrameListener listener_{libfreenect2::Frame::Color | libfreenect2::Frame::Depth};
  std::unique_ptr<libfreenect2::Freenect2Device> device_;
  std::unique_ptr<libfreenect2::Registration> registration_;
  // What the registration writes: the depth without distortion, the colour at its pixels, the depth at those of the
  // colour.
  libfreenect2::Frame undistorted_{512, 424, 4}, registered_{512, 424, 4}, large_depth_{full_width, full_height + 2, 4};
  Camera camera_;
  std::uint64_t index_ = 0;
  std::optional<std::uint32_t> last_number_;
  bool has_ended_ = false;
  std::vector<SkippedFrame> skipped_;
};

}  // namespace

HOLDFAST_PLUGIN(kinect2, registry) {
  registry.add<FrameSource, Kinect2Source, Kinect2Settings>(
      {.name = "kinect2", .summary = "A Kinect 2 by libfreenect2.", .paper = ""});
}
