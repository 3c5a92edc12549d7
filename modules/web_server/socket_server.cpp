// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/web_server/socket_server.hpp"

#include <fcntl.h>
#include <sys/random.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "holdfast/core/error.hpp"
#include "holdfast/core/thread_name.hpp"

namespace holdfast {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using boost::asio::ip::tcp;

namespace {

constexpr std::size_t longest_request = 8192;  // with its headers [bytes]
constexpr int most_connections = 64;
constexpr auto request_time = std::chrono::seconds(10);
/// Until the next attempt to accept a connection, after the system has refused to, as without a free descriptor.
constexpr auto accept_pause = std::chrono::milliseconds(200);
/// A browser that has not answered for so long is gone.
constexpr auto idle_time = std::chrono::seconds(20);
/// How long the end of a server waits for its clients to take what is left.
constexpr auto closing_time = std::chrono::seconds(2);
constexpr auto tick_watched = std::chrono::milliseconds(33);
constexpr auto tick_alone = std::chrono::milliseconds(200);

/// Compares in a time that does not tell how much of the text is right.
bool is_same_secret(std::string_view given, std::string_view secret) {
  if (given.size() != secret.size()) return false;
  unsigned difference = 0;
  for (std::size_t i = 0; i < secret.size(); ++i) difference |= static_cast<unsigned>(given[i] ^ secret[i]);
  return difference == 0;
}

/// The first of `known` among the comma-separated names that a client offers; empty if there is none.
std::string common_protocol(beast::string_view offered, const std::vector<std::string>& known) {
  http::token_list names(offered);
  for (const std::string& name : known)
    if (names.exists(name)) return name;
  return {};
}

}  // namespace

namespace {

std::mutex servers_mutex;
std::vector<const SocketServer*> servers;  // guarded by servers_mutex

}  // namespace

std::vector<std::pair<std::string, std::string>> running_servers() {
  const std::lock_guard lock(servers_mutex);
  std::vector<std::pair<std::string, std::string>> list;
  for (const SocketServer* server : servers) list.emplace_back(server->name(), server->address());
  return list;
}

std::string random_token() {
  std::array<unsigned char, 16> bytes{};
  std::size_t filled = 0;
  while (filled < bytes.size()) {
    const ssize_t count = getrandom(bytes.data() + filled, bytes.size() - filled, 0);
    if (count < 0 && errno != EINTR) throw Error("a token cannot be made: the system gives no random numbers");
    if (count > 0) filled += static_cast<std::size_t>(count);
  }
  std::string token;
  for (const unsigned char byte : bytes) {
    char digits[3];
    std::snprintf(digits, sizeof(digits), "%02x", byte);
    token += digits;
  }
  return token;
}

class SocketSession;
class RequestSession;

struct SocketServer::State {
  State(Options given, Handlers calls) : options(std::move(given)), handlers(std::move(calls)) {}

  void listen();
  void run();
  void accept();
  void accept_later();
  bool close_oldest_silent();
  void tick();
  void add(const std::shared_ptr<SocketSession>& session);
  void remove(const SocketSession* session);
  void close();

  Options options;
  Handlers handlers;
  std::string address;
  // Before the context, whose end takes the last requests with it.
  std::vector<RequestSession*> silent;  // those that have not shown a token yet, the oldest first
  int connections = 0;
  int socket_sessions = 0;  // with those that are not open yet or no more
  bool is_closing = false;
  asio::io_context io{1};
  tcp::acceptor acceptor{io};
  asio::steady_timer timer{io}, accept_timer{io}, closing_timer{io};
  std::vector<std::shared_ptr<SocketSession>> sessions;
  std::thread thread;
};

/// A client. Has at most one message on its way; what happens meanwhile is in the next one.
class SocketSession : public std::enable_shared_from_this<SocketSession> {
 public:
  SocketSession(SocketServer::State& server, tcp::socket socket) : server_(server), stream_(std::move(socket)) {
    ++server_.socket_sessions;
  }
  ~SocketSession() { --server_.socket_sessions; }
  SocketSession(const SocketSession&) = delete;
  SocketSession& operator=(const SocketSession&) = delete;

