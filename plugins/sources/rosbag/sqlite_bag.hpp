// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <memory>

#include "bag.hpp"

namespace holdfast::rosbag_plugin {

/// The first bytes of a database.
inline constexpr const char* sqlite_magic = "SQLite format 3";

/// Opens a database of rosbag2 (its tables `topics` and `messages`, in every version since ROS 2 Dashing), which is not
/// changed. `file` has the bytes, and `shown` is its name for errors. Throws InputError for another database, for a
/// damaged or truncated one, and in a build without SQLite.
std::unique_ptr<Bag> open_sqlite_bag(const std::filesystem::path& file, const std::filesystem::path& shown);

}  // namespace holdfast::rosbag_plugin
