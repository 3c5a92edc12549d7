// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "holdfast/bridge/messages.hpp"
#include "holdfast/core/camera.hpp"

/// Messages of a robot to what the pipeline takes. Errors are InputError, which name the message and the remedy.
namespace holdfast::bridge {

/// Blue, green, red, in memory of its own.
cv::Mat colour_of(const RawImage& image);
cv::Mat colour_of(const CompressedImage& image);
/// 32FC1 [m], 0 = no value. `factor`: value of a metre in whole numbers.
cv::Mat depth_of(const RawImage& image, double factor);
cv::Mat depth_of(const CompressedImage& image, double factor);

/// The camera; its baseline is that of Camera unless P has one (P[3] / -fx, of the right camera of a pair).
Camera camera_of(const CameraInfo& info, bool is_rectified);
/// Baseline by the right camera [m]; empty if its P has none.
std::optional<double> baseline_of(const CameraInfo& right);

/// A sentence if the two differ by more than noise: 2 % of the focal length or of the width; else empty.
std::string difference_of(const Camera& used, const Camera& told);

inline double seconds(Stamp stamp) { return static_cast<double>(stamp) * 1e-9; }

}  // namespace holdfast::bridge
