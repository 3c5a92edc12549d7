// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "scene.hpp"

namespace holdfast::viewer {

/// Serves one page and one WebSocket over HTTP, in a thread of its own. Every request needs the token.
class Server {
 public:
  /// How many browsers are served at the same time; others are refused (503).
  static constexpr int most_browsers = 8;
  /// How many messages per second a browser gets at most, unless it asks for fewer.
  static constexpr double fastest_rate = 30.0;

  /// All are called in the thread of the server.
  struct Handlers {
    /// Called 30 times a second while there is a browser, else five times, before browsers get their updates.
    std::function<void()> tick;
    /// The bytes that a browser lacks, empty = none.
    std::function<std::string(Progress&)> update;
    /// A message of a browser, other than one about the rate. False: it is none that is known, and its connection ends.
    std::function<bool(std::string_view)> command;
    /// The number of browsers has changed, or the largest number of messages per second that one of them wants.
    std::function<void(int count, double rate)> watched;
  };

  /// Throws InputError when the address cannot be listened at.
  Server(const std::string& listen, int port, std::string token, std::string page, Handlers handlers);
  /// Closes all connections and ends the thread.
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  /// Where the page is, with the token.
  const std::string& address() const;

  struct State;  ///< of the source file

 private:
  std::unique_ptr<State> state_;
};

}  // namespace holdfast::viewer
