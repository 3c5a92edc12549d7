// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <cstring>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace holdfast::test {

/// A message of the viewer, taken apart as the page does it.
struct ReceivedMessage {
  nlohmann::json json;
  std::string data;

  explicit ReceivedMessage(const std::string& bytes) {
    std::uint32_t length = 0;
    std::memcpy(&length, bytes.data(), sizeof(length));
    json = nlohmann::json::parse(bytes.substr(8, length));
    data = bytes.substr(8 + length);
  }
  bool has(const std::string& name) const { return json.contains("arrays") && json["arrays"].contains(name); }
  template <class T>
  std::vector<T> array(const std::string& name) const {
    if (!has(name)) return {};
    const nlohmann::json& place = json["arrays"][name];
    std::vector<T> values(place[2].get<std::size_t>());
    std::memcpy(values.data(), data.data() + place[1].get<std::size_t>(), values.size() * sizeof(T));
    return values;
  }
};

/// "http://127.0.0.1:40123/?token=0f" in its parts.
struct ViewerAddress {
  std::string host, port, token;

  explicit ViewerAddress(const std::string& address) {
    const std::size_t begin = std::strlen("http://"), colon = address.find(':', begin),
                      slash = address.find('/', colon);
    host = address.substr(begin, colon - begin);
    port = address.substr(colon + 1, slash - colon - 1);
    token = address.substr(address.find('=') + 1);
  }
};

/// What a server answers to these bytes, until it closes the connection.
std::string answer_to(const ViewerAddress& address, const std::string& request);
/// The same for a GET.
std::string answer_to_get(const ViewerAddress& address, const std::string& target);

/// A connection that sends nothing.
class SilentClient {
 public:
  explicit SilentClient(const ViewerAddress& address);
  ~SilentClient();
  SilentClient(SilentClient&&) noexcept;

  /// Whether the server has closed it by now.
  bool is_closed();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// A browser without a screen.
class SocketClient {
 public:
  /// Throws std::exception when it is refused.
  explicit SocketClient(const ViewerAddress& address);
  SocketClient(const ViewerAddress& address, const std::string& target);
  ~SocketClient();
  SocketClient(SocketClient&&) noexcept;

  void send(const std::string& text, bool is_binary = false);
  /// Waits for the next message; nothing when the connection has ended.
  std::optional<ReceivedMessage> receive();
  /// Receives until a message satisfies a condition. Throws when the connection ends.
  template <class Condition>
  ReceivedMessage receive_until(const Condition& condition) {
    for (;;) {
      std::optional<ReceivedMessage> message = receive();
      if (!message) throw std::runtime_error("the connection has ended");
      if (condition(*message)) return *message;
    }
  }
  /// Waits until the server has ended the connection, whatever it sends before.
  bool is_ended() {
    while (receive()) {
    }
    return true;
  }

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace holdfast::test
