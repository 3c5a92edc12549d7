// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/run/run_record.hpp"

#include <algorithm>

namespace holdfast {

double ThreadRecord::late_share() const {
  if (delays.empty()) return 0.0;
  const auto above = std::count_if(delays.begin(), delays.end(), [](double seconds) { return seconds > 0.033; });
  return static_cast<double>(above) / static_cast<double>(delays.size());
}

double RunRecord::coverage() const {
  return frames_expected == 0 ? 0.0 : static_cast<double>(trajectory.size()) / static_cast<double>(frames_expected);
}

}  // namespace holdfast
