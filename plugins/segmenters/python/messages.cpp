// SPDX-License-Identifier: BSD-3-Clause
#include "messages.hpp"

#include <poll.h>
#include <sys/socket.h>

#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstring>

#include "holdfast/core/error.hpp"

namespace holdfast::python_plugin {

namespace {

using Clock = std::chrono::steady_clock;

Arrival receive(int socket, const Clock::time_point* end, char* to, std::size_t size) {
  while (size > 0) {
    int wait = -1;
    if (end != nullptr) {
      const double left = std::chrono::duration<double, std::milli>(*end - Clock::now()).count();
      wait = static_cast<int>(std::ceil(std::max(0.0, left)));
    }
    pollfd waiting = {socket, POLLIN, 0};
    const int ready = poll(&waiting, 1, wait);
    if (ready < 0 && errno == EINTR) continue;
    if (ready == 0) return Arrival::late;
    const ssize_t count = recv(socket, to, size, 0);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return Arrival::closed;
    to += count, size -= static_cast<std::size_t>(count);
  }
  return Arrival::arrived;
}

}  // namespace

void MessageWriter::number(std::int64_t value) { bytes_.append(reinterpret_cast<const char*>(&value), sizeof(value)); }
void MessageWriter::real(double value) { bytes_.append(reinterpret_cast<const char*>(&value), sizeof(value)); }

void MessageWriter::text(const std::string& text) {
  number(static_cast<std::int64_t>(text.size()));
  bytes_ += text;
}

void MessageWriter::image(const cv::Mat& image) {
  number(image.rows), number(image.cols), number(image.type());
  for (int y = 0; y < image.rows; ++y)
    bytes_.append(image.ptr<char>(y), static_cast<std::size_t>(image.cols) * image.elemSize());
}

void MessageReader::take(void* to, std::size_t size) {
  if (size > bytes_.size() - at_) throw Error("a message of the process of the segmenter 'python' is cut off");
  std::memcpy(to, bytes_.data() + at_, size);
  at_ += size;
}

std::int64_t MessageReader::number() {
  std::int64_t value = 0;
  take(&value, sizeof(value));
  return value;
}

double MessageReader::real() {
  double value = 0.0;
  take(&value, sizeof(value));
  return value;
}

std::string MessageReader::text() {
  std::string text(std::min(static_cast<std::size_t>(number()), bytes_.size()), '\0');
  take(text.data(), text.size());
  return text;
}

cv::Mat MessageReader::image() {
  const auto rows = static_cast<int>(number()), columns = static_cast<int>(number()), type = static_cast<int>(number());
  if (rows <= 0 || columns <= 0) return {};
  cv::Mat image(rows, columns, type);
  take(image.data, image.total() * image.elemSize());
  return image;
}

bool send_message(int socket, const std::string& bytes) {
  const std::uint64_t size = bytes.size();
  const std::string all = std::string(reinterpret_cast<const char*>(&size), sizeof(size)) + bytes;
  for (std::size_t sent = 0; sent < all.size();) {
    const ssize_t count = send(socket, all.data() + sent, all.size() - sent, MSG_NOSIGNAL);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return false;
    sent += static_cast<std::size_t>(count);
  }
  return true;
}

Arrival receive_message(int socket, double seconds, std::string& bytes) {
  const auto end = Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
  const Clock::time_point* limit = seconds > 0.0 ? &end : nullptr;
  std::uint64_t size = 0;
  if (const Arrival arrival = receive(socket, limit, reinterpret_cast<char*>(&size), sizeof(size));
      arrival != Arrival::arrived)
    return arrival;
  bytes.resize(size);
  return receive(socket, limit, bytes.data(), bytes.size());
}

}  // namespace holdfast::python_plugin
