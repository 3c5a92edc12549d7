// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <future>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "holdfast/core/error.hpp"
#include "holdfast/interfaces/observer.hpp"
#include "holdfast/mcap/run_messages.hpp"
#include "holdfast/plugin/registry.hpp"
#include "holdfast/web_server/socket_server.hpp"
#include "live_client.hpp"
#include "support/npm_tools.hpp"

extern "C" void holdfast_register_plugin_foxglove(holdfast::Registry&);

namespace holdfast {
namespace {

using foxglove_plugin::LiveChannels;
using foxglove_plugin::LiveClient;
using testing::Contains;
using testing::HasSubstr;
using Json = nlohmann::json;

std::unique_ptr<Observer> observer(ParameterValues values) {
  Registry registry;
  holdfast_register_plugin_foxglove(registry);
  values.try_emplace("port", std::int64_t{0});
  return registry.create<Observer>("foxglove", values, CreationContext());
}

void feed(Observer& observer, std::uint64_t index) {
  SensorFrame sensor_frame;
  sensor_frame.index = index;
  sensor_frame.colour = cv::Mat(24, 32, CV_8UC3, cv::Scalar(10, 200, 30));
  FrameResult result;
  result.index = index;
  result.timestamp = 1.5 + 0.1 * static_cast<double>(index);
  result.T_world_camera = Eigen::Isometry3d(Eigen::Translation3d(0.0, 0.0, static_cast<double>(index)));
  observer.on_frame(sensor_frame, {}, result);
}

/// What the client of npm has got when the observer is gone, which waits for the client before its first frame.
Json heard_by_npm(const test::NpmTools& tools, const char* protocol) {
  auto live = observer({{"wait", true}, {"token", std::string("secret-1")}});
  const std::string address = running_servers().back().second;
  const std::string name = std::string("foxglove_") + protocol + "_" + std::to_string(getpid());
  const std::filesystem::path output = std::filesystem::path(testing::TempDir()) / name;
  auto heard = std::async(std::launch::async, [&] {
    return tools.run("node '" HOLDFAST_TEST_LISTENER "' '" + address + "' " + protocol, output);
  });
  Map map;
  Frame first;
  first.timestamp = 1.5;
  live->on_keyframe(map.add_keyframe(std::move(first)), ObservedMap([&] { return make_snapshot(map); }));
  for (std::uint64_t i = 0; i < 3; ++i) feed(*live, i);
  map.add_point(Eigen::Vector3d(1, 2, 3), 0);
  live->on_finish(map);
  live.reset();
  const std::optional<std::string> said = heard.get();
  std::filesystem::remove(output);
  EXPECT_TRUE(said) << "the client failed";
  return said ? Json::parse(*said) : Json();
}

TEST(FoxgloveTest, TheClientOfFoxgloveGetsARun) {
  const test::NpmTools tools(HOLDFAST_TEST_NPM_FOLDER, {"@foxglove/ws-protocol@0.8.0", "ws@8.23.0"});
  if (!tools.trouble().empty()) GTEST_SKIP() << tools.trouble();
  for (const char* protocol : {"foxglove.websocket.v1", "foxglove.sdk.v1"}) {
    const Json heard = heard_by_npm(tools, protocol);
    EXPECT_EQ(heard["protocol"], protocol);
    EXPECT_EQ(heard["information"]["name"], "holdfast");
    EXPECT_EQ(heard["channels"].size(), 10U);
    for (const Json& channel : heard["channels"]) {
      EXPECT_EQ(channel["encoding"], "json");
      EXPECT_EQ(channel["schemaEncoding"], "jsonschema");
      EXPECT_EQ(channel["title"], channel["schemaName"]);
    }
    EXPECT_THAT(heard["statuses"], Contains("there is no such subscription"));
    EXPECT_THAT(heard["statuses"], Contains(HasSubstr("channelId of an advertised channel")));
    const Json& topics = heard["topics"];
    EXPECT_EQ(topics["/camera/pose"]["count"], 3) << "all frames, since the first one waited";
    EXPECT_EQ(topics["/camera/pose"]["first"], "1500000000");
    EXPECT_EQ(topics["/camera/pose"]["time"], "1700000000");
    EXPECT_EQ(topics["/log"]["count"], 1);
    EXPECT_EQ(heard["end"], 1001) << "the server goes away, after all messages";
    EXPECT_EQ(topics["/camera/pose"]["last"]["pose"]["position"]["z"], 2.0);
    EXPECT_EQ(topics["/camera/image"]["last"]["format"], "jpeg");
    EXPECT_EQ(topics["/map/points"]["count"], 2);
    EXPECT_EQ(topics["/map/keyframes"]["first"], "1500000000") << "before the first frame was shown";
    EXPECT_EQ(topics["/map/points"]["last"]["data"], "AACAPwAAAEAAAEBA");  // 1, 2, 3 as float32
  }
}

TEST(FoxgloveTest, AnInterruptEndsTheWait) {
  const auto live = observer({{"wait", true}});
  auto frame = std::async(std::launch::async, [&] { feed(*live, 0); });
  EXPECT_EQ(frame.wait_for(std::chrono::milliseconds(50)), std::future_status::timeout);
  live->interrupt();
  frame.get();
}

/// All texts in a document.
void collect_texts(const Json& value, std::vector<std::string>& texts) {
  if (value.is_string()) texts.push_back(value);
  if (value.is_object())
    for (const auto& [key, entry] : value.items()) texts.push_back(key), collect_texts(entry, texts);
  if (value.is_array())
    for (const Json& entry : value) collect_texts(entry, texts);
}

// The layout shows topics and fields that there are, and has each of its panels in its place.
TEST(FoxgloveTest, TheLayoutFitsTheTopics) {
  LiveChannels channels;
  const mcap::RunMessages messages(channels, {}, Camera());
  const Json layout = Json::parse(std::ifstream(HOLDFAST_TEST_LAYOUT));
  std::vector<std::string> texts, places;
  for (const auto& [name, panel] : layout["configById"].items()) {
    Json shown = panel;
    shown.erase("publish");  // topics that the application requires, and nothing uses
    collect_texts(shown, texts);
  }
  int checked = 0;
  for (const std::string& text : texts) {
    if (!text.starts_with('/')) continue;
    const std::string topic = text.substr(0, text.find('.'));
    const std::vector<mcap::Channel> all = channels.channels();
    const auto channel = std::find_if(all.begin(), all.end(), [&](const auto& c) { return c.topic == topic; });
    ASSERT_NE(channel, all.end()) << text;
    if (topic != text) {
      EXPECT_TRUE(Json::parse(channel->schema)["properties"].contains(text.substr(topic.size() + 1))) << text;
    }
    ++checked;
  }
  EXPECT_GE(checked, 12);
  collect_texts(layout["layout"], places);
  for (const auto& [name, panel] : layout["configById"].items()) EXPECT_THAT(places, Contains(name));
}

TEST(FoxgloveTest, RefusesWhatCannotBe) {
  EXPECT_THROW(observer({{"token", std::string("a b")}}), InputError);
  EXPECT_THROW(observer({{"token", std::string("fifteen_letters")}, {"listen", std::string("0.0.0.0")}}), InputError);
  EXPECT_NO_THROW(observer({{"token", std::string("sixteen__letters")}, {"listen", std::string("0.0.0.0")}}));
  try {
    observer({{"listen", std::string("203.0.113.7")}});
    FAIL() << "listens at an address of somebody else";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("foxglove: cannot listen at 203.0.113.7"));
  }
}

class LiveClientTest : public testing::Test {
 protected:
  LiveClientTest() {
    pose_ = channels_.add_channel({"/camera/pose", "json", "foxglove.PoseInFrame", "jsonschema", "{}"});
    points_ = channels_.add_channel({"/map/points", "json", "foxglove.PointCloud", "jsonschema", "{}"});
  }
  /// All that waits, texts parsed.
  static std::pair<std::vector<Json>, std::vector<std::string>> drain(LiveClient& client) {
    std::vector<Json> texts;
    std::vector<std::string> messages;
    while (const std::optional<SocketMessage> message = client.next())
      if (message->is_text)
        texts.push_back(Json::parse(message->bytes));
      else
        messages.push_back(message->bytes);
    return {texts, messages};
  }
  void hand_out(LiveClient& client) {
    for (const auto& message : channels_.take_messages()) client.add(message);
  }