  void accept(const http::request<http::empty_body>& request, const std::string& protocol) {
    stream_.set_option(websocket::stream_base::timeout{request_time, idle_time, true});
    stream_.set_option(websocket::stream_base::decorator([protocol](websocket::response_type& response) {
      response.set(http::field::server, "holdfast");
      if (!protocol.empty()) response.set(http::field::sec_websocket_protocol, protocol);
    }));
    stream_.read_message_max(server_.options.longest_message);
    stream_.auto_fragment(false);
    stream_.async_accept(request, [self = shared_from_this()](beast::error_code error) {
      if (error || self->server_.is_closing) return;
      self->client_ = self->server_.handlers.open();
      self->server_.add(self);
      self->read();
      self->send();
    });
  }
  /// Sends what the client lacks, unless a message is on its way. At the end of the server, then says farewell.
  void send() {
    if (is_sending_ || !client_) return;
    std::optional<SocketMessage> message = client_->next();
    if (!message) return server_.is_closing ? close() : void();
    outgoing_ = std::move(message->bytes);
    is_sending_ = true;
    stream_.text(message->is_text);
    stream_.async_write(asio::buffer(outgoing_), [self = shared_from_this()](beast::error_code error, std::size_t) {
      self->is_sending_ = false;
      if (error) return self->leave();
      if (!self->server_.options.is_paced || self->server_.is_closing) self->send();
    });
  }

 private:
  void close() {
    is_sending_ = true;
    stream_.async_close({websocket::close_code::going_away, "the run has ended"},
                        [self = shared_from_this()](beast::error_code) { self->leave(); });
  }
  void read() {
    stream_.async_read(incoming_, [self = shared_from_this()](beast::error_code error, std::size_t) {
      if (error) return self->leave();
      if (!self->client_) return;
      const std::string text = beast::buffers_to_string(self->incoming_.data());
      self->incoming_.clear();
      if (self->client_->receive(text, self->stream_.got_text())) {
        self->read();
        if (!self->server_.options.is_paced) self->send();
        return;
      }
      self->leave();
      self->stream_.async_close({websocket::close_code::policy_error, "unknown message"}, [self](beast::error_code) {});
    });
  }
  void leave() {
    if (!client_) return;
    client_.reset();
    server_.remove(this);
  }

  SocketServer::State& server_;
  websocket::stream<beast::tcp_stream> stream_;
  beast::flat_buffer incoming_;
  std::string outgoing_;
  std::unique_ptr<SocketClient> client_;  // null when it has left
  bool is_sending_ = false;
};

/// One request, which is answered, or becomes a SocketSession.
class RequestSession : public std::enable_shared_from_this<RequestSession> {
 public:
  RequestSession(SocketServer::State& server, tcp::socket socket) : server_(server), stream_(std::move(socket)) {
    ++server_.connections;
    parser_.emplace();
    parser_->header_limit(longest_request);
    parser_->body_limit(0);
  }
  ~RequestSession() {
    leave_silent();
    --server_.connections;
  }
  RequestSession(const RequestSession&) = delete;
  RequestSession& operator=(const RequestSession&) = delete;

  void read() {
    server_.silent.push_back(this);
    stream_.expires_after(request_time);
    http::async_read(stream_, buffer_, *parser_, [self = shared_from_this()](beast::error_code error, std::size_t) {
      self->leave_silent();
      if (!error)
        self->answer();
      else if (self->stream_.socket().is_open() && error != http::error::end_of_stream &&
               error != beast::error::timeout)
        self->refuse(http::status::bad_request, "not a request that is understood");
    });
  }
  /// Frees the descriptor of a request that has not come yet.
  void close() { stream_.close(); }

