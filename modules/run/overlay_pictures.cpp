// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <string>
#include <utility>

#include "holdfast/run/results.hpp"

namespace holdfast {

namespace {

/// The number of a frame as digits, if a file is named as the observer names its pictures: "frame_000012.jpg".
std::string frame_digits(const std::filesystem::path& file) {
  const std::string name = file.stem().string(), head = "frame_";
  constexpr std::size_t most_digits = 19;  // what a number of 64 bits always holds
  if (file.extension() != ".jpg" && file.extension() != ".png") return {};
  if (name.rfind(head, 0) != 0 || name.size() > head.size() + most_digits) return {};
  const std::string digits = name.substr(head.size());
  return digits.find_first_not_of("0123456789") == std::string::npos ? digits : std::string();
}

}  // namespace

std::vector<std::string> overlay_pictures(const std::filesystem::path& folder) {
  std::vector<std::pair<unsigned long long, std::string>> found;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder / "overlay", error))
    if (const std::string digits = frame_digits(entry.path()); !digits.empty())
      found.emplace_back(std::stoull(digits), "overlay/" + entry.path().filename().string());
  std::sort(found.begin(), found.end());
  std::vector<std::string> pictures;
  for (auto& [frame, picture] : found) pictures.push_back(std::move(picture));
  return pictures;
}

}  // namespace holdfast
