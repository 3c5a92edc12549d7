// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "holdfast/core/frame.hpp"
#include "holdfast/core/map.hpp"
#include "holdfast/geometry/se3.hpp"

namespace holdfast {

/// What the pose of a frame may be off because its matches with map points made in the last half second contradict
/// those with older ones. Somebody who fills the view and walks takes the pose along before it is lost: every new
/// keyframe makes points on him that agree with the last ones.
///
/// The poses by the older and by the newer points alone are compared by their calibrated covariances (PoseCovariance),
/// chi-square with six degrees of freedom at 95 %. If they differ, either may be right and the pose lies between
/// them: the covariance of that, in the camera frame, has half their distance as standard deviation. Zero if they
/// agree, if fewer than a quarter of the matches are new, which cannot move the pose far, or if a group is too small to
/// tell. Only features that are probably static count, as for the inliers of a pose: a common factor of the weights of
/// a group changes neither its pose nor its covariance.
///
/// `frame` has matches that agree with its pose. Thread-safe, with the map not changing; scratch memory is kept per
/// thread.
geometry::Matrix6d age_disagreement(const Frame& frame, const Map& map);

}  // namespace holdfast
