// SPDX-License-Identifier: BSD-3-Clause
// A driver of OpenNI 2 with cameras that are not there, so that tests go through the real library: "fake:plain" and
// "fake:unplugged", which goes after its images, register their depth; "fake:unregistered" does not. Image i = 1 ... of
// both streams has values that tell i.
#include <atomic>
#include <chrono>
#include <cstring>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "fake_images.hpp"
#include "openni_driver.hpp"

namespace {

using namespace oni::driver;

constexpr OniVideoMode mode_of(bool is_depth) {
  return {is_depth ? ONI_PIXEL_FORMAT_DEPTH_1_MM : ONI_PIXEL_FORMAT_RGB888, fake_width, fake_height, 30};
}

class FakeStream final : public StreamBase {
 public:
  explicit FakeStream(bool is_depth) : is_depth_(is_depth) {}

  OniStatus start() override {
    is_started = true;
    return ONI_STATUS_OK;
  }
  void stop() override { is_started = false; }

  OniBool isPropertySupported(int property) override {
    return property == ONI_STREAM_PROPERTY_VIDEO_MODE || property == ONI_STREAM_PROPERTY_STRIDE ||
           property == ONI_STREAM_PROPERTY_CROPPING || property == ONI_STREAM_PROPERTY_MIRRORING;
  }
  OniStatus getProperty(int property, void* data, int* size) override {
    const OniVideoMode mode = mode_of(is_depth_);
    const int stride = fake_width * (is_depth_ ? 2 : 3);
    const OniCropping cropping{};
    if (property == ONI_STREAM_PROPERTY_VIDEO_MODE) return give(mode, data, size);
    if (property == ONI_STREAM_PROPERTY_STRIDE) return give(stride, data, size);
    if (property == ONI_STREAM_PROPERTY_CROPPING) return give(cropping, data, size);
    if (property == ONI_STREAM_PROPERTY_MIRRORING) return give(is_mirrored_, data, size);
    return ONI_STATUS_NOT_SUPPORTED;
  }
  OniStatus setProperty(int property, const void* data, int) override {
    if (property != ONI_STREAM_PROPERTY_MIRRORING) return ONI_STATUS_OK;
    std::memcpy(&is_mirrored_, data, sizeof(is_mirrored_));
    return ONI_STATUS_OK;
  }
  void notifyAllProperties() override {
    const OniVideoMode mode = mode_of(is_depth_);
    const int stride = fake_width * (is_depth_ ? 2 : 3);
    const OniCropping cropping{};
    raisePropertyChanged(ONI_STREAM_PROPERTY_VIDEO_MODE, &mode, sizeof(mode));
    raisePropertyChanged(ONI_STREAM_PROPERTY_STRIDE, &stride, sizeof(stride));
    raisePropertyChanged(ONI_STREAM_PROPERTY_CROPPING, &cropping, sizeof(cropping));
    raisePropertyChanged(ONI_STREAM_PROPERTY_MIRRORING, &is_mirrored_, sizeof(is_mirrored_));
  }

  void give_image(int i) {
    OniFrame* frame = getServices().acquireFrame();
    if (frame == nullptr) return;
    frame->frameIndex = i;
    frame->videoMode = mode_of(is_depth_);
    frame->sensorType = is_depth_ ? ONI_SENSOR_DEPTH : ONI_SENSOR_COLOR;
    frame->width = fake_width;
    frame->height = fake_height;
    frame->stride = fake_width * (is_depth_ ? 2 : 3);
    frame->cropOriginX = frame->cropOriginY = 0;
    frame->croppingEnabled = FALSE;
    frame->timestamp = is_depth_ ? fake_depth_time(i) : fake_colour_time(i);
    frame->dataSize = frame->stride * fake_height;
    for (int y = 0; y < fake_height; ++y)
      for (int x = 0; x < fake_width; ++x) {
        const int pixel = y * fake_width + (is_mirrored_ ? fake_width - 1 - x : x);
        if (is_depth_) {
          static_cast<std::uint16_t*>(frame->data)[pixel] = fake_depth(i, x);
        } else {
          const std::uint8_t colour[] = {fake_red(i), 2, static_cast<std::uint8_t>(x)};
          std::memcpy(static_cast<std::uint8_t*>(frame->data) + 3 * pixel, colour, 3);
        }
      }
    raiseNewFrame(frame);
    getServices().releaseFrame(frame);
  }

