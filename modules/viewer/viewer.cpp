// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/viewer/viewer.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <mutex>
#include <optional>

#include "holdfast/core/embedded_page.hpp"
#include "holdfast/core/error.hpp"
#include "holdfast/core/stage_times.hpp"
#include "holdfast/web_server/socket_server.hpp"
#include "play_control.hpp"
#include "scene.hpp"

namespace holdfast {

std::span<const EmbeddedFile> embedded_viewer_page();

namespace {

/// Since the clock of the machine began [s].
double now() {
  static const Stopwatch watch;
  return watch.seconds();
}

std::mutex viewers_mutex;
std::vector<std::weak_ptr<Viewer>> viewers;

}  // namespace

/// What was given and not taken by the thread of the server yet.
struct Mailbox {
  std::vector<FrameResult> frames;
  std::optional<ViewedPicture> picture;
  std::optional<MapSnapshot> map;
  std::optional<std::vector<std::string>> class_names;
  std::vector<ViewedClass> classes;
  std::vector<ViewedSurface> surfaces;
  std::vector<SurfacePatch> patches;
  int patch_coarseness = 0;
  std::vector<std::pair<KeyFrameId, KeyFrameId>> loops;
  std::optional<ViewedRun> run;
};

namespace {

/// How many messages per second a browser gets at most, unless it asks for fewer.
constexpr double fastest_rate = 30.0;

}  // namespace

struct Viewer::State {
  class Browser;
  explicit State(const ViewerOptions& given)
      : options(given),
        control(given.speed),
        scene(given),
        server({.name = "viewer",
                .listen = given.listen,
                .port = given.port,
                .token = random_token(),
                .page = embedded_page(embedded_viewer_page(), "viewer.html"),
                .socket_path = "/socket",
                .is_paced = true},
               {.tick = [this] { take_mail(); }, .open = [this] { return open(); }}) {}
  ~State() { control.close(); }

  void take_mail();
  bool obey(std::string_view text);
  std::unique_ptr<SocketClient> open();
  /// After the number of browsers has changed, or the rate of one.
  void count_browsers();

  ViewerOptions options;
  viewer::PlayControl control;
  std::mutex mutex;
  Mailbox mailbox;
  std::atomic<bool> has_picture = false, has_map = false, has_patches = false;
  std::atomic<double> last_picture = -1e9, last_map = 0.0, map_cost = -1.0, last_patches = -1e9, patches_cost = 0.0;
  std::atomic<int> patch_coarseness = 0;
  std::atomic<double> rate = fastest_rate;  // of messages, of the browser that wants most
  viewer::Scene scene;                      // of the server's thread
  std::vector<const Browser*> browsers;     // the same
  SocketServer server;                      // last: its thread uses everything above
};

namespace {

/// The rate that a message asks for, nothing if it is no such message.
std::optional<double> asked_rate(std::string_view text) {
  constexpr std::array<std::pair<std::string_view, double>, 6> rates{{{"rate 0", 0.0},
                                                                      {"rate 1", 1.0},
                                                                      {"rate 2", 2.0},
                                                                      {"rate 5", 5.0},
                                                                      {"rate 10", 10.0},
                                                                      {"rate 30", fastest_rate}}};
  for (const auto& [name, rate] : rates)
    if (name == text) return rate;
  return std::nullopt;
}

}  // namespace

class Viewer::State::Browser final : public SocketClient {
 public:
  explicit Browser(Viewer::State& viewer) : viewer_(viewer) {
    viewer_.browsers.push_back(this);
    viewer_.count_browsers();
  }
  ~Browser() override {
    std::erase(viewer_.browsers, this);
    viewer_.count_browsers();
  }
  Browser(const Browser&) = delete;
  Browser& operator=(const Browser&) = delete;

  /// What the browser lacks, unless it has asked for fewer messages.
  std::optional<SocketMessage> next() override {
    if (last_sent_ && rate_ < fastest_rate && (now() - *last_sent_) * rate_ < 1.0) return std::nullopt;
    std::string bytes = viewer_.scene.update(progress_);
    if (bytes.empty()) return std::nullopt;
    last_sent_ = now();
    return SocketMessage{std::move(bytes), false};
  }
  bool receive(std::string_view message, bool is_text) override {
    if (!is_text) return false;
    const std::optional<double> rate = asked_rate(message);
    if (!rate) return viewer_.obey(message);
    rate_ = *rate;
    viewer_.count_browsers();
    return true;
  }
  double rate() const { return rate_; }

