// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/bridge/bridge.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <future>
#include <mutex>
#include <thread>
#include <utility>

#include "conversions.hpp"
#include "diagnosis.hpp"
#include "frame_queue.hpp"
#include "holdfast/core/error.hpp"
#include "holdfast/core/stage_times.hpp"
#include "holdfast/map_io/map_file.hpp"
#include "inertial_buffer.hpp"
#include "session.hpp"
#ifdef HOLDFAST_WEB_SERVER
#include "holdfast/web_server/socket_server.hpp"
#endif

namespace holdfast::bridge {

namespace {

using Level = Diagnostics::Level;
using SessionPointer = std::shared_ptr<Session>;

/// Looks along x, as REP 103 has it: z forward and y down of the optical frame.
Eigen::Isometry3d ahead_camera() {
  Eigen::Isometry3d T_base_camera = Eigen::Isometry3d::Identity();
  T_base_camera.linear() << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  return T_base_camera;
}

/// Throws for numbers that cannot be.
const Parameters& checked(const Parameters& given) {
  const auto refuse = [](const char* name, double value, const char* expected) {
    throw InputError({std::string("parameter '") + name + "'"},
                     "found " + std::to_string(value) + "; expected " + expected);
  };
  constexpr double longest = 1e6;  // s
  if (!(given.tolerance >= 0.0 && given.tolerance <= longest)) refuse("tolerance", given.tolerance, "0 s or more");
  if (!(given.depth_factor >= 1e-3 && given.depth_factor <= 1e6))
    refuse("depth_factor", given.depth_factor, "the value of one metre in depth images, such as 1000");
  if (given.queue < 1) refuse("queue", given.queue, "1 frame or more");
  if (!(given.map_interval > 0.0 && given.map_interval <= longest))
    refuse("map_interval", given.map_interval, "more than 0 s");
  if (!(given.grid_interval > 0.0 && given.grid_interval <= longest))
    refuse("grid_interval", given.grid_interval, "more than 0 s");
  return given;
}

/// While it lives, observers do not wait for somebody, such as a browser, because their session is to end.
class EndWish {
 public:
  explicit EndWish(std::atomic<int>& count) : count_(count) { ++count_; }
  ~EndWish() { --count_; }
  EndWish(const EndWish&) = delete;
  EndWish& operator=(const EndWish&) = delete;

 private:
  std::atomic<int>& count_;
};

}  // namespace

/// The members above the threads are used by several of them: those with a mutex beside them are guarded by it.
struct Bridge::State {
  State(const Parameters& given, Listener& to_tell)
      : parameters(checked(given)),
        listener(to_tell),
        configuration(read_bridge_configuration(parameters, registry)),
        pairing(given.has_depth, given.has_right, static_cast<Stamp>(1e9 * given.tolerance)),
        frames(given.is_sequential ? 0 : static_cast<std::size_t>(given.queue)),
        map_file(given.map_file),
        localise_only(given.localise_only) {
    if (!map_file.empty()) read_map(map_file);  // throws for one that cannot be used
    camera = configuration.camera;
    for (const Diagnostic& warning : configuration.warnings) tell(Level::warning, warning.to_string());
    frame_thread = std::thread([this] { run_frames(); });
    map_thread = std::thread([this] { run_maps(); });
  }
  ~State() {
    frames.stop();
    {
      const std::lock_guard lock(map_mutex);
      is_stopped = true;
    }
    map_changed.notify_all();
    ++ends_wanted;
    interrupt_session();
    frame_thread.join();
    map_thread.join();
  }

  // Images, by any thread.
  template <class Convert>
  void add_image(ImageKind kind, Stamp stamp, std::uint64_t BridgeCounts::*counter, const Convert& convert);
  void set_camera(const CameraInfo& info);
  void accept_time(Stamp stamp);
  void tell(Level level, const std::string& text) {
    const std::lock_guard lock(tell_mutex);
    listener.on_message(level, text);
  }
  template <class Change>
  void count(const Change& change) {
    const std::lock_guard lock(count_mutex);
    change(counts);
  }

  // The thread of the frames.
  void run_frames();
  void process(ImageSet frame);
  SessionPointer begin_session();
  void end_session();
  void tell_addresses();
  void begin_with(const std::string& file, bool localises);
  /// Any other thread: lets the thread of the frames call begin_with(), also where a session waits for somebody.
  void request_begin_with(const std::string& file, bool localises) {
    std::optional<EndWish> wish(std::in_place, ends_wanted);
    interrupt_session();
    // The wish ends in that thread: the session that begins next is not to be interrupted.
    frames.request([&] {
      wish.reset();
      begin_with(file, localises);
    });
  }
  /// With ends_wanted above 0, so that the observers of a session that begins meanwhile do not wait either.
  void interrupt_session() {
    if (const SessionPointer current = session_now()) current->pipeline().interrupt();
  }
  std::vector<ImuSample> take_inertia(const ImageSet& frame);
  void record(const FrameOutput& output);

