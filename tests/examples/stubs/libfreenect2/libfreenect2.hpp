// SPDX-License-Identifier: BSD-3-Clause
// What examples/cameras/kinect2 uses of libfreenect2, declared so that it can be compiled where the library is not.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace libfreenect2 {

class Frame {
 public:
  enum Type { Color = 1, Ir = 2, Depth = 4 };
  enum Format { BGRX = 4, RGBX = 5 };
  std::size_t width, height, bytes_per_pixel;
  unsigned char* data;
  std::uint32_t timestamp, sequence, status;
  Format format;
  Frame(std::size_t columns, std::size_t rows, std::size_t pixel_bytes, unsigned char* given = nullptr);
  virtual ~Frame();
};

class FrameListener {
 public:
  virtual ~FrameListener();
};

class Freenect2Device {
 public:
  struct ColorCameraParams {
    float fx, fy, cx, cy;
  };
  struct IrCameraParams {
    float fx, fy, cx, cy, k1, k2, k3, p1, p2;
  };
  struct Config {
    float MinDepth, MaxDepth;
    Config();
  };
  virtual ~Freenect2Device();
  virtual ColorCameraParams getColorCameraParams() = 0;
  virtual IrCameraParams getIrCameraParams() = 0;
  virtual void setConfiguration(const Config& config) = 0;
  virtual void setColorFrameListener(FrameListener* listener) = 0;
  virtual void setIrAndDepthFrameListener(FrameListener* listener) = 0;
  virtual bool start() = 0;
  virtual bool stop() = 0;
  virtual bool close() = 0;
};

class Freenect2 {
 public:
  explicit Freenect2(void* usb_context = nullptr);
  virtual ~Freenect2();
  int enumerateDevices();
  std::string getDefaultDeviceSerialNumber();
  Freenect2Device* openDevice(const std::string& serial);
};

}  // namespace libfreenect2
