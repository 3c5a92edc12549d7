// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/image_files/icl_nuim_files.hpp"

#include <algorithm>
#include <string>

#include "holdfast/core/error.hpp"

namespace holdfast {

namespace fs = std::filesystem;

std::vector<ListedPair> icl_nuim_pairs(const fs::path& folder) {
  std::vector<ListedPair> pairs = read_association_list(folder / "associations.txt");
  for (ListedPair& pair : pairs)
    if (pair.colour.name.find("depth") != std::string::npos) std::swap(pair.colour, pair.depth);
  return pairs;
}

fs::path icl_nuim_truth_file(const fs::path& folder) {
  std::vector<fs::path> found;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error))
    if (entry->path().filename().string().ends_with(".gt.freiburg")) found.push_back(entry->path());
  std::sort(found.begin(), found.end());
  if (found.size() == 1) return found.front();
  if (found.empty())
    throw InputError({folder.string()},
                     "has no file NAME.gt.freiburg; expected the true poses, such as livingRoom0.gt.freiburg; unpack "
                     "the archive again, or set `truth`");
  throw InputError({folder.string()}, "has " + std::to_string(found.size()) + " files of true poses, " +
                                          found[0].filename().string() + " and " + found[1].filename().string() +
                                          " among them; expected one NAME.gt.freiburg; choose one by `truth`");
}

Trajectory read_icl_nuim_truth(const fs::path& file, double frame_rate) {
  Trajectory truth = read_trajectory(file);
  const Eigen::Vector3d reflection(1.0, -1.0, 1.0);
  for (TimedPose& pose : truth) {
    pose.timestamp /= frame_rate;
    Eigen::Isometry3d reflected = Eigen::Isometry3d::Identity();
    reflected.linear() = reflection.asDiagonal() * pose.T_world_camera.rotation() * reflection.asDiagonal();
    reflected.translation() = reflection.cwiseProduct(pose.T_world_camera.translation());
    pose.T_world_camera = reflected;
  }
  return truth;
}

}  // namespace holdfast