  /// With camera_mutex held.
  bool knows_camera() const { return camera && (!parameters.has_right || baseline || configuration.camera); }

  // The thread of the maps.
  void run_maps();
  void give_maps(Session& current, bool with_grid);

  SessionPointer session_now() const {
    const std::lock_guard lock(session_mutex);
    return session;
  }
  BridgeStatus status() const;

  const Parameters parameters;
  Listener& listener;
  std::mutex tell_mutex;
  Registry registry;
  const Configuration configuration;
  const Stopwatch clock;

  std::mutex pairing_mutex;
  ImagePairing pairing;
  FrameQueue frames;

  mutable std::mutex camera_mutex;
  std::optional<Camera> camera;
  std::optional<double> baseline;  // of camera_info of the right camera
  bool has_compared_camera = false;
  std::atomic<bool> has_told_camera = false;  // that a camera_info cannot be used
  Eigen::Isometry3d T_base_camera = ahead_camera();

  std::mutex inertia_mutex;
  std::condition_variable inertia_came;
  InertialBuffer inertia;

  mutable std::mutex count_mutex;
  BridgeCounts counts;
  std::string failure;

  mutable std::mutex session_mutex;
  SessionPointer session;
  // Used by the thread of the frames: what the next session begins with, and whether there is no use in trying.
  std::string map_file;
  bool localise_only = false;
  bool cannot_begin = false;
  std::future<void> session_end;  // of `session`
  std::atomic<int> ends_wanted = 0;
  std::atomic<bool> is_paused = false;

  std::mutex map_mutex;
  std::condition_variable map_changed;
  bool is_stopped = false;
  std::mutex output_mutex;  // held while maps are given out