  std::atomic<bool> is_started = false;

 private:
  template <class Value>
  static OniStatus give(const Value& value, void* data, int* size) {
    if (*size < static_cast<int>(sizeof(value))) return ONI_STATUS_BAD_PARAMETER;
    std::memcpy(data, &value, sizeof(value));
    *size = sizeof(value);
    return ONI_STATUS_OK;
  }

  bool is_depth_;
  OniBool is_mirrored_ = TRUE;
};

class FakeDevice final : public DeviceBase {
 public:
  FakeDevice(bool registers, std::function<void()> at_end) : registers_(registers), at_end_(std::move(at_end)) {
    for (int i = 0; i < 2; ++i) {
      modes_[i] = mode_of(i == 1);
      sensors_[i] = {i == 1 ? ONI_SENSOR_DEPTH : ONI_SENSOR_COLOR, 1, &modes_[i]};
    }
  }
  ~FakeDevice() override { stop(); }

  OniStatus getSensorInfoList(OniSensorInfo** sensors, int* count) override {
    *sensors = sensors_;
    *count = 2;
    return ONI_STATUS_OK;
  }
  StreamBase* createStream(OniSensorType type) override {
    std::unique_ptr<FakeStream>& stream = type == ONI_SENSOR_DEPTH ? depth_ : colour_;
    stream = std::make_unique<FakeStream>(type == ONI_SENSOR_DEPTH);
    if (colour_ && depth_ && !thread_.joinable()) thread_ = std::thread([this] { give_images(); });
    return stream.get();
  }
  void destroyStream(StreamBase* stream) override {
    stop();
    (stream == depth_.get() ? depth_ : colour_).reset();
  }
  OniStatus setProperty(int, const void*, int) override { return ONI_STATUS_OK; }
  OniBool isPropertySupported(int property) override { return property == ONI_DEVICE_PROPERTY_IMAGE_REGISTRATION; }
  OniBool isImageRegistrationModeSupported(OniImageRegistrationMode mode) override {
    return mode == ONI_IMAGE_REGISTRATION_OFF || registers_;
  }

 private:
  void give_images() {
    for (int i = 1; i <= fake_images && !is_over_;) {
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
      if (!colour_->is_started || !depth_->is_started) continue;
      colour_->give_image(i);
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
      depth_->give_image(i);
      ++i;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    if (!is_over_) at_end_();
  }
  void stop() {
    is_over_ = true;
    if (thread_.joinable()) thread_.join();
  }

  bool registers_;
  std::function<void()> at_end_;
  OniVideoMode modes_[2];
  OniSensorInfo sensors_[2];
  std::unique_ptr<FakeStream> colour_, depth_;
  std::atomic<bool> is_over_ = false;
  std::thread thread_;
};

class FakeDriver final : public DriverBase {
 public:
  explicit FakeDriver(OniDriverServices* services) : DriverBase(services) {
    for (const char* uri : {"fake:plain", "fake:unplugged", "fake:unregistered"}) {
      OniDeviceInfo& device = devices_.emplace_back();
      std::strcpy(device.uri, uri);
      std::strcpy(device.vendor, "Nobody");
      std::strcpy(device.name, "Fake");
    }
  }
  OniStatus initialize(DeviceConnectedCallback connected, DeviceDisconnectedCallback disconnected,
                       DeviceStateChangedCallback changed, void* cookie) override {
    const OniStatus status = DriverBase::initialize(connected, disconnected, changed, cookie);
    for (const OniDeviceInfo& device : devices_) deviceConnected(&device);
    return status;
  }
  DeviceBase* deviceOpen(const char* uri, const char*) override {
    const std::string name = uri;
    return new FakeDevice(name != "fake:unregistered", [this, name] {
      if (name == "fake:unplugged") deviceDisconnected(&devices_[1]);
    });
  }
  void deviceClose(DeviceBase* device) override { delete static_cast<FakeDevice*>(device); }
  void shutdown() override {}

 private:
  std::vector<OniDeviceInfo> devices_;
};

}  // namespace

ONI_EXPORT_DRIVER(FakeDriver)
