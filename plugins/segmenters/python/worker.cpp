// SPDX-License-Identifier: BSD-3-Clause
// The process of a Python segmenter: makes it as the first message says, then answers each frame with its segmentation.
// It ends when its socket is closed, whatever Python is doing.
#include <poll.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <thread>

#include "holdfast/core/error.hpp"
#include "holdfast/interfaces/segmenter.hpp"
#include "holdfast/plugin/loader.hpp"
#include "messages.hpp"
#include "settings.hpp"

using namespace holdfast;
using namespace holdfast::python_plugin;

namespace {

constexpr int socket_number = 3;

/// Ends the process when the other end of its socket was closed, as when the program that started it is gone; but
/// leaves it a second to end by itself.
void end_with_the_program() {
  pollfd waiting = {socket_number, POLLRDHUP, 0};
  while (poll(&waiting, 1, -1) <= 0) {
  }
  sleep(1);
  _exit(0);
}

std::string error_message(const std::exception& error) {
  const auto* input = dynamic_cast<const InputError*>(&error);
  const SourceLocation location = input != nullptr ? input->location() : SourceLocation{};
  std::string text = error.what();
  const std::string place = location.to_string() + ": ";
  if (!location.file.empty() && text.starts_with(place)) text.erase(0, place.size());
  MessageWriter message(Message::error);
  message.text(location.file);
  message.number(location.line), message.number(location.column);
  message.text(text);
  return message.bytes();
}

std::unique_ptr<Segmenter> make_segmenter(MessageReader& order, Registry& registry) {
  PythonSettings settings;
  settings.file = order.text();
  settings.colour_order = order.text();
  settings.parameters.resize(static_cast<std::size_t>(order.number()));
  for (auto& [name, value] : settings.parameters) name = order.text(), value = order.text();
  load_plugin(registry,
              (std::filesystem::read_symlink("/proc/self/exe").parent_path() / "libholdfast_python.so").string());
  return registry.create<Segmenter>("python", ParameterTable<PythonSettings>().values(settings), {});
}

std::string ready_message(const Segmenter& segmenter) {
  MessageWriter message(Message::ready);
  for (const std::vector<std::string>& names : {segmenter.classes(), segmenter.movable()}) {
    message.number(static_cast<std::int64_t>(names.size()));
    for (const std::string& name : names) message.text(name);
  }
  return message.bytes();
}

std::string segmentation_message(const Segmentation& segmentation) {
  MessageWriter message(Message::segmentation);
  for (const cv::Mat* image : {&segmentation.labels, &segmentation.confidence, &segmentation.instances})
    message.image(*image);
  message.number(static_cast<std::int64_t>(segmentation.found.size()));
  for (const Instance& instance : segmentation.found) {
    message.number(instance.label);
    message.real(instance.score);
    for (const float side : {instance.box.x, instance.box.y, instance.box.width, instance.box.height})
      message.real(side);
  }
  return message.bytes();
}

void work(Registry& registry) {
  std::string bytes;
  if (receive_message(socket_number, 0.0, bytes) != Arrival::arrived) return;
  MessageReader order(std::move(bytes));
  const std::unique_ptr<Segmenter> segmenter = make_segmenter(order, registry);
  send_message(socket_number, ready_message(*segmenter));
  while (receive_message(socket_number, 0.0, bytes) == Arrival::arrived) {
    MessageReader message(std::move(bytes));
    SensorFrame frame;
    frame.index = static_cast<decltype(frame.index)>(message.number());
    frame.colour = message.image();
    std::string answer;
    try {
      answer = segmentation_message(segmenter->segment(frame));
    } catch (const std::exception& error) {
      answer = error_message(error);
    }
    send_message(socket_number, answer);
  }
}

}  // namespace

int main() {
  pollfd given = {socket_number, 0, 0};
  if (poll(&given, 1, 0) < 0 || (given.revents & POLLNVAL) != 0) {
    std::fputs("holdfast_python_worker: the segmenter `python` starts it, with `process: own`\n", stderr);
    return 2;
  }
  std::signal(SIGINT, SIG_IGN);  // of the terminal: the program decides
  std::thread(end_with_the_program).detach();
  Registry registry;
  try {
    work(registry);
  } catch (const std::exception& error) {
    send_message(socket_number, error_message(error));
  }
  return 0;
}
