// SPDX-License-Identifier: BSD-3-Clause
#include "bag.hpp"
#include "holdfast/core/input_file.hpp"
#include "mcap_file.hpp"
#include "ros1_bag.hpp"
#include "rosbag2_folder.hpp"
#include "split_bag.hpp"
#include "sqlite_bag.hpp"
#include "zstd_file.hpp"

namespace holdfast::rosbag_plugin {

namespace {

constexpr const char* expected_recordings =
    "; expected a recording of ROS: a bag of ROS 1 (format 2.0), an MCAP file, a database of rosbag2 (.db3), or a "
    "folder of rosbag2";

std::string first_bytes(const std::filesystem::path& file) {
  std::string bytes(64, '\0');
  bytes.resize(InputFile(file, largest_file::unbounded, "a recording of ROS").read(bytes.data(), bytes.size()));
  return bytes;
}

std::string foreign_format(const std::string& begin) {
  if (begin.empty()) return "is empty";
  if (begin.starts_with("#ROSBAG V")) return "is a bag of an older format, '" + begin.substr(0, begin.find('\n')) + "'";
  if (begin.starts_with("\x89MCAP")) return "is an MCAP file of another version, or cut short in its first bytes";
  return "is not a bag";
}

using OpenContainer = std::unique_ptr<Bag> (*)(const std::filesystem::path& file, const std::filesystem::path& shown);

/// What a file of a kind begins with, and what opens it.
struct Container {
  const char* magic;
  OpenContainer open;
};

template <class Opened>
std::unique_ptr<Bag> open_as(const std::filesystem::path& file, const std::filesystem::path& shown) {
  return std::make_unique<Opened>(file, shown);
}

constexpr Container containers[] = {
    {ros1_magic, &open_as<Ros1Bag>}, {mcap_magic, &open_as<McapFile>}, {sqlite_magic, &open_sqlite_bag}};

std::unique_ptr<Bag> open_file(const std::filesystem::path& file, const std::filesystem::path& shown) {
  const std::string begin = first_bytes(file);
  for (const Container& container : containers)
    if (begin.starts_with(container.magic)) return container.open(file, shown);
  throw InputError({shown.string()}, foreign_format(begin) + expected_recordings);
}

std::unique_ptr<Bag> open_part(const std::filesystem::path& file) {
  if (!first_bytes(file).starts_with(zstd_magic)) return open_file(file, file);
  // What is open stays readable when its name is gone.
  const TemporaryFile unpacked(unpack_to_temporary_file(file));
  return open_file(unpacked.path(), file);
}

}  // namespace

std::unique_ptr<Bag> open_bag(const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::exists(path, error))
    throw InputError({path.string()}, std::string("is missing") + expected_recordings + "; set `source.rosbag.path`");
  if (path.filename() == "metadata.yaml") return open_bag(path.parent_path().empty() ? "." : path.parent_path());
  std::vector<std::unique_ptr<Bag>> parts;
  if (std::filesystem::is_regular_file(path, error)) {
    parts.push_back(open_part(path));
    return std::make_unique<SplitBag>(path, std::move(parts));
  }
  if (!std::filesystem::is_directory(path, error))
    throw InputError({path.string()}, std::string("is neither a file nor a folder") + expected_recordings);
  const Rosbag2Files found = find_rosbag2_files(path);
  for (const std::filesystem::path& file : found.files) parts.push_back(open_part(file));
  const std::size_t count = parts.size();
  auto bag = std::make_unique<SplitBag>(path, std::move(parts));
  if (!found.has_metadata)
    bag->suspect(
        "has no metadata.yaml: did its recording come to its end? " +
        (count == 1 ? "Its file " : "Its " + std::to_string(count) + " files, in the order of their numbers, ") +
        (count == 1 ? "is read" : "are read"));
  return bag;
}

}  // namespace holdfast::rosbag_plugin
