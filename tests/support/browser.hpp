// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <fcntl.h>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace holdfast::test {

/// A Chromium of this machine; nothing where there is none.
inline std::optional<std::filesystem::path> find_browser() {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path == nullptr ? "" : path);
  for (std::string folder; std::getline(folders, folder, ':');)
    for (const char* name : {"chromium", "chromium-browser", "google-chrome"})
      if (access((folder + "/" + name).c_str(), X_OK) == 0) return std::filesystem::path(folder) / name;
  return std::nullopt;
}

/// Whether pages draw with WebGL. The library that draws it in place of a graphics card draws everything else, too, in
/// which lines that lie upon each other leave no trace of the lower one.
enum class BrowserDrawing { plain, webgl };

/// A page in a headless Chromium that reaches nothing beyond this machine and draws without a graphics card, driven by
/// real input events over the DevTools protocol: its messages go through a pair of pipes, each ended by a zero byte.
class Browser {
 public:
  Browser(const std::filesystem::path& program, const std::filesystem::path& profile,
          BrowserDrawing drawing = BrowserDrawing::plain) {
    int to_browser[2], from_browser[2];
    if (pipe(to_browser) != 0 || pipe(from_browser) != 0) throw std::runtime_error("no pipe");
    process_ = fork();
    if (process_ == 0) {
      // The browser reads from descriptor 3 and writes to 4; first out of the way of these two.
      const int input = fcntl(to_browser[0], F_DUPFD, 10), output = fcntl(from_browser[1], F_DUPFD, 10);
      dup2(input, 3), dup2(output, 4);
      const int nothing = open("/dev/null", O_RDWR);
      dup2(nothing, 1), dup2(nothing, 2);
      setpgid(0, 0);
      const std::string folder = "--user-data-dir=" + profile.string();
      const bool is_plain = drawing == BrowserDrawing::plain;
      execl(program.c_str(), program.c_str(), "--headless", "--no-sandbox",
            is_plain ? "--disable-gpu" : "--use-angle=swiftshader",
            is_plain ? "--mute-audio" : "--enable-unsafe-swiftshader", "--disable-dev-shm-usage", "--no-first-run",
            "--disable-background-networking", "--host-resolver-rules=MAP * ~NOTFOUND, EXCLUDE 127.0.0.1",
            "--remote-debugging-pipe", "--window-size=1280,900", folder.c_str(), static_cast<char*>(nullptr));
      _exit(127);
    }
    close(to_browser[0]), close(from_browser[1]);
    input_ = to_browser[1], output_ = from_browser[0];
    const Json target = call("Target.createTarget", {{"url", "about:blank"}});
    session_ = call("Target.attachToTarget", {{"targetId", target.at("targetId")}, {"flatten", true}}).at("sessionId");
    for (const char* domain : {"Page.enable", "Runtime.enable", "Log.enable"}) call(domain);
  }
  ~Browser() {
    close(input_), close(output_);
    kill(-process_, SIGKILL);
    kill(process_, SIGKILL);
    waitpid(process_, nullptr, 0);
  }
  Browser(const Browser&) = delete;
  Browser& operator=(const Browser&) = delete;

  void open_page(const std::string& address) {
    // A page that only differs in its fragment would not be loaded again.
    call("Page.navigate", {{"url", "about:blank"}});
    call("Page.navigate", {{"url", address}});
    for (int i = 0; i < 600; ++i) {
      if (evaluate("document.readyState + ' ' + (location.href !== 'about:blank')") == "complete true") return;
      usleep(50'000);
    }
    throw std::runtime_error("the page does not load");
  }
  /// The value of an expression in the page.
  nlohmann::json evaluate(const std::string& expression) {
    const Json answer = call("Runtime.evaluate", {{"expression", expression}, {"returnByValue", true}});
    if (answer.contains("exceptionDetails")) throw std::runtime_error(answer.dump());
    return answer.at("result").contains("value") ? answer.at("result").at("value") : Json(nullptr);
  }
  /// The size of the window [px], and whether the system asks for dark pages.
  void show_at(int width, int height, bool is_dark) {
    call("Emulation.setDeviceMetricsOverride",
         {{"width", width}, {"height", height}, {"deviceScaleFactor", 1}, {"mobile", false}});
    call("Emulation.setEmulatedMedia",
         {{"features", {{{"name", "prefers-color-scheme"}, {"value", is_dark ? "dark" : "light"}}}}});
  }
  /// Presses the mouse's button on the middle of the element that an expression gives.
  void click(const std::string& element) {
    const Json place =
        evaluate("(() => { const e = " + element +
                 "; e.scrollIntoView({block: 'center', inline: 'center'}); const r = e.getBoundingClientRect(); "
                 "return [r.x + r.width / 2, r.y + r.height / 2]; })()");
    for (const char* type : {"mousePressed", "mouseReleased"})
      call("Input.dispatchMouseEvent",
           {{"type", type}, {"x", place[0]}, {"y", place[1]}, {"button", "left"}, {"clickCount", 1}});
  }
  void press_enter() { press("Enter", "Enter", 13, "\r"); }
  void press_space() { press(" ", "Space", 32, " "); }
  void press_left() { press("ArrowLeft", "ArrowLeft", 37); }
  void press_right() { press("ArrowRight", "ArrowRight", 39); }
  /// What pages complained about: exceptions, refused content, failed requests.
  const std::vector<std::string>& complaints() const { return complaints_; }

 private:
  using Json = nlohmann::json;

  void press(const char* key, const char* code, int number, const char* text = nullptr) {
    Json event = {{"type", "keyDown"}, {"key", key}, {"code", code}, {"windowsVirtualKeyCode", number}};
    if (text != nullptr) event["text"] = text;
    call("Input.dispatchKeyEvent", event);
    event.erase("text");
    event["type"] = "keyUp";
    call("Input.dispatchKeyEvent", event);
  }
  Json call(const std::string& method, const Json& parameters = Json::object()) {
    Json message = {{"id", ++last_id_}, {"method", method}, {"params", parameters}};
    if (!session_.empty()) message["sessionId"] = session_;
    const std::string text = message.dump();
    if (write(input_, text.c_str(), text.size() + 1) != static_cast<ssize_t>(text.size() + 1))
      throw std::runtime_error("the browser does not listen");
    for (;;) {
      const Json answer = Json::parse(next_message());
      if (answer.value("id", 0) == last_id_) {
        if (answer.contains("error")) throw std::runtime_error(method + ": " + answer.at("error").dump());
        return answer.at("result");
      }
      const std::string event = answer.value("method", "");
      if (event == "Runtime.exceptionThrown" || event == "Log.entryAdded") complaints_.push_back(answer.dump());
    }
  }
  std::string next_message() {
    for (;;) {
      if (const std::size_t end = received_.find('\0'); end != std::string::npos) {
        std::string message = received_.substr(0, end);
        received_.erase(0, end + 1);
        return message;
      }
      pollfd ready{output_, POLLIN, 0};
      char buffer[65536];
      const ssize_t count = ::poll(&ready, 1, 120'000) == 1 ? read(output_, buffer, sizeof(buffer)) : 0;
      if (count <= 0) throw std::runtime_error("the browser does not answer");
      received_.append(buffer, static_cast<std::size_t>(count));
    }
  }

  pid_t process_ = -1;
  int input_ = -1, output_ = -1, last_id_ = 0;
  std::string session_, received_;
  std::vector<std::string> complaints_;
};

}  // namespace holdfast::test
