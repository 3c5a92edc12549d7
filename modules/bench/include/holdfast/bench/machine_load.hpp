// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>
#include <string>

namespace holdfast {

/// Load of the machine; NaN if unknown.
struct MachineLoad {
  double load_average = std::numeric_limits<double>::quiet_NaN();  ///< over the last minute
  /// Time that all processors together spent with work since the machine was started [s].
  double busy_seconds = std::numeric_limits<double>::quiet_NaN();
};
MachineLoad machine_load();
/// The same from the texts of /proc/loadavg and /proc/stat, with ticks per second.
MachineLoad parse_machine_load(const std::string& loadavg, const std::string& stat, double ticks_per_second);

/// Processor and number of cores: the kind of machine, by which the costs of all systems are grouped.
std::string machine_name();

}  // namespace holdfast
