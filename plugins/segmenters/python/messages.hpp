// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <string>

/// What a program and the process of its Python segmenter say to each other: both are of one build, so that numbers are
/// written as they lie in memory.
namespace holdfast::python_plugin {

enum class Message : std::uint8_t { ready, frame, segmentation, error };

/// Composes a message.
class MessageWriter {
 public:
  explicit MessageWriter(Message kind) { number(static_cast<std::int64_t>(kind)); }
  void number(std::int64_t value);
  void real(double value);
  void text(const std::string& text);
  void image(const cv::Mat& image);  ///< of two dimensions; may be empty
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

/// Reads a message in the order in which it was written. Throws Error for one that ends before.
class MessageReader {
 public:
  explicit MessageReader(std::string bytes) : bytes_(std::move(bytes)), kind_(static_cast<Message>(number())) {}
  Message kind() const { return kind_; }
  std::int64_t number();
  double real();
  std::string text();
  cv::Mat image();

 private:
  void take(void* to, std::size_t size);
  std::string bytes_;
  std::size_t at_ = 0;
  Message kind_;
};

/// How waiting for a message ended.
enum class Arrival { arrived, closed, late };

/// Sends a message over a socket. False if nobody is at its other end.
bool send_message(int socket, const std::string& bytes);
/// Waits for a message, at most `seconds`; 0 = for any time.
Arrival receive_message(int socket, double seconds, std::string& bytes);

}  // namespace holdfast::python_plugin
