// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <atomic>
#include <ctime>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "foxglove_description.hpp"
#include "holdfast/core/error.hpp"
#include "holdfast/interfaces/observer.hpp"
#include "holdfast/mcap/run_messages.hpp"
#include "holdfast/plugin/plugin.hpp"
#include "holdfast/settings/foxglove.hpp"
#include "live_client.hpp"

namespace holdfast {

namespace {

using namespace foxglove_plugin;

std::string checked_token(const FoxgloveSettings& settings) {
  constexpr std::size_t fewest = 16;  // where other machines can try
  const std::string& token = settings.token;
  constexpr const char* allowed = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_";
  if (token.find_first_not_of(allowed) != std::string::npos)
    throw InputError({"observer 'foxglove'"},
                     "the token has characters that an address cannot have; expected letters, "
                     "digits, - and _, or nothing for a random one");
  const bool is_loopback = settings.listen.starts_with("127.") || settings.listen == "::1";
  if (!token.empty() && token.size() < fewest && !is_loopback)
    throw InputError({"observer 'foxglove'"}, "the token has " + std::to_string(token.size()) +
                                                  " characters; expected at least 16 where other machines can connect, "
                                                  "or nothing for a random one");
  return token.empty() ? random_token() : token;
}

/// The clients of one run. Functions are called by the thread of the server.
class LiveClients {
 public:
  explicit LiveClients(LiveChannels& channels) : channels_(channels) {}

  std::unique_ptr<SocketClient> open() {
    auto client = std::make_unique<Registered>(*this);
    clients_.push_back(client->get());
    return client;
  }
  void hand_out() {
    for (const auto& message : channels_.take_messages())
      for (LiveClient* client : clients_) client->add(message);
  }

 private:
  class Registered final : public SocketClient {
   public:
    explicit Registered(LiveClients& clients) : clients_(clients), client_(clients.channels_, clients.session_) {}
    ~Registered() override { std::erase(clients_.clients_, &client_); }
    Registered(const Registered&) = delete;
    Registered& operator=(const Registered&) = delete;
    std::optional<SocketMessage> next() override { return client_.next(); }
    bool receive(std::string_view message, bool is_text) override { return client_.receive(message, is_text); }
    LiveClient* get() { return &client_; }

   private:
    LiveClients& clients_;
    LiveClient client_;
  };

  LiveChannels& channels_;
  const std::string session_ = random_token();
  std::vector<LiveClient*> clients_;
};

/// Sends what a run finds to clients by Foxglove's WebSocket protocol. The tracking and the mapping thread make the
/// messages, and wait for no client.
class Foxglove final : public Observer {
 public:
  Foxglove(const FoxgloveSettings& settings, const CreationContext& context)
      : settings_(settings),
        messages_(channels_, {settings.image_every, settings.quality}, context.camera),
        clients_(channels_),
        server_({.name = "foxglove",
                 .scheme = "ws",
                 .listen = settings.listen,
                 .port = settings.port,
                 .token = checked_token(settings),
                 .protocols = {"foxglove.websocket.v1", "foxglove.sdk.v1"},
                 .longest_message = 1U << 16},
                {.tick = [this] { clients_.hand_out(); }, .open = [this] { return clients_.open(); }}) {}

  void on_frame(const SensorFrame& sensor_frame, const Frame& frame, const FrameResult& result) override {
    if (settings_.wait && !std::exchange(has_waited_, true)) wait_for_subscriptions();
    const std::lock_guard lock(mutex_);
    messages_.add_frame(sensor_frame, frame, result);
  }

  void on_keyframe(KeyFrameId, const ObservedMap& map) override {
    const double time = map_time_ ? last_time() : first_time(map.snapshot());
    if (map_time_ && time < *map_time_ + settings_.map_interval) return;
    map_time_ = time;
    messages_.add_map(map.snapshot(), time);
  }

  void on_finish(const Map& map) override { messages_.add_map(make_snapshot(map), last_time()); }
  void interrupt() noexcept override { is_interrupted_ = true; }

 private:
  double last_time() const {
    const std::lock_guard lock(mutex_);
    return messages_.time();
  }
  /// That of the newest keyframe: the first one is processed before its frame is shown.
  static double first_time(const MapSnapshot& map) {
    return map.keyframes.empty() ? 0.0 : map.keyframes.back().timestamp;
  }
  /// Until there is a subscription, and for 0.2 s no further one: clients send one request for each topic. Or until the
  /// run is interrupted, or this thread handles a signal, which ends a sleep.
  void wait_for_subscriptions() const {
    const std::timespec nap{0, 20'000'000};
    constexpr int quiet_naps = 10;
    int known = 0;
    for (int quiet = 0; quiet < quiet_naps && !is_interrupted_; ++quiet) {
      if (nanosleep(&nap, nullptr) != 0) return;
      const int subscriptions = channels_.subscriptions();
      if (subscriptions == 0 || std::exchange(known, subscriptions) != subscriptions) quiet = 0;
    }
  }

  FoxgloveSettings settings_;
  LiveChannels channels_;
  mutable std::mutex mutex_;  // of messages_, but for add_map()
  mcap::RunMessages messages_;
  std::optional<double> map_time_;  // of the last map [s]; used by the mapping thread
  bool has_waited_ = false;
  std::atomic<bool> is_interrupted_ = false;
  LiveClients clients_;
  SocketServer server_;  // last: its thread uses everything above
};

}  // namespace

HOLDFAST_PLUGIN(foxglove, registry) {
  registry.add<Observer, Foxglove, FoxgloveSettings>(foxglove_plugin::description());
}

}  // namespace holdfast
