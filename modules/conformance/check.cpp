// SPDX-License-Identifier: BSD-3-Clause
#include "check.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <exception>
#include <thread>

#include "holdfast/core/error.hpp"
#include "scene.hpp"

namespace holdfast::conformance {

Camera standard_camera() {
  Camera camera;
  camera.name = "conformance";
  camera.width = 320, camera.height = 240;
  camera.fx = camera.fy = 260.0;
  camera.cx = 159.5, camera.cy = 119.5;
  return camera;
}

CreationContext standard_context() {
  CreationContext context;
  context.camera = standard_camera();
  context.class_names = Scene::classes();
  return context;
}

void run_side_by_side(const std::function<void()>& first, const std::function<void()>& second) {
  std::exception_ptr thrown[2];
  const auto guarded = [&](const std::function<void()>& call, std::exception_ptr& error) {
    try {
      call();
    } catch (...) {
      error = std::current_exception();
    }
  };
  std::thread one([&] { guarded(first, thrown[0]); });
  std::thread two([&] { guarded(second, thrown[1]); });
  one.join();
  two.join();
  for (const std::exception_ptr& error : thrown)
    if (error) std::rethrow_exception(error);
}

bool refused(const std::function<void()>& call) {
  try {
    call();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()), "") << "an error must say what was found and what was expected";
    return true;
  }
  return false;
}

void report_time(const std::string& what, int times, const std::function<void()>& call) {
  std::vector<double> milliseconds;
  for (int i = 0; i < times; ++i) {
    const auto start = std::chrono::steady_clock::now();
    call();
    milliseconds.push_back(std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
  }
  std::nth_element(milliseconds.begin(), milliseconds.begin() + times / 2, milliseconds.end());
  char median[32];
  std::snprintf(median, sizeof median, "%.3f", milliseconds[static_cast<std::size_t>(times / 2)]);
  testing::Test::RecordProperty("median_ms", median);
  // The output of a test program is its report.
  std::printf("[     TIME ] %s: median %s ms of %d calls\n", what.c_str(), median, times);
}

}  // namespace holdfast::conformance