 private:
  void leave_silent() { std::erase(server_.silent, this); }
  void answer() {
    const http::request<http::empty_body>& request = parser_->get();
    const std::string_view target(request.target().data(), request.target().size());
    const std::size_t mark = target.find('?');
    const std::string_view path = target.substr(0, mark);
    const std::string_view query = mark == std::string_view::npos ? "" : target.substr(mark + 1);
    const SocketServer::Options& options = server_.options;
    if (!is_same_secret(query, "token=" + options.token))
      return refuse(http::status::forbidden, "the token is missing or wrong; take the address that the program shows");
    const bool is_page = path == "/" && !options.page.empty();
    if (!is_page && path != options.socket_path) return refuse(http::status::not_found, "there is no such page");
    if (request.method() != http::verb::get) return refuse(http::status::method_not_allowed, "expected GET");
    if (is_page) return respond(http::status::ok, "text/html; charset=utf-8", options.page);
    if (!websocket::is_upgrade(request)) return refuse(http::status::upgrade_required, "expected a WebSocket");
    const std::string protocol = common_protocol(request[http::field::sec_websocket_protocol], options.protocols);
    if (protocol.empty() && !options.protocols.empty())
      return refuse(http::status::bad_request, "expected the subprotocol " + options.protocols.front());
    if (server_.socket_sessions >= SocketServer::max_clients)
      return refuse(http::status::service_unavailable, "too many clients are connected");
    stream_.expires_never();
    std::make_shared<SocketSession>(server_, stream_.release_socket())->accept(request, protocol);
  }
  void refuse(http::status status, const std::string& reason) {
    respond(status, "text/plain; charset=utf-8", reason + "\n");
  }
  void respond(http::status status, const char* type, std::string body) {
    response_.result(status);
    response_.version(11);
    response_.set(http::field::server, "holdfast");
    response_.set(http::field::content_type, type);
    response_.set(http::field::cache_control, "no-store");
    response_.set("Referrer-Policy", "no-referrer");
    response_.set("X-Content-Type-Options", "nosniff");
    response_.set("X-Frame-Options", "DENY");
    response_.set("Content-Security-Policy",
                  "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; img-src data: blob:; "
                  "connect-src 'self' ws:; base-uri 'none'; form-action 'none'");
    response_.body() = std::move(body);
    response_.keep_alive(false);
    response_.prepare_payload();
    stream_.expires_after(request_time);
    http::async_write(stream_, response_, [self = shared_from_this()](beast::error_code, std::size_t) {
      beast::error_code ignored;
      self->stream_.socket().shutdown(tcp::socket::shutdown_send, ignored);
    });
  }

