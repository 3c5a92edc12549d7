// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/socket_client.hpp"

#include <boost/asio/connect.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/websocket.hpp>
#include <utility>

namespace holdfast::test {

namespace asio = boost::asio;
namespace beast = boost::beast;
using boost::asio::ip::tcp;

namespace {

tcp::socket connected(asio::io_context& io, const ViewerAddress& address) {
  tcp::socket socket(io);
  asio::connect(socket, tcp::resolver(io).resolve(address.host, address.port));
  return socket;
}

}  // namespace

std::string answer_to(const ViewerAddress& address, const std::string& request) {
  asio::io_context io;
  tcp::socket socket = connected(io, address);
  beast::error_code error;
  asio::write(socket, asio::buffer(request), error);
  std::string answer, part(65536, '\0');
  while (const std::size_t count = socket.read_some(asio::buffer(part), error)) answer.append(part, 0, count);
  return answer;
}

std::string answer_to_get(const ViewerAddress& address, const std::string& target) {
  return answer_to(address, "GET " + target + " HTTP/1.1\r\nHost: " + address.host + "\r\n\r\n");
}

struct SilentClient::State {
  asio::io_context io;
  tcp::socket socket{io};
};

SilentClient::SilentClient(const ViewerAddress& address) : state_(std::make_unique<State>()) {
  state_->socket = connected(state_->io, address);
}

SilentClient::~SilentClient() = default;
SilentClient::SilentClient(SilentClient&&) noexcept = default;

bool SilentClient::is_closed() {
  state_->socket.non_blocking(true);
  char byte = 0;
  beast::error_code error;
  state_->socket.read_some(asio::buffer(&byte, 1), error);
  return error && error != asio::error::would_block;
}

struct SocketClient::State {
  asio::io_context io;
  beast::websocket::stream<tcp::socket> stream{io};
};

SocketClient::SocketClient(const ViewerAddress& address) : SocketClient(address, "/socket?token=" + address.token) {}

SocketClient::SocketClient(const ViewerAddress& address, const std::string& target)
    : state_(std::make_unique<State>()) {
  state_->stream.next_layer() = connected(state_->io, address);
  state_->stream.read_message_max(0);
  state_->stream.handshake(address.host + ":" + address.port, target);
}

SocketClient::~SocketClient() = default;
SocketClient::SocketClient(SocketClient&&) noexcept = default;

void SocketClient::send(const std::string& text, bool is_binary) {
  state_->stream.binary(is_binary);
  beast::error_code ignored;  // of a connection that has ended; receive() tells
  state_->stream.write(asio::buffer(text), ignored);
}

std::optional<ReceivedMessage> SocketClient::receive() {
  beast::flat_buffer buffer;
  beast::error_code error;
  state_->stream.read(buffer, error);
  if (error) return std::nullopt;
  return ReceivedMessage(beast::buffers_to_string(buffer.data()));
}

}  // namespace holdfast::test
