// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace holdfast {

/// A message over a WebSocket.
struct SocketMessage {
  std::string bytes;
  bool is_text = false;
};

/// One connection of a SocketServer, whose thread calls all functions. Destroyed when the connection ends.
class SocketClient {
 public:
  virtual ~SocketClient() = default;
  /// The message that the client lacks; nothing if there is none now. At most one is on its way to a client.
  virtual std::optional<SocketMessage> next() = 0;
  /// Takes a message of the client. False if it is not a known one: the connection ends.
  virtual bool receive(std::string_view message, bool is_text) = 0;
};

/// 128 random bits as hexadecimal digits, not of the run's seed. Throws Error if the system gives no random numbers.
std::string random_token();

/// Serves one page (optional) and one WebSocket over HTTP, in a thread of its own. Every request needs the token in its
/// query ("?token=..."); others get 403.
class SocketServer {
 public:
  /// Number of connections that are served at the same time; others are refused (503).
  static constexpr int max_clients = 8;

  /// Where the server listens, and what it serves.
  struct Options {
    std::string name;               ///< of the thread, and the place of errors
    std::string scheme = "http";    ///< of address()
    std::string listen;             ///< numeric address
    int port = 0;                   ///< 0 = any free port
    std::string token = {};         ///< characters of URLs only
    std::string page = {};          ///< HTML, served at "/"; empty = none
    std::string socket_path = "/";  ///< where the WebSocket is
    std::vector<std::string> protocols =
        {};                            ///< subprotocols, of which a client must offer one; empty = none is needed
    std::size_t longest_message = 64;  ///< of a client [bytes]
    /// Asks a client for its next message only after a tick, not also after each message that was sent.
    bool is_paced = false;
  };
  /// All are called in the thread of the server.
  struct Handlers {
    /// Called 30 times a second while there is a client, else five times, before clients are asked for messages.
    std::function<void()> tick;
    /// A client has connected.
    std::function<std::unique_ptr<SocketClient>()> open;
  };

  /// Throws InputError when the address cannot be listened at.
  SocketServer(Options options, Handlers handlers);
  /// Lets each client take what is left, for at most 2 s, closes all connections and ends the thread.
  ~SocketServer();
  SocketServer(const SocketServer&) = delete;
  SocketServer& operator=(const SocketServer&) = delete;

  const std::string& name() const;
  /// "http://127.0.0.1:40123/?token=0f..."
  const std::string& address() const;

  struct State;  ///< of the source file

 private:
  std::unique_ptr<State> state_;
};

/// Names and addresses of the servers of this process, oldest first, to print them. Any thread.
std::vector<std::pair<std::string, std::string>> running_servers();

}  // namespace holdfast