  LiveChannels channels_;
  std::uint16_t pose_ = 0, points_ = 0;
};

TEST_F(LiveClientTest, SendsOnlyWhatIsSubscribedTo) {
  LiveClient client(channels_, "session");
  const auto [texts, none] = drain(client);
  ASSERT_EQ(texts.size(), 2U);
  EXPECT_EQ(texts[0]["op"], "serverInfo");
  EXPECT_EQ(texts[1]["channels"][1]["topic"], "/map/points");
  EXPECT_FALSE(channels_.wants(pose_));
  channels_.write_state(points_, 4, [] { return ADD_FAILURE() << "is made for nobody", "map"; });
  channels_.write_state(points_, 5, [] { return "map"; });
  hand_out(client);
  EXPECT_FALSE(client.next());

  EXPECT_TRUE(
      client.receive(R"({"op":"subscribe","subscriptions":[{"id":7,"channelId":1},{"id":8,"channelId":2}]})", true));
  EXPECT_TRUE(channels_.wants(pose_));
  EXPECT_EQ(channels_.subscriptions(), 2);
  channels_.write(pose_, 0x0102030405060708, "pose");
  hand_out(client);
  const auto messages = drain(client).second;
  ASSERT_EQ(messages.size(), 2U);
  EXPECT_EQ(messages[0], std::string("\x01\x08\0\0\0\x05\0\0\0\0\0\0\0map", 16)) << "the last map comes at once";
  EXPECT_EQ(messages[1], std::string("\x01\x07\0\0\0\x08\x07\x06\x05\x04\x03\x02\x01pose", 17));

  EXPECT_TRUE(client.receive(R"({"op":"unsubscribe","subscriptionIds":[7]})", true));
  EXPECT_FALSE(channels_.wants(pose_));
  channels_.write(pose_, 9, "pose");
  hand_out(client);
  EXPECT_FALSE(client.next());
}

TEST_F(LiveClientTest, AnswersWhatItDoesNotKnow) {
  LiveClient client(channels_, "session");
  drain(client);
  for (const char* request :
       {"", "[]", "{", R"({"op":3})", R"({"op":"getParameters"})", R"({"op":"\xff"})",
        R"({"op":"subscribe","subscriptions":[3]})", R"({"op":"subscribe","subscriptions":[{"id":-1,"channelId":1}]})",
        R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":65537}]})",
        R"({"op":"unsubscribe","subscriptionIds":[4294967297]})"}) {
    EXPECT_TRUE(client.receive(request, true)) << request;
    const auto [texts, messages] = drain(client);
    ASSERT_EQ(texts.size(), 1U) << request;
    EXPECT_EQ(texts[0]["op"], "status");
    EXPECT_GE(texts[0]["level"], 1);
  }
  EXPECT_TRUE(client.receive("\x01", false));
  EXPECT_TRUE(client.next());
  EXPECT_FALSE(channels_.wants(pose_));
}

// The last state comes with the subscription, and is not sent once more when it is handed out.
TEST_F(LiveClientTest, SendsNothingTwice) {
  LiveClient client(channels_, "session");
  drain(client);
  channels_.write_state(points_, 5, [] { return "map"; });
  const char* subscribe = R"({"op":"subscribe","subscriptions":[{"id":8,"channelId":2}]})";
  client.receive(subscribe, true);
  hand_out(client);
  EXPECT_EQ(drain(client).second.size(), 1U);
  client.receive(R"({"op":"unsubscribe","subscriptionIds":[8]})", true);
  client.receive(subscribe, true);
  EXPECT_EQ(drain(client).second.size(), 1U);
}

TEST(FoxgloveTest, WhoComesLaterGetsTheHealth) {
  LiveChannels channels;
  mcap::RunMessages messages(channels, {}, Camera());
  messages.add_frame({}, {}, FrameResult());
  channels.take_messages();
  LiveClient client(channels, "session");
  for (int i = 0; i < 2; ++i) ASSERT_TRUE(client.next());
  client.receive(R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":1},{"id":2,"channelId":2}]})", true);
  const std::optional<SocketMessage> message = client.next();
  ASSERT_TRUE(message);
  EXPECT_THAT(message->bytes, HasSubstr("\"name\":\"health\""));
  EXPECT_FALSE(client.next()) << "no state of a frame that is over";
}

// As deep as the longest message that a server takes can nest.
TEST_F(LiveClientTest, RefusesDeepNesting) {
  LiveClient client(channels_, "session");
  drain(client);
  const std::string deep(32'000, '[');
  for (const char* list : {"subscriptions", "subscriptionIds"}) {
    const std::string op = std::string(list) == "subscriptions" ? "subscribe" : "unsubscribe";
    client.receive(R"({"op":")" + op + R"(",")" + list + "\":" + deep + std::string(32'000, ']') + "}", true);
    const auto [texts, messages] = drain(client);
    ASSERT_EQ(texts.size(), 1U);
    EXPECT_THAT(texts[0]["message"], HasSubstr("expected a JSON object")) << "nothing of it is read";
  }
}

TEST_F(LiveClientTest, DropsTheOldestForASlowClient) {
  LiveClient client(channels_, "session");
  drain(client);
  client.receive(R"({"op":"subscribe","subscriptions":[{"id":7,"channelId":1}]})", true);
  const std::string large(LiveClient::max_waiting / 4, 'x');
  for (std::uint64_t time = 1; time <= 6; ++time) {
    channels_.write(pose_, time, large);
    hand_out(client);
  }
  const auto [texts, messages] = drain(client);
  ASSERT_EQ(texts.size(), 1U);
  EXPECT_THAT(texts[0]["message"], HasSubstr("dropped"));
  ASSERT_EQ(messages.size(), 4U);
  EXPECT_EQ(messages[0][5], 3);
}

}  // namespace
}  // namespace holdfast