  std::thread frame_thread, map_thread;
};

template <class Convert>
void Bridge::State::add_image(ImageKind kind, Stamp stamp, std::uint64_t BridgeCounts::*counter,
                              const Convert& convert) {
  count([&](BridgeCounts& c) { ++(c.*counter); });
  if (is_paused) return;
  try {
    StampedImage image{stamp, {}, clock.seconds()};
    image.image = convert();
    const std::lock_guard lock(pairing_mutex);
    if (kind == ImageKind::colour) accept_time(stamp);
    pairing.add(kind, std::move(image));
    while (std::optional<ImageSet> frame = pairing.next()) frames.push(std::move(*frame));
    const std::uint64_t unpaired = pairing.unpaired();
    count([&](BridgeCounts& c) { c.unpaired = unpaired; });
  } catch (const std::exception& error) {
    count([](BridgeCounts& c) { ++c.unusable; });
    tell(Level::error, error.what());
  }
}

/// Begins anew where time goes back, as when a bag is played again.
void Bridge::State::accept_time(Stamp stamp) {
  constexpr Stamp second = 1'000'000'000;
  const std::optional<Stamp> last = pairing.last_stamp();
  if (!last || stamp >= *last - second) return;
  pairing.clear();
  frames.clear();
  {
    const std::lock_guard lock(inertia_mutex);
    inertia.clear();
  }
  // Its frames have other times; the thread of the frames sees the first of them.
  tell(Level::warning, "time went back: a new map begins");
}

void Bridge::State::set_camera(const CameraInfo& info) {
  std::string difference;
  try {
    const std::lock_guard lock(camera_mutex);
    if (has_compared_camera) return;
    const Camera told = camera_of(info, parameters.is_rectified || parameters.has_right);
    has_compared_camera = true;
    if (!camera)
      camera = told;
    else
      difference = difference_of(*camera, told);
  } catch (const std::exception& error) {
    if (!has_told_camera.exchange(true)) tell(Level::error, error.what());  // once: it comes with every image
  }
  if (!difference.empty()) tell(Level::warning, difference);
}

void Bridge::State::run_frames() {
  while (std::optional<ImageSet> frame = frames.next()) {
    try {
      process(std::move(*frame));
    } catch (const InputError& error) {
      count([](BridgeCounts& c) { ++c.unusable; });
      tell(Level::error, std::string("frame left out: ") + error.what());
    } catch (const std::exception& error) {
      end_session();
      {
        const std::lock_guard lock(count_mutex);
        failure = error.what();
        ++counts.unusable;
      }
      tell(Level::error, error.what());
    }
  }
  end_session();
}

void Bridge::State::process(ImageSet frame) {
  if (is_paused) return;
  SessionPointer current = session_now();
  if (current && current->is_before_last(frame.colour.stamp)) {
    current.reset();  // end_session() waits for all who use it
    end_session();
  }
  if (!current && !cannot_begin) {
    cannot_begin = true;  // unless it succeeds: the next frame would fail as well
    try {
      current = begin_session();
    } catch (const InputError& error) {
      throw Error(error.what());  // of a map or a network, no fault of the frame
    }
    cannot_begin = false;
  }
  if (!current) return;
  Eigen::Isometry3d T_base_camera_now;
  {
    const std::lock_guard lock(camera_mutex);
    T_base_camera_now = T_base_camera;
  }
  FrameOutput output =
      current->add_frame(frame, take_inertia(frame), T_base_camera_now, listener.odometry(frame.colour.stamp));
  output.latency = clock.seconds() - frame.arrival();
  listener.on_frame(output);
  output.latency = clock.seconds() - frame.arrival();  // with the publishing
  record(output);
}

SessionPointer Bridge::State::begin_session() {
  SourceDescription source;
  {
    const std::lock_guard lock(camera_mutex);
    if (!knows_camera()) return nullptr;
    source.camera = camera;
    if (parameters.has_right && baseline && !configuration.camera) source.camera->baseline = *baseline;
  }
  source.name = "bridge";
  source.has_depth = parameters.has_depth;
  source.has_right = parameters.has_right;
  source.has_imu = configuration.imu.has_value();
  auto made =
      std::make_unique<Session>(SessionStart{configuration, registry, parameters, source, map_file, localise_only});
  std::promise<void> end;
  std::future<void> end_of_begun = end.get_future();
  const SessionPointer begun(made.release(), [end = std::move(end)](const Session* ended) mutable {
    delete ended;
    end.set_value();
  });
  for (const Diagnostic& warning : begun->warnings()) tell(Level::warning, warning.to_string());
  {
    const std::lock_guard lock(count_mutex);
    failure.clear();
  }
  tell_addresses();
  {
    const std::lock_guard lock(session_mutex);
    session = begun;
    session_end = std::move(end_of_begun);
  }
  if (ends_wanted > 0) begun->pipeline().interrupt();
  return begun;
}

/// Waits until the threads of the session have ended and its ports are free, also where others still use it.
void Bridge::State::end_session() {
  {
    SessionPointer ended;  // its threads end without the lock
    const std::lock_guard lock(session_mutex);
    ended.swap(session);
  }
  if (session_end.valid()) session_end.get();
}

/// Where observers such as `foxglove` can be reached; their addresses have a secret.
void Bridge::State::tell_addresses() {
#ifdef HOLDFAST_WEB_SERVER
  for (const auto& [name, address] : running_servers()) tell(Level::ok, name + ": " + address);
#endif
}

/// The next frame begins a session with this map, or a new one without it.
void Bridge::State::begin_with(const std::string& file, bool localises) {
  end_session();
  map_file = file;
  localise_only = localises;
  cannot_begin = false;
}

std::vector<ImuSample> Bridge::State::take_inertia(const ImageSet& frame) {
  if (!configuration.imu) return {};
  // A sequential run gives the same poses again, so that it waits longer for what is on its way.
  const std::chrono::milliseconds patience(parameters.is_sequential ? 1000 : 50);
  const double timestamp = seconds(frame.colour.stamp);
  std::unique_lock lock(inertia_mutex);
  inertia_came.wait_for(lock, patience, [&] { return inertia.reaches(timestamp); });
  return inertia.take(timestamp);
}

void Bridge::State::record(const FrameOutput& output) {
  double period = 0.0;
  {
    const std::lock_guard lock(camera_mutex);
    period = 1.0 / camera->frame_rate;
  }
  count([&](BridgeCounts& c) {
    ++c.answered;
    c.with_pose += output.has_pose ? 1U : 0U;
    c.late += output.latency > period ? 1U : 0U;
    c.latency = output.latency;
    c.largest_latency = std::max(c.largest_latency, output.latency);
  });
}

void Bridge::State::run_maps() {
  using Clock = std::chrono::steady_clock;
  const auto interval = std::chrono::duration<double>(parameters.map_interval);
  Clock::time_point last_grid{};
  std::unique_lock lock(map_mutex);
  while (!is_stopped) {
    map_changed.wait_for(lock, interval, [&] { return is_stopped; });
    if (is_stopped) return;
    lock.unlock();
    if (const SessionPointer current = session_now(); current && current->take_map_change()) {
      const bool has_waited = Clock::now() - last_grid >= std::chrono::duration<double>(parameters.grid_interval);
      give_maps(*current, has_waited);
      if (has_waited)
        last_grid = Clock::now();
      else
        current->keep_map_change();  // for the grid that is due later
    }
    lock.lock();
  }
}

void Bridge::State::give_maps(Session& current, bool with_grid) try {
  const std::lock_guard lock(output_mutex);
  if (const std::optional<MapOutput> map = current.map_output()) listener.on_map(*map);
  if (!with_grid) return;
  if (const std::optional<GridOutput> grid = current.grid_output()) listener.on_grid(*grid);
} catch (const std::exception& error) {
  tell(Level::error, std::string("no map was made: ") + error.what());
}

BridgeStatus Bridge::State::status() const {
  BridgeStatus status;
  {
    const std::lock_guard lock(count_mutex);
    status.counts = counts;
    status.failure = failure;
  }
  status.counts.dropped = frames.dropped();
  status.is_paused = is_paused;
  {
    const std::lock_guard lock(camera_mutex);
    status.needs_camera = !knows_camera();
  }
  if (const SessionPointer current = session_now()) {
    status.health = current->pipeline().health();
    status.keyframes = current->keyframes();
  }
  return status;
}

Bridge::Bridge(const Parameters& parameters, Listener& listener)
    : state_(std::make_unique<State>(parameters, listener)) {}
Bridge::~Bridge() = default;

void Bridge::add_colour(const RawImage& image) {
  state_->add_image(ImageKind::colour, image.stamp, &BridgeCounts::colour, [&] { return colour_of(image); });
}
void Bridge::add_colour(const CompressedImage& image) {
  state_->add_image(ImageKind::colour, image.stamp, &BridgeCounts::colour, [&] { return colour_of(image); });
}
void Bridge::add_depth(const RawImage& image) {
  const double factor = state_->parameters.depth_factor;
  state_->add_image(ImageKind::depth, image.stamp, &BridgeCounts::depth, [&] { return depth_of(image, factor); });
}
void Bridge::add_depth(const CompressedImage& image) {
  const double factor = state_->parameters.depth_factor;
  state_->add_image(ImageKind::depth, image.stamp, &BridgeCounts::depth, [&] { return depth_of(image, factor); });
}
void Bridge::add_right(const RawImage& image) {
  state_->add_image(ImageKind::right, image.stamp, &BridgeCounts::right, [&] { return colour_of(image); });
}
void Bridge::add_right(const CompressedImage& image) {
  state_->add_image(ImageKind::right, image.stamp, &BridgeCounts::right, [&] { return colour_of(image); });
}

void Bridge::add_inertia(const InertialSample& sample) {
  state_->count([](BridgeCounts& c) { ++c.inertia; });
  if (!state_->configuration.imu || state_->is_paused) return;
  const double timestamp = seconds(sample.stamp) - state_->configuration.imu->time_offset;
  {
    const std::lock_guard lock(state_->inertia_mutex);
    state_->inertia.add({timestamp, sample.angular_velocity, sample.acceleration});
  }
  state_->inertia_came.notify_all();
}

void Bridge::set_camera(const CameraInfo& info) { state_->set_camera(info); }

void Bridge::set_right_camera(const CameraInfo& info) {
  const std::lock_guard lock(state_->camera_mutex);
  state_->baseline = baseline_of(info);
}

void Bridge::set_camera_pose(const Eigen::Isometry3d& T_base_camera) {
  const std::lock_guard lock(state_->camera_mutex);
  state_->T_base_camera = T_base_camera;
}

void Bridge::pause(bool is_paused) { state_->is_paused = is_paused; }
bool Bridge::is_paused() const { return state_->is_paused; }

void Bridge::reset() { state_->request_begin_with({}, false); }

void Bridge::save_map(const std::string& file) {
  if (file.empty()) throw Error("no file to save the map in; give its name");
  const SessionPointer current = state_->session_now();
  if (!current) throw Error("there is no map yet to be saved in " + file);
  current->pipeline().save_map(file);
}

void Bridge::load_map(const std::string& file, bool localise_only) {
  if (file.empty()) throw Error("no file to load a map from; give its name");
  read_map(file);  // throws for one that cannot be used, and the run goes on
  state_->request_begin_with(file, localise_only);
}

void Bridge::finish() {
  state_->frames.wait_until_idle();
  if (const SessionPointer current = state_->session_now()) state_->give_maps(*current, true);
}

Diagnostics Bridge::diagnostics() const { return diagnose(state_->status()); }

std::vector<std::string> Bridge::warnings() const {
  std::vector<std::string> sentences;
  const SessionPointer current = state_->session_now();
  for (const Diagnostic& warning : current ? current->warnings() : state_->configuration.warnings)
    sentences.push_back(warning.to_string());
  return sentences;
}

}  // namespace holdfast::bridge
