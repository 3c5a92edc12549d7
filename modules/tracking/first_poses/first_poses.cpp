// SPDX-License-Identifier: BSD-3-Clause
#include "dense_depth.hpp"
#include "holdfast/tracking/first_pose.hpp"
#include "inertial.hpp"
#include "masked_features.hpp"
#include "odometry.hpp"
#include "prediction.hpp"
#include "relocalisation.hpp"

namespace holdfast {

FirstPoses default_first_poses(const DepthAlignment& surface) {
  FirstPoses poses;
  poses.push_back(std::make_unique<Prediction>(predict_by_motion_model));
  poses.push_back(std::make_unique<InertialSearch>());
  poses.push_back(std::make_unique<Prediction>(predict_by_reference_keyframe));
  poses.push_back(std::make_unique<InertialReturn>());
  poses.push_back(std::make_unique<Odometry>());
  poses.push_back(std::make_unique<MaskedFeatures>());
  if (surface) poses.push_back(std::make_unique<DenseDepth>(surface));
  poses.push_back(std::make_unique<DenseDepth>());
  poses.push_back(std::make_unique<InertialBridge>());
  poses.push_back(std::make_unique<Relocalisation>());
  return poses;
}

}  // namespace holdfast