  SocketServer::State& server_;
  beast::tcp_stream stream_;
  beast::flat_buffer buffer_{longest_request};
  std::optional<http::request_parser<http::empty_body>> parser_;
  http::response<http::string_body> response_;
};

namespace {

std::string host_of(const tcp::endpoint& endpoint) {
  if (endpoint.address().is_unspecified()) {
    std::array<char, 256> name{};
    if (gethostname(name.data(), name.size() - 1) == 0) return name.data();
  }
  const std::string text = endpoint.address().to_string();
  return endpoint.address().is_v6() ? "[" + text + "]" : text;
}

}  // namespace

void SocketServer::State::listen() {
  const auto fail = [&](const std::string& reason) {
    throw InputError({options.name},
                     "cannot listen at " + options.listen + ", port " + std::to_string(options.port) + ": " + reason +
                         "; give `listen` a numeric address of this machine, and `port` 0 for any free one");
  };
  beast::error_code error;
  const asio::ip::address numeric = asio::ip::make_address(options.listen, error);
  if (error) fail(error.message());
  const tcp::endpoint endpoint(numeric, static_cast<std::uint16_t>(options.port));
  acceptor.open(endpoint.protocol(), error);
  if (error) fail(error.message());
  fcntl(acceptor.native_handle(), F_SETFD, FD_CLOEXEC);  // a program that this one starts would keep the port
  acceptor.set_option(asio::socket_base::reuse_address(true), error);
  acceptor.bind(endpoint, error);
  if (error) fail(error.message());
  acceptor.listen(asio::socket_base::max_listen_connections, error);
  if (error) fail(error.message());
  const tcp::endpoint bound = acceptor.local_endpoint();
  address = options.scheme + "://" + host_of(bound) + ":" + std::to_string(bound.port()) + "/?token=" + options.token;
}

/// Makes room for a connection, at the cost of one that has shown no token: browsers send theirs at once. False if
/// there is none.
bool SocketServer::State::close_oldest_silent() {
  if (silent.empty()) return false;
  RequestSession* const oldest = silent.front();
  silent.erase(silent.begin());
  oldest->close();
  return true;
}

void SocketServer::State::accept_later() {
  accept_timer.expires_after(accept_pause);
  accept_timer.async_wait([this](beast::error_code error) {
    if (!error) accept();
  });
}

void SocketServer::State::accept() {
  acceptor.async_accept([this](beast::error_code error, tcp::socket socket) {
    if (error == asio::error::operation_aborted) return;
    // Where there is no descriptor for it, the connection waits, and the system says so again and again.
    if (error && error != asio::error::connection_aborted && !close_oldest_silent()) return accept_later();
    if (!error && (connections < most_connections || close_oldest_silent())) {
      beast::error_code ignored;
      socket.set_option(tcp::no_delay(true), ignored);
      fcntl(socket.native_handle(), F_SETFD, FD_CLOEXEC);
      std::make_shared<RequestSession>(*this, std::move(socket))->read();
    }
    accept();
  });
}

void SocketServer::State::tick() {
  timer.expires_after(sessions.empty() ? tick_alone : tick_watched);
  timer.async_wait([this](beast::error_code error) {
    if (error) return;
    handlers.tick();
    const std::vector<std::shared_ptr<SocketSession>> now = sessions;  // sending can end one
    for (const auto& session : now) session->send();
    tick();
  });
}

void SocketServer::State::add(const std::shared_ptr<SocketSession>& session) {
  sessions.push_back(session);
  handlers.tick();
  tick();  // at once at the faster rate
}

void SocketServer::State::remove(const SocketSession* session) {
  std::erase_if(sessions, [&](const auto& other) { return other.get() == session; });
  if (is_closing && sessions.empty()) io.stop();
}

/// Lets all clients take what is left, and ends the thread after that.
void SocketServer::State::close() {
  is_closing = true;
  if (sessions.empty()) return io.stop();
  closing_timer.expires_after(closing_time);
  closing_timer.async_wait([this](beast::error_code) { io.stop(); });
  handlers.tick();
  const std::vector<std::shared_ptr<SocketSession>> now = sessions;  // sending can end one
  for (const auto& session : now) session->send();
}

void SocketServer::State::run() {
  name_this_thread(options.name);
  accept();
  tick();
  io.run();
}

SocketServer::SocketServer(Options options, Handlers handlers)
    : state_(std::make_unique<State>(std::move(options), std::move(handlers))) {
  state_->listen();
  // Signals are for the thread that runs the frames, which may be waiting for its turn.
  sigset_t all, before;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  state_->thread = std::thread([state = state_.get()] { state->run(); });
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
  const std::lock_guard lock(servers_mutex);
  servers.push_back(this);
}

SocketServer::~SocketServer() {
  {
    const std::lock_guard lock(servers_mutex);
    std::erase(servers, this);
  }
  asio::post(state_->io, [state = state_.get()] { state->close(); });
  state_->thread.join();
}

const std::string& SocketServer::name() const { return state_->options.name; }
const std::string& SocketServer::address() const { return state_->address; }

}  // namespace holdfast
