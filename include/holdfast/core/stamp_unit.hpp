// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <string>

namespace holdfast {

/// Median interval between consecutive different time stamps; the stamps need not be sorted. NaN with fewer than two
/// different ones; values that are not finite are ignored.
double median_interval(std::span<const double> stamps);

/// Heuristic test whether time stamps are not in seconds, by their magnitude (seconds since 1970 have ten digits) and
/// by their median interval (cameras and motion capture take 4 to 5000 poses per second): a clause with the unit and
/// the remedy, "look like milliseconds (33.4 from one to the next): divide them by 1000". Empty for plausible seconds,
/// for fewer than three stamps, and for intervals outside the known ranges. Recordings of 0.2 frames per second or more
/// are not suspected, except those whose stamps are consecutive integers, as frame numbers are.
std::string stamp_unit_suspicion(std::span<const double> stamps);

/// The same for a single stamp by its magnitude alone: "look like microseconds: divide them by 1e+06"; empty below 1e11
/// (seconds until the year 5138).
std::string stamp_magnitude_suspicion(double stamp);

}  // namespace holdfast
