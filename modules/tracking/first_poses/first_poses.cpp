// SPDX-License-Identifier: BSD-3-Clause
#include "dense_depth.hpp"
#include "holdfast/tracking/first_pose.hpp"
#include "inertial.hpp"
#include "masked_features.hpp"
#include "odometry.hpp"
#include "prediction.hpp"
#include "relocalisation.hpp"

namespace holdfast {

FirstPoses default_first_poses() {
  FirstPoses poses;
  poses.push_back(std::make_unique<Prediction>(predict_by_motion_model));
  poses.push_back(std::make_unique<InertialSearch>());
  poses.push_back(std::make_unique<Prediction>(predict_by_reference_keyframe));
  poses.push_back(std::make_unique<InertialReturn>());
  poses.push_back(std::make_unique<Odometry>());
  poses.push_back(std::make_unique<MaskedFeatures>());
  poses.push_back(std::make_unique<DenseDepth>());
  poses.push_back(std::make_unique<InertialBridge>());
  poses.push_back(std::make_unique<Relocalisation>());
  return poses;
}

}  // namespace holdfast
