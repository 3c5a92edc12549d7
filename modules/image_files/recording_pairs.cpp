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

std::vector<ListedPair> recording_pairs(const std::filesystem::path& folder, const std::filesystem::path& associations,
                                        double max_time_difference) {
  if (!associations.empty()) return read_association_list(associations);
  const std::filesystem::path colour_list = folder / "rgb.txt";
  const std::filesystem::path depth_list = folder / "depth.txt";
  const std::vector<ListedImage> colour = read_image_list(colour_list);
  const std::vector<ListedImage> depth = read_image_list(depth_list);
  const std::vector<double> colour_stamps = stamps_of(colour), depth_stamps = stamps_of(depth);
  std::vector<ListedPair> pairs;
  for (const auto& [c, d] : associate_stamps(colour_stamps, depth_stamps, max_time_difference))
    pairs.push_back({colour[c], depth[d]});
  if (pairs.empty())
    throw InputError({folder.string()},
                     "no colour and depth image lie within " + stamp_text(max_time_difference) + " s of each other: " +
                         colour_list.filename().string() + " runs from " + stamp_text(colour_stamps.front()) + " to " +
                         stamp_text(colour_stamps.back()) + " s, " + depth_list.filename().string() + " from " +
                         stamp_text(depth_stamps.front()) + " to " + stamp_text(depth_stamps.back()) +
                         " s; are both lists of this recording? Otherwise raise `max_time_difference`");
  return pairs;
}

}  // namespace holdfast
