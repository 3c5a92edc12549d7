// SPDX-License-Identifier: BSD-3-Clause
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <charconv>
#include <optional>

#include "holdfast/core/error.hpp"
#include "holdfast/core/input_file.hpp"
#include "rosbag2_folder.hpp"

namespace holdfast::rosbag_plugin {

namespace {

constexpr const char* zstd_ending = ".zstd";

/// A file NAME_NUMBER.ENDING of a split recording.
struct SplitName {
  std::string name;
  std::uint64_t number = 0;
};

bool is_rosbag2_file(std::string name) {
  if (name.ends_with(zstd_ending)) name.resize(name.size() - 5);
  return name.ends_with(".db3") || name.ends_with(".mcap");
}

std::optional<SplitName> split_name(const std::filesystem::path& file) {
  const std::string name = file.filename().string();
  const std::string stem = name.substr(0, name.find('.', name.rfind('_') == std::string::npos ? 0 : name.rfind('_')));
  const std::size_t separator = stem.rfind('_');
  if (separator == std::string::npos) return std::nullopt;
  SplitName split{stem.substr(0, separator), 0};
  const char *begin = stem.data() + separator + 1, *end = stem.data() + stem.size();
  const auto [rest, error] = std::from_chars(begin, end, split.number);
  if (error != std::errc() || rest != end) return std::nullopt;
  return split;
}

Rosbag2Files files_without_metadata(const std::filesystem::path& folder) {
  Rosbag2Files found;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    if (entry.is_regular_file() && is_rosbag2_file(entry.path().filename().string()))
      found.files.push_back(entry.path());
  // `ros2 bag play` leaves a decompressed file beside the compressed one.
  std::erase_if(found.files, [&](const std::filesystem::path& file) {
    std::string plain = file.string();
    if (!plain.ends_with(zstd_ending)) return false;
    plain.resize(plain.size() - 5);
    return std::filesystem::exists(plain);
  });
  if (found.files.empty())
    throw InputError({folder.string()},
                     "is a folder without metadata.yaml and without files .db3 or .mcap; expected a recording of ROS: "
                     "a folder of rosbag2, or a file .bag, .mcap or .db3; set `source.rosbag.path`");
  std::sort(found.files.begin(), found.files.end());
  if (found.files.size() == 1) return found;
  const std::optional<SplitName> first = split_name(found.files.front());
  std::string names;
  bool is_one = first.has_value();
  for (const std::filesystem::path& file : found.files) {
    const std::optional<SplitName> split = split_name(file);
    is_one = is_one && split && split->name == first->name;
    names += (names.empty() ? "" : ", ") + file.filename().string();
  }
  if (!is_one)
    throw InputError({folder.string()}, "is a folder without metadata.yaml that holds several recordings: " + names +
                                            "; name one of these files with `source.rosbag.path`");
  std::stable_sort(found.files.begin(), found.files.end(),
                   [](const std::filesystem::path& a, const std::filesystem::path& b) {
                     return split_name(a)->number < split_name(b)->number;
                   });
  return found;
}

std::string scalar_in(const YAML::Node& information, const char* key) {
  const YAML::Node node = information[key];
  return node.IsDefined() && node.IsScalar() ? node.Scalar() : "";
}

std::filesystem::path listed_file(const std::filesystem::path& folder, const std::string& name) {
  // Old versions list a file with the folder in which they were started.
  const std::filesystem::path own = std::filesystem::path(name).filename();
  for (const std::filesystem::path& file : {folder / name, folder / own})
    if (!own.empty() && std::filesystem::is_regular_file(file)) return file;
  throw InputError({(folder / "metadata.yaml").string()},
                   "lists the file '" + name +
                       "', which is missing; copy the whole folder, or name one of its files "
                       "with `source.rosbag.path`");
}

Rosbag2Files files_of_metadata(const std::filesystem::path& folder, const std::filesystem::path& metadata) {
  const auto refuse = [&](const std::string& problem) { throw InputError({metadata.string()}, problem); };
  Rosbag2Files found{{}, true};
  try {
    const YAML::Node root = YAML::Load(file_content(metadata, largest_file::configuration, "what rosbag2 writes"));
    const YAML::Node information = root.IsMap() ? root["rosbag2_bagfile_information"] : YAML::Node();
    if (!information.IsDefined() || !information.IsMap())
      refuse("has no rosbag2_bagfile_information; expected the description that rosbag2 writes");
    const std::string format = scalar_in(information, "compression_format");
    if (!format.empty() && format != "zstd")
      refuse("says that the recording is compressed by '" + format +
             "'; expected zstd or none; write it anew by `ros2 bag convert`");
    const YAML::Node list = information["relative_file_paths"];
    if (!list.IsDefined() || !list.IsSequence() || list.size() == 0)
      refuse("has no relative_file_paths; expected the list of the recording's files");
    for (const YAML::Node& name : list) {
      if (!name.IsScalar()) refuse("has something else than names in relative_file_paths");
      found.files.push_back(listed_file(folder, name.Scalar()));
    }
  } catch (const YAML::Exception& error) {
    throw InputError({metadata.string(), error.mark.line + 1, error.mark.column + 1},
                     "is not valid YAML: " + error.msg + "; copy it again");
  }
  return found;
}

}  // namespace

Rosbag2Files find_rosbag2_files(const std::filesystem::path& folder) {
  const std::filesystem::path metadata = folder / "metadata.yaml";
  if (std::filesystem::is_regular_file(metadata)) return files_of_metadata(folder, metadata);
  return files_without_metadata(folder);
}

}  // namespace holdfast::rosbag_plugin
