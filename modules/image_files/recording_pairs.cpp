// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/image_files/recording_pairs.hpp"

#include "holdfast/core/association.hpp"
#include "holdfast/core/error.hpp"

namespace holdfast {

namespace {

std::vector<double> stamps_of(const std::vector<ListedImage>& images) {
  std::vector<double> stamps;
  stamps.reserve(images.size());
  for (const ListedImage& image : images) stamps.push_back(image.timestamp);
  return stamps;
}

}  // namespace

std::vector<ListedPair> associate_lists(const std::filesystem::path& first_list,
                                        const std::filesystem::path& second_list, double max_time_difference,
                                        const std::string& kinds) {
  const std::vector<ListedImage> first = read_image_list(first_list);
  const std::vector<ListedImage> second = read_image_list(second_list);
  const std::vector<double> first_stamps = stamps_of(first), second_stamps = stamps_of(second);
  std::vector<ListedPair> pairs;
  for (const auto& [a, b] : associate_stamps(first_stamps, second_stamps, max_time_difference))
    pairs.push_back({first[a], second[b]});
  if (pairs.empty())
    throw InputError({first_list.parent_path().string()},
                     "no " + kinds + " image lie within " + stamp_text(max_time_difference) + " s of each other: " +
                         first_list.filename().string() + " runs from " + stamp_text(first_stamps.front()) + " to " +
                         stamp_text(first_stamps.back()) + " s, " + second_list.filename().string() + " from " +
                         stamp_text(second_stamps.front()) + " to " + stamp_text(second_stamps.back()) +
                         " s; are both lists of this recording? Otherwise raise `max_time_difference`");
  return pairs;
}

std::vector<ListedPair> recording_pairs(const std::filesystem::path& folder, const std::filesystem::path& associations,
                                        double max_time_difference) {
  if (!associations.empty()) return read_association_list(associations);
  return associate_lists(folder / "rgb.txt", folder / "depth.txt", max_time_difference, "colour and depth");
}

}  // namespace holdfast
