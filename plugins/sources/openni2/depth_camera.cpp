// SPDX-License-Identifier: BSD-3-Clause
#include "depth_camera.hpp"

#include <OpenNI.h>

#include <atomic>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <set>
#include <utility>
#include <vector>

#include "holdfast/core/error.hpp"
#include "holdfast/core/size_text.hpp"

namespace holdfast::openni2_plugin {

namespace {

constexpr int patience = 5000;  // ms without an image

/// What the library said last, on one line.
std::string reason() {
  std::string text = openni::OpenNI::getExtendedError();
  while (!text.empty() && std::isspace(static_cast<unsigned char>(text.back())) != 0) text.pop_back();
  for (char& c : text)
    if (std::iscntrl(static_cast<unsigned char>(c)) != 0) c = ' ';
  return text.empty() ? "it does not say why" : text;
}

/// Loads the drivers, once for all cameras of the process.
class Library {
 public:
  Library() {
    if (openni::OpenNI::initialize() != openni::STATUS_OK)
      throw InputError({"OpenNI 2"},
                       "the library cannot start: " + reason() + "; are its drivers installed (Debian: libopenni2-0)?");
  }
  ~Library() { openni::OpenNI::shutdown(); }
  Library(const Library&) = delete;
  Library& operator=(const Library&) = delete;
};

/// Whether a device was unplugged, told by threads of the library.
class Watch final : public openni::OpenNI::DeviceDisconnectedListener {
 public:
  explicit Watch(std::string uri) : uri_(std::move(uri)) { openni::OpenNI::addDeviceDisconnectedListener(this); }
  ~Watch() override { openni::OpenNI::removeDeviceDisconnectedListener(this); }
  Watch(const Watch&) = delete;
  Watch& operator=(const Watch&) = delete;

  bool is_unplugged() const { return is_unplugged_; }

 private:
  void onDeviceDisconnected(const openni::DeviceInfo* device) override {
    if (uri_ == device->getUri()) is_unplugged_ = true;
  }

  std::string uri_;
  std::atomic<bool> is_unplugged_ = false;
};

/// Rows of pixels of a frame, after its size was compared with its bytes.
cv::Mat pixels_of(const openni::VideoFrameRef& frame, int type, const std::string& place) {
  const auto width = static_cast<std::size_t>(frame.getWidth()), height = static_cast<std::size_t>(frame.getHeight());
  const auto row = static_cast<std::size_t>(frame.getStrideInBytes()),
             bytes = static_cast<std::size_t>(frame.getDataSize());
  if (frame.getWidth() < 1 || frame.getHeight() < 1 || row < width * CV_ELEM_SIZE(type) || bytes < row * height)
    throw InputError({place}, "gave an image of " + std::to_string(width) + "x" + std::to_string(height) +
                                  " pixels in rows of " + std::to_string(row) + " bytes, " + std::to_string(bytes) +
                                  " bytes in all; the driver is damaged");
  return {frame.getHeight(), frame.getWidth(), type, const_cast<void*>(frame.getData()), row};
}

/// `per_metre`: what the pixel format says.
cv::Mat depth_of(const openni::VideoFrameRef& frame, float per_metre, const std::string& place) {
  const cv::Mat units = pixels_of(frame, CV_16UC1, place);
  cv::Mat depth(units.size(), CV_32FC1);
  for (int y = 0; y < depth.rows; ++y) {
    const auto* from = units.ptr<std::uint16_t>(y);
    auto* to = depth.ptr<float>(y);
    for (int x = 0; x < depth.cols; ++x) to[x] = static_cast<float>(from[x]) / per_metre;
  }
  return depth;
}

cv::Mat colour_of(const openni::VideoFrameRef& frame, const std::string& place) {
  cv::Mat colour;
  switch (frame.getVideoMode().getPixelFormat()) {
    case openni::PIXEL_FORMAT_RGB888:
      cv::cvtColor(pixels_of(frame, CV_8UC3, place), colour, cv::COLOR_RGB2BGR);
      return colour;
    case openni::PIXEL_FORMAT_YUV422:
      cv::cvtColor(pixels_of(frame, CV_8UC2, place), colour, cv::COLOR_YUV2BGR_UYVY);
      return colour;
    case openni::PIXEL_FORMAT_YUYV:
      cv::cvtColor(pixels_of(frame, CV_8UC2, place), colour, cv::COLOR_YUV2BGR_YUYV);
      return colour;
    case openni::PIXEL_FORMAT_GRAY8:
      cv::cvtColor(pixels_of(frame, CV_8UC1, place), colour, cv::COLOR_GRAY2BGR);
      return colour;
    default:
      throw InputError({place}, "gives colour in the pixel format " +
                                    std::to_string(frame.getVideoMode().getPixelFormat()) +
                                    " of OpenNI; expected RGB888, YUV422, YUYV or GRAY8");
  }
}

std::optional<float> units_per_metre(openni::PixelFormat format) {
  if (format == openni::PIXEL_FORMAT_DEPTH_1_MM) return 1000.0F;
  if (format == openni::PIXEL_FORMAT_DEPTH_100_UM) return 10000.0F;
  return std::nullopt;
}

class OpenNiCamera final : public DepthCamera {
 public:
  explicit OpenNiCamera(const DepthCameraRequest& request) : request_(request) {
    open();
    start(openni::SENSOR_COLOR, colour_);
    start(openni::SENSOR_DEPTH, depth_);
    register_depth();
    for (openni::VideoStream* stream : {&colour_, &depth_})
      if (stream->start() != openni::STATUS_OK) fail("does not start: " + reason());
  }
  ~OpenNiCamera() override {
    colour_.stop();
    depth_.stop();
    colour_.destroy();
    depth_.destroy();
    watch_.reset();
    device_.close();
  }
  OpenNiCamera(const OpenNiCamera&) = delete;
  OpenNiCamera& operator=(const OpenNiCamera&) = delete;

