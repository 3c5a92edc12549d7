// SPDX-License-Identifier: BSD-3-Clause
// The databases of a build without SQLite.
#include "sqlite_bag.hpp"

namespace holdfast::rosbag_plugin {

std::unique_ptr<Bag> open_sqlite_bag(const std::filesystem::path&, const std::filesystem::path& shown) {
  throw InputError({shown.string()},
                   "is a database of rosbag2, but SQLite was not found when Holdfast was configured; install it "
                   "(Debian: libsqlite3-dev), configure and build again");
}

}  // namespace holdfast::rosbag_plugin
