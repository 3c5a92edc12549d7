// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/viewer/viewer.hpp"

#include <gmock/gmock.h>
#include <pthread.h>

#include <atomic>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <future>
#include <set>
#include <thread>

#include "holdfast/core/error.hpp"
#include "holdfast/core/random.hpp"
#include "viewer/socket_client.hpp"
#include "viewer/viewed_world.hpp"

namespace holdfast {
namespace {

using test::ReceivedMessage;
using test::SocketClient;
using test::ViewerAddress;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::SizeIs;
using ::testing::StartsWith;

bool has_state(const ReceivedMessage& message, const char* key, const nlohmann::json& value) {
  return message.json.contains("state") && message.json["state"].value(key, nlohmann::json()) == value;
}

class ViewerTest : public testing::Test {
 protected:
  std::shared_ptr<Viewer> viewer_ = Viewer::start({.title = "run & <others>"});
  ViewerAddress address_{viewer_->address()};

  /// Has a frame pass, and says when it has.
  std::future<void> pass_frame(double timestamp) {
    return std::async(std::launch::async, [this, timestamp] { viewer_->take_turn(timestamp); });
  }
  static bool is_done(const std::future<void>& frame) {
    return frame.wait_for(std::chrono::milliseconds(0)) == std::future_status::ready;
  }
  /// Pauses the run, and returns when it is paused.
  void pause(SocketClient& client) {
    client.send("pause");
    client.receive_until([](const ReceivedMessage& message) { return has_state(message, "paused", true); });
  }
};

TEST_F(ViewerTest, ServesThePageToWhoeverHasTheToken) {
  EXPECT_EQ(address_.host, "127.0.0.1");
  EXPECT_THAT(address_.token, SizeIs(32));
  const std::string answer = test::answer_to_get(address_, "/?token=" + address_.token);
  EXPECT_THAT(answer, AllOf(StartsWith("HTTP/1.1 200 OK\r\n"), HasSubstr("text/html"), HasSubstr("<canvas id=\"map\""),
                            HasSubstr("default-src 'none'"), HasSubstr("Referrer-Policy: no-referrer")));
  EXPECT_LT(answer.size(), 1'000'000U);
  EXPECT_THAT(answer, Not(HasSubstr("{{"))) << "all parts are filled in";
  for (const char* outside : {"src=\"http", "href=\"http", "url(http", "import("})
    EXPECT_THAT(answer, Not(HasSubstr(outside)));
}

TEST_F(ViewerTest, RefusesWhoeverHasNot) {
  const std::string wrong(32, '0');
  const std::vector<std::string> queries = {"",
                                            "?token=",
                                            "?token=" + wrong,
                                            "?token=" + address_.token + "0",
                                            "?token=" + address_.token + "&more=1",
                                            "?other=" + address_.token,
                                            "?token=" + address_.token.substr(1)};
  for (const std::string& query : queries)
    for (const char* path : {"/", "/socket", "/index.html"})
      EXPECT_THAT(test::answer_to_get(address_, path + query),
                  AllOf(StartsWith("HTTP/1.1 403 "), Not(HasSubstr("canvas")), Not(HasSubstr(address_.token))))
          << path << query;
  EXPECT_ANY_THROW(SocketClient(address_, "/socket?token=" + wrong));
  EXPECT_ANY_THROW(SocketClient(address_, "/socket"));
  EXPECT_FALSE(viewer_->is_watched());
}

TEST_F(ViewerTest, ServesNoFile) {
  const auto file = std::filesystem::temp_directory_path() / "holdfast_viewer_secret.txt";
  std::ofstream(file) << "secret";
  for (const std::string& path :
       {std::string("/etc/passwd"), std::string("/../../etc/passwd"), std::string("/..%2f..%2fetc%2fpasswd"),
        file.string(), std::string("//etc/passwd"), std::string("/viewer.html"), std::string("/main.js")})
    EXPECT_THAT(test::answer_to_get(address_, path + "?token=" + address_.token),
                AllOf(StartsWith("HTTP/1.1 404 "), Not(HasSubstr("root:")), Not(HasSubstr("secret"))))
        << path;
  std::filesystem::remove(file);
}

TEST_F(ViewerTest, AnswersWhatIsNoRequestForThePage) {
  const std::string target = "/?token=" + address_.token;
  EXPECT_THAT(test::answer_to(address_, "DELETE " + target + " HTTP/1.1\r\nHost: a\r\n\r\n"),
              StartsWith("HTTP/1.1 405 "));
  EXPECT_THAT(test::answer_to_get(address_, "/socket?token=" + address_.token), StartsWith("HTTP/1.1 426 "));
  EXPECT_THAT(test::answer_to(address_, "nonsense\r\n\r\n"), StartsWith("HTTP/1.1 400 "));
  EXPECT_THAT(test::answer_to(address_, "GET /" + std::string(20000, 'a') + " HTTP/1.1\r\n\r\n"),
              Not(HasSubstr("200 OK")));
  EXPECT_THAT(test::answer_to_get(address_, target), StartsWith("HTTP/1.1 200 "));
}

TEST_F(ViewerTest, EveryViewerHasAnotherToken) {
  std::set<std::string> tokens;
  for (int i = 0; i < 20; ++i) tokens.insert(ViewerAddress(Viewer::start({})->address()).token);
  EXPECT_THAT(tokens, SizeIs(20));
}

TEST_F(ViewerTest, ListsTheViewersOfTheProcess) {
  EXPECT_THAT(running_viewers(), ElementsAre(viewer_));
  const auto other = Viewer::start({});
  EXPECT_THAT(running_viewers(), ElementsAre(viewer_, other));
}

TEST_F(ViewerTest, SaysWhyItCannotListen) {
  const auto fails_with = [](const ViewerOptions& options, const std::string& text) {
    try {
      Viewer::start(options);
      ADD_FAILURE() << "expected: " << text;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr(text));
    }
  };
  fails_with({.port = std::stoi(address_.port)}, "in use");
  fails_with({.listen = "localhost.example"}, "numeric address");
  fails_with({.listen = "203.0.113.7"}, "cannot listen at 203.0.113.7");
}

TEST_F(ViewerTest, TwoBrowsersAndOneThatComesBackSeeTheSame) {
  viewer_->set_map(test::row_map(4), 0.0);
  viewer_->add_frame(test::row_frame(0));
  const auto has_points = [](std::size_t count) {
    return
        [count](const ReceivedMessage& message) { return message.array<std::uint32_t>("point_slots").size() == count; };
  };
  SocketClient first(address_);
  first.receive_until(has_points(4));
  EXPECT_TRUE(viewer_->is_watched());
  {
    SocketClient second(address_);
    second.receive_until(has_points(4));
    viewer_->set_map(test::row_map(5), 0.0);
    first.receive_until(has_points(1));
    second.receive_until(has_points(1));
  }
  SocketClient again(address_);
  const ReceivedMessage all = again.receive_until(has_points(5));
  EXPECT_EQ(all.json["head"]["title"], "run & <others>");
  EXPECT_THAT(all.array<double>("path_stamps"), SizeIs(1));
}

TEST_F(ViewerTest, ABrowserPausesStepsAndResumes) {
  SocketClient client(address_);
  client.receive();
  pause(client);
  std::future<void> first = pass_frame(0.0);
  EXPECT_EQ(first.wait_for(std::chrono::milliseconds(50)), std::future_status::timeout);
  client.send("step");
  first.get();
  std::future<void> second = pass_frame(0.1);
  EXPECT_EQ(second.wait_for(std::chrono::milliseconds(50)), std::future_status::timeout);
  client.send("resume");
  second.get();
  viewer_->take_turn(0.2);
}

TEST_F(ViewerTest, ABrowserChoosesTheSpeed) {
  SocketClient client(address_);
  client.receive();
  client.send("speed 4");
  client.receive_until([](const ReceivedMessage& message) { return has_state(message, "speed", 4.0); });
  viewer_->take_turn(100.0);
  const Stopwatch watch;
  viewer_->take_turn(100.4);
  EXPECT_GE(watch.seconds(), 0.09) << "0.4 s at four times the speed";
  client.send("speed 0");
  client.receive_until([](const ReceivedMessage& message) { return has_state(message, "speed", 0.0); });
  viewer_->take_turn(1e6);
}

TEST_F(ViewerTest, ABrowserGetsNoMoreThanItAsksFor) {
  const auto viewer = Viewer::start({.picture_rate = 60.0});
  SocketClient client{ViewerAddress(viewer->address())};
  client.receive();
  ViewedPicture picture;
  picture.colour = cv::Mat(48, 64, CV_8UC3, cv::Scalar::all(99));
  const auto next_picture = [&] {
    const Stopwatch watch;
    viewer->set_picture(picture);
    while (!viewer->wants_picture()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    return watch.seconds();
  };
  // Times can only be longer than they should be, not shorter: the machine may do other work as well.
  client.send("rate 1");
  double longest = 0.0;
  for (int i = 0; i < 200 && longest < 0.9; ++i) longest = next_picture();
  EXPECT_GE(longest, 0.9) << "one picture per second";
  const auto shows_frame = [](std::uint32_t frame) {
    return [frame](const ReceivedMessage& message) { return has_state(message, "frame", frame); };
  };
  viewer->add_frame(test::row_frame(0));
  client.receive_until(shows_frame(0));
  const Stopwatch watch;
  for (std::uint32_t frame = 1; frame < 3; ++frame) {
    viewer->add_frame(test::row_frame(frame));
    client.receive_until(shows_frame(frame));
  }
  EXPECT_GE(watch.seconds(), 1.0) << "two messages, each a second after the last";
  SocketClient other{ViewerAddress(viewer->address())};
  other.receive();
  double shortest = 1e9;
  for (int i = 0; i < 200 && shortest > 0.5; ++i) shortest = std::min(shortest, next_picture());
  EXPECT_LT(shortest, 0.5) << "as often as the browser that wants most";
}

TEST_F(ViewerTest, ABrowserThatAsksForNothingGetsNothing) {
  SocketClient client(address_);
  client.receive();
  viewer_->set_map(test::row_map(1), 0.0);
  client.send("rate 0");
  client.send("pause");  // of which it would be told
  while (viewer_->wants_picture()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  EXPECT_FALSE(viewer_->wants_map());
  viewer_->add_frame(test::row_frame(0));
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  viewer_->add_frame(test::row_frame(1));
  client.send("rate 30");
  // Everything in one message.
  const ReceivedMessage message =
      client.receive_until([](const ReceivedMessage& received) { return received.json.contains("frames"); });
  EXPECT_TRUE(has_state(message, "frame", 1U));
  EXPECT_TRUE(has_state(message, "paused", true));
  EXPECT_EQ(message.json["frames"].size(), 2U);
}

TEST_F(ViewerTest, NobodyPausesTheRunAfterLeaving) {
  std::future<void> frame;
  {
    SocketClient client(address_);
    client.receive();
    pause(client);
    frame = pass_frame(0.0);
    EXPECT_FALSE(is_done(frame));
  }
  frame.get();
  viewer_->take_turn(0.1);
}

TEST_F(ViewerTest, ASignalEndsThePause) {
  static std::atomic<bool> was_called;
  was_called = false;
  std::signal(SIGUSR1, [](int) { was_called = true; });
  SocketClient client(address_);
  client.receive();
  pause(client);
  std::thread run([&] { viewer_->take_turn(0.0); });
  // The thread may not wait yet when the first signal comes.
  std::atomic<bool> ended = false;
  std::thread signals([&] {
    while (!ended) {
      pthread_kill(run.native_handle(), SIGUSR1);
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
  });
  client.receive_until([](const ReceivedMessage& message) { return has_state(message, "paused", false); });
  ended = true;
  signals.join();
  run.join();
  EXPECT_TRUE(was_called);
  std::signal(SIGUSR1, SIG_DFL);
}

TEST_F(ViewerTest, WaitsForTheFirstBrowser) {
  std::future<void> run = std::async(std::launch::async, [this] { viewer_->wait_for_browser(); });
  EXPECT_EQ(run.wait_for(std::chrono::milliseconds(50)), std::future_status::timeout);
  const SocketClient client(address_);
  run.get();
}

TEST_F(ViewerTest, AnInterruptEndsThePauseAndTheWaitForABrowser) {
  std::future<void> run = std::async(std::launch::async, [this] { viewer_->wait_for_browser(); });
  EXPECT_EQ(run.wait_for(std::chrono::milliseconds(50)), std::future_status::timeout);
  {
    SocketClient client(address_);
    run.get();
    client.receive();
    pause(client);
    std::future<void> frame = pass_frame(0.0);
    EXPECT_FALSE(is_done(frame));
    viewer_->stop_waiting();
    frame.get();
    viewer_->take_turn(0.1);  // still paused
  }
  viewer_->wait_for_browser();
}

TEST_F(ViewerTest, AcceptsOnlyTheDocumentedMessages) {
  const std::set<std::string> documented = {"pause",     "resume",  "step",    "speed 0", "speed 0.25",
                                            "speed 0.5", "speed 1", "speed 2", "speed 4", "rate 0",
                                            "rate 1",    "rate 2",  "rate 5",  "rate 10", "rate 30"};
  SocketClient witness(address_);
  witness.receive();
  Random random(7);
  const auto random_text = [&](std::size_t length) {
    std::string text;
    for (std::size_t i = 0; i < length; ++i) text += static_cast<char>(32 + static_cast<int>(random.uniform() * 95));
    return text;
  };
  for (int i = 0; i < 1000; ++i) {
    if (i % 100 == 0) {  // a browser that answers no ping for twenty seconds is gone
      viewer_->add_frame(test::row_frame(100 + static_cast<std::uint32_t>(i)));
      witness.receive_until([&](const ReceivedMessage& message) { return has_state(message, "frame", 100 + i); });
    }
    std::string text;
    const double kind = random.uniform();
    if (kind < 0.4) {
      text = random_text(static_cast<std::size_t>(random.uniform() * 70));
    } else {  // nearly documented
      text = *std::next(documented.begin(),
                        static_cast<std::ptrdiff_t>(random.uniform() * static_cast<double>(documented.size())));
      if (kind < 0.6)
        text += random_text(1);
      else if (kind < 0.8)
        text.pop_back();
      else
        text[static_cast<std::size_t>(random.uniform() * static_cast<double>(text.size()))] ^= 0x20;
    }
    const bool is_binary = kind > 0.95;
    if (documented.contains(text) && !is_binary) continue;
    SocketClient client(address_);
    client.send(text, is_binary);
    EXPECT_TRUE(client.is_ended()) << text;
  }
  viewer_->add_frame(test::row_frame(3));
  const ReceivedMessage message =
      witness.receive_until([](const ReceivedMessage& m) { return has_state(m, "frame", 3); });
  EXPECT_EQ(message.json["state"]["paused"], false);
  EXPECT_EQ(message.json["state"]["speed"], 0.0);
}

TEST_F(ViewerTest, ABrowserThatReadsNothingLosesFramesAndNotTheRun) {
  const SocketClient dead(address_);
  SocketClient alive(address_);
  alive.receive();
  MapSnapshot map;
  for (std::uint32_t i = 0; i < 100'000; ++i)
    map.points.push_back({test::point_id(i), Eigen::Vector3d(i, 0, 0), 1, 0.0F});
  ViewedPicture picture;
  picture.colour = cv::Mat(480, 640, CV_8UC3, cv::Scalar::all(99));
  for (std::uint32_t frame = 0; frame < 300; ++frame) {
    if (frame % 30 == 0) {  // all points move: the largest changes there can be
      for (MapSnapshot::Point& point : map.points) point.position.y() += 1.0;
      viewer_->set_map(map, 0.0);
    }
    viewer_->add_frame(test::row_frame(frame));
    viewer_->set_picture(picture);
    viewer_->take_turn(frame);
  }
  alive.receive_until([](const ReceivedMessage& message) { return has_state(message, "frame", 299); });
}

TEST_F(ViewerTest, RefusesMoreBrowsersThanItServes) {
  std::vector<SocketClient> clients;
  for (int i = 0; i < 8; ++i) {
    clients.emplace_back(address_);
    clients.back().receive();
  }
  EXPECT_ANY_THROW(SocketClient{address_});
  clients.pop_back();
  std::optional<SocketClient> next;
  for (int i = 0; i < 500 && !next; ++i) try {
      next.emplace(address_);
    } catch (const std::exception&) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));  // the server has not noticed yet
    }
  EXPECT_TRUE(next);
}

TEST_F(ViewerTest, ConnectionsWithoutATokenGiveWayToBrowsers) {
  SocketClient watching(address_);
  watching.receive();
  std::vector<test::SilentClient> silent;
  for (int i = 0; i < 200; ++i) silent.emplace_back(address_);
  EXPECT_THAT(test::answer_to_get(address_, "/?token=" + address_.token), StartsWith("HTTP/1.1 200 OK\r\n"));
  SocketClient another(address_);
  another.receive();
  EXPECT_TRUE(silent.front().is_closed()) << "the oldest goes first";
  EXPECT_FALSE(silent.back().is_closed());
  pause(watching);
}

TEST_F(ViewerTest, WantsPicturesAndMapsOnlyAsOftenAsTheyAreOfUse) {
  EXPECT_FALSE(viewer_->wants_picture()) << "nobody looks";
  EXPECT_TRUE(viewer_->wants_map()) << "for whoever comes";
  viewer_->set_map(test::row_map(1), 1.0);
  EXPECT_FALSE(viewer_->wants_map()) << "it cost a second";
  SocketClient client(address_);
  client.receive();
  EXPECT_TRUE(viewer_->wants_picture());
  ViewedPicture picture;
  picture.colour = cv::Mat(48, 64, CV_8UC3, cv::Scalar::all(99));
  viewer_->set_picture(picture);
  EXPECT_FALSE(viewer_->wants_picture()) << "not yet again";
}

}  // namespace
}  // namespace holdfast