  std::optional<StreamImage> next(const std::function<bool()>& stop) override {
    openni::VideoStream* streams[] = {&colour_, &depth_};
    int ready = -1;
    for (int waited = 0; waited < patience; waited += step) {
      if (stop()) return std::nullopt;
      const openni::Status status = openni::OpenNI::waitForAnyStream(streams, 2, &ready, step);
      if (status == openni::STATUS_OK) return read(*streams[ready]);
      if (watch_->is_unplugged()) fail("the camera was unplugged");
      if (status != openni::STATUS_TIME_OUT) fail("gave no image: " + reason());
    }
    fail("gave no image for " + std::to_string(patience / 1000) + " s; unplug it and plug it in again");
  }

 private:
  static constexpr int step = 50;  // ms, after which unplugging and `stop` are looked for

  [[noreturn]] void fail(const std::string& problem) const { throw InputError({place_}, problem); }

  void open() {
    const std::string& uri = request_.device;
    place_ = uri.empty() ? "OpenNI 2" : uri;
    if (uri.ends_with(".oni"))
      fail(
          "is a recording of OpenNI, whose player loses images; expected the URI of a camera. Convert it once, to a "
          "bag for the source 'rosbag', or to images with lists for the source 'tum' (docs/cameras.md). `holdfast "
          "record` records a camera");
    if (device_.open(uri.empty() ? openni::ANY_DEVICE : uri.c_str()) != openni::STATUS_OK)
      fail((uri.empty() ? "no camera was found: " : "cannot be opened: ") + reason() +
           "; plug one in, or set `source.openni2.device`" + present_devices());
    if (uri.empty()) place_ = std::string("camera ") + device_.getDeviceInfo().getName();
    watch_ = std::make_unique<Watch>(device_.getDeviceInfo().getUri());
  }

  static std::string present_devices() {
    openni::Array<openni::DeviceInfo> devices;
    openni::OpenNI::enumerateDevices(&devices);
    std::string text;
    for (int i = 0; i < devices.getSize(); ++i) text += "\n  " + std::string(devices[i].getUri());
    return text.empty() ? "" : "; these are there" + text;
  }

