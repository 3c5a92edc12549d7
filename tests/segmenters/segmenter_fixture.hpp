// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <memory>
#include <opencv2/core.hpp>
#include <string>

#include "holdfast/core/error.hpp"
#include "holdfast/interfaces/segmenter.hpp"
#include "holdfast/plugin/registry.hpp"

namespace holdfast::test {

/// A segmenter of one plugin, made as a configuration would make it.
inline std::unique_ptr<Segmenter> make_segmenter(void (*register_plugin)(Registry&), const std::string& name,
                                                 const ParameterValues& values, const CreationContext& context = {}) {
  Registry registry;
  register_plugin(registry);
  return registry.create<Segmenter>(name, values, context);
}

inline SensorFrame frame_of(double timestamp, int width, int height, const cv::Scalar& blue_green_red = {}) {
  SensorFrame frame;
  frame.timestamp = timestamp;
  frame.colour = cv::Mat(height, width, CV_8UC3, blue_green_red);
  return frame;
}

/// What the error says; a failed expectation when there is none.
template <class Run>
std::string error_of(Run&& run) {
  try {
    run();
  } catch (const Error& error) {
    return error.what();
  }
  ADD_FAILURE() << "no error";
  return "";
}

}  // namespace holdfast::test
