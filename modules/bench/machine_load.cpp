// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/bench/machine_load.hpp"

#include <unistd.h>

#include <fstream>
#include <iterator>
#include <sstream>
#include <thread>

namespace holdfast {

namespace {

std::string text_of_file(const char* name) {
  std::ifstream stream(name);
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

}  // namespace

MachineLoad parse_machine_load(const std::string& loadavg, const std::string& stat, double ticks_per_second) {
  MachineLoad load;
  if (double average = 0.0; std::istringstream(loadavg) >> average) load.load_average = average;
  // cpu user nice system idle iowait irq softirq steal ...; guests are part of user.
  std::istringstream words(stat);
  std::string name;
  double ticks[8];
  if (!(words >> name) || name != "cpu") return load;
  for (double& each : ticks)
    if (!(words >> each)) return load;
  load.busy_seconds = (ticks[0] + ticks[1] + ticks[2] + ticks[5] + ticks[6] + ticks[7]) / ticks_per_second;
  return load;
}

MachineLoad machine_load() {
  return parse_machine_load(text_of_file("/proc/loadavg"), text_of_file("/proc/stat"),
                            static_cast<double>(sysconf(_SC_CLK_TCK)));
}

std::string machine_name() {
  std::ifstream stream("/proc/cpuinfo");
  std::string processor = "unknown processor";
  for (std::string line; std::getline(stream, line);)
    if (line.starts_with("model name")) {
      const std::size_t colon = line.find(": ");
      if (colon != std::string::npos) processor = line.substr(colon + 2);
      break;
    }
  return processor + ", " + std::to_string(std::thread::hardware_concurrency()) + " cores";
}

}  // namespace holdfast