 private:
  Viewer::State& viewer_;
  viewer::Progress progress_;
  double rate_ = fastest_rate;  // most messages per second
  std::optional<double> last_sent_;
};

std::unique_ptr<SocketClient> Viewer::State::open() { return std::make_unique<Browser>(*this); }

void Viewer::State::count_browsers() {
  double fastest = 0.0;
  for (const Browser* browser : browsers) fastest = std::max(fastest, browser->rate());
  if (!browsers.empty()) rate = fastest;
  control.set_watchers(static_cast<int>(browsers.size()));
}

void Viewer::State::take_mail() {
  Mailbox mail;
  {
    const std::lock_guard lock(mutex);
    std::swap(mail, mailbox);
  }
  if (mail.class_names) scene.set_classes(std::move(*mail.class_names));
  if (!mail.classes.empty()) scene.add(mail.classes);
  if (mail.map) scene.set_map(*mail.map);
  for (ViewedSurface& surface : mail.surfaces) scene.add(std::move(surface));
  const bool brings_patches = !mail.patches.empty();
  if (brings_patches) scene.add(std::move(mail.patches), mail.patch_coarseness);
  patch_coarseness = scene.mesh_coarseness();
  for (const FrameResult& frame : mail.frames) scene.add(frame);
  for (const auto& [keyframe, candidate] : mail.loops) scene.add_loop(keyframe, candidate);
  if (mail.picture) scene.set_picture(*mail.picture);
  if (mail.run) scene.set_run(std::move(*mail.run));
  // Only now is another one wanted: whoever makes pictures and maps does not run ahead of this thread.
  if (mail.picture) has_picture = false;
  if (mail.map) has_map = false;
  if (brings_patches) has_patches = false;
  scene.set_play({control.is_paused(), control.speed(), control.watchers()});
}

bool Viewer::State::obey(std::string_view text) {
  if (text == "pause")
    control.pause();
  else if (text == "resume")
    control.resume();
  else if (text == "step")
    control.step();
  else {
    constexpr std::array<std::pair<std::string_view, double>, 6> speeds{{{"speed 0", 0.0},
                                                                         {"speed 0.25", 0.25},
                                                                         {"speed 0.5", 0.5},
                                                                         {"speed 1", 1.0},
                                                                         {"speed 2", 2.0},
                                                                         {"speed 4", 4.0}}};
    const auto* const speed =
        std::find_if(speeds.begin(), speeds.end(), [&](const auto& s) { return s.first == text; });
    if (speed == speeds.end()) return false;
    control.set_speed(speed->second);
  }
  return true;
}

std::shared_ptr<Viewer> Viewer::start(const ViewerOptions& options) {
  std::shared_ptr<Viewer> viewer(new Viewer(options));
  const std::lock_guard lock(viewers_mutex);
  std::erase_if(viewers, [](const std::weak_ptr<Viewer>& other) { return other.expired(); });
  viewers.push_back(viewer);
  return viewer;
}

Viewer::Viewer(const ViewerOptions& options) : state_(std::make_unique<State>(options)) {}
Viewer::~Viewer() = default;

const std::string& Viewer::address() const { return state_->server.address(); }
bool Viewer::is_watched() const { return state_->control.watchers() > 0; }

void Viewer::add_frame(const FrameResult& result) {
  const std::lock_guard lock(state_->mutex);
  state_->mailbox.frames.push_back(result);
}

bool Viewer::wants_picture() const {
  if (!is_watched() || state_->has_picture) return false;
  return now() >= state_->last_picture + 1.0 / std::min<double>(state_->options.picture_rate, state_->rate);
}

void Viewer::set_picture(ViewedPicture picture) {
  state_->last_picture = now();
  state_->has_picture = true;
  const std::lock_guard lock(state_->mutex);
  state_->mailbox.picture = std::move(picture);
}

bool Viewer::wants_map() const {
  if (state_->has_map) return false;
  const double cost = state_->map_cost;
  if (cost < 0.0) return true;
  const double pause = is_watched() ? std::max({0.2, 1.0 / state_->rate, 50.0 * cost}) : std::max(2.0, 1000.0 * cost);
  return now() >= state_->last_map + pause;
}

void Viewer::set_map(MapSnapshot map, double seconds) {
  state_->map_cost = seconds;
  state_->last_map = now();
  state_->has_map = true;
  const std::lock_guard lock(state_->mutex);
  state_->mailbox.map = std::move(map);
}

void Viewer::set_classes(std::vector<std::string> names) {
  const std::lock_guard lock(state_->mutex);
  state_->mailbox.class_names = std::move(names);
}

void Viewer::add_point_classes(std::vector<ViewedClass> classes) {
  const std::lock_guard lock(state_->mutex);
  std::vector<ViewedClass>& kept = state_->mailbox.classes;
  kept.insert(kept.end(), classes.begin(), classes.end());
}

void Viewer::add_surface(ViewedSurface surface) {
  const std::lock_guard lock(state_->mutex);
  state_->mailbox.surfaces.push_back(std::move(surface));
}

bool Viewer::wants_patches() const {
  if (!is_watched() || state_->has_patches) return false;
  return now() >= state_->last_patches + std::max({1.0, 1.0 / state_->rate, 20.0 * state_->patches_cost});
}

int Viewer::patch_coarseness() const { return state_->patch_coarseness; }

void Viewer::add_patches(std::vector<SurfacePatch> patches, int coarseness, double seconds) {
  state_->patches_cost = seconds;
  state_->last_patches = now();
  if (patches.empty()) return;
  state_->has_patches = true;
  const std::lock_guard lock(state_->mutex);
  std::vector<SurfacePatch>& kept = state_->mailbox.patches;
  if (std::exchange(state_->mailbox.patch_coarseness, coarseness) != coarseness) kept.clear();
  kept.insert(kept.end(), std::make_move_iterator(patches.begin()), std::make_move_iterator(patches.end()));
}

void Viewer::add_loop(KeyFrameId keyframe, KeyFrameId candidate) {
  const std::lock_guard lock(state_->mutex);
  state_->mailbox.loops.emplace_back(keyframe, candidate);
}

void Viewer::set_run(ViewedRun run) {
  const std::lock_guard lock(state_->mutex);
  state_->mailbox.run = std::move(run);
}

void Viewer::take_turn(double timestamp) { state_->control.take_turn(timestamp); }
void Viewer::wait_for_browser() { state_->control.wait_for_watcher(); }
void Viewer::stop_waiting() { state_->control.close(); }

std::vector<std::shared_ptr<Viewer>> running_viewers() {
  const std::lock_guard lock(viewers_mutex);
  std::vector<std::shared_ptr<Viewer>> running;
  for (const std::weak_ptr<Viewer>& viewer : viewers)
    if (std::shared_ptr<Viewer> alive = viewer.lock()) running.push_back(std::move(alive));
  return running;
}

}  // namespace holdfast