  /// Creates a stream of the size that is wanted.
  void start(openni::SensorType sensor, openni::VideoStream& stream) {
    const char* name = sensor == openni::SENSOR_DEPTH ? "depth" : "colour";
    if (!device_.hasSensor(sensor)) fail(std::string("has no ") + name + "; expected a camera with colour and depth");
    if (stream.create(device_, sensor) != openni::STATUS_OK)
      fail(std::string("its ") + name + " cannot be opened: " + reason());
    choose_mode(sensor, stream, name);
    stream.setMirroringEnabled(false);  // a camera that cannot mirror refuses, and does not
    const openni::VideoMode mode = stream.getVideoMode();
    if (mode.getResolutionX() != request_.width || mode.getResolutionY() != request_.height)
      fail(std::string("its ") + name + " is " + text_of(mode) + ", but the camera is " +
           size_text(request_.width, request_.height) + "; give the camera that it is under `camera:`");
    if (sensor == openni::SENSOR_DEPTH && !units_per_metre(mode.getPixelFormat()))
      fail("gives depth in the pixel format " + std::to_string(mode.getPixelFormat()) +
           " of OpenNI; expected millimetres or tenths of them");
  }

  void choose_mode(openni::SensorType sensor, openni::VideoStream& stream, const char* name) {
    const openni::Array<openni::VideoMode>& modes = device_.getSensorInfo(sensor)->getSupportedVideoModes();
    const openni::VideoMode* best = nullptr;
    std::set<std::string> offered;
    const auto distance = [&](const openni::VideoMode& mode) { return std::abs(mode.getFps() - request_.frame_rate); };
    for (int i = 0; i < modes.getSize(); ++i) {
      const openni::VideoMode& mode = modes[i];
      const bool is_usable = sensor == openni::SENSOR_DEPTH ? units_per_metre(mode.getPixelFormat()).has_value()
                                                            : mode.getPixelFormat() == openni::PIXEL_FORMAT_RGB888;
      if (!is_usable) continue;
      offered.insert(text_of(mode));
      if (mode.getResolutionX() != request_.width || mode.getResolutionY() != request_.height) continue;
      if (best == nullptr || distance(mode) < distance(*best)) best = &mode;
    }
    std::string list;
    for (const std::string& mode : offered) list += (list.empty() ? "" : ", ") + mode;
    if (best == nullptr)
      fail(std::string("its ") + name + " has no size of " + std::to_string(request_.width) + "x" +
           std::to_string(request_.height) + ", which the camera of the configuration has; it has " + list);
    if (stream.setVideoMode(*best) != openni::STATUS_OK)
      fail(std::string("its ") + name + " refuses " + text_of(*best) + ": " + reason());
  }

  static std::string text_of(const openni::VideoMode& mode) {
    return size_text(mode.getResolutionX(), mode.getResolutionY()) + " at " + std::to_string(mode.getFps()) + " Hz";
  }

  void register_depth() {
    if (!request_.registers_depth) return;
    constexpr auto mode = openni::IMAGE_REGISTRATION_DEPTH_TO_COLOR;
    if (!device_.isImageRegistrationModeSupported(mode) || device_.setImageRegistrationMode(mode) != openni::STATUS_OK)
      fail(
          "cannot register its depth to its colour; set `source.openni2.registration: none` if they fit without, as "
          "of cameras that take both with one lens");
  }

  StreamImage read(openni::VideoStream& stream) {
    openni::VideoFrameRef frame;
    if (stream.readFrame(&frame) != openni::STATUS_OK) fail("gave an image that cannot be read: " + reason());
    StreamImage image;
    image.is_depth = &stream == &depth_;
    image.number = static_cast<std::uint64_t>(frame.getFrameIndex());
    image.time = frame.getTimestamp();
    if (image.is_depth) {
      const std::optional<float> units = units_per_metre(frame.getVideoMode().getPixelFormat());
      image.image = depth_of(frame, units.value_or(1000.0F), place_);
    } else {
      image.image = colour_of(frame, place_);
    }
    if (stream.getMirroringEnabled()) cv::flip(image.image, image.image, 1);  // by a camera that always mirrors
    return image;
  }

  Library library_;  // first: all the others need it
  DepthCameraRequest request_;
  std::string place_;
  openni::Device device_;
  std::unique_ptr<Watch> watch_;
  openni::VideoStream colour_, depth_;
};

}  // namespace

std::unique_ptr<DepthCamera> open_depth_camera(const DepthCameraRequest& request) {
  return std::make_unique<OpenNiCamera>(request);
}

}  // namespace holdfast::openni2_plugin
