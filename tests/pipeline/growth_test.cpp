// SPDX-License-Identifier: BSD-3-Clause
// Pipelines that are made and dropped leave nothing behind. HOLDFAST_PIPELINES sets their number.
#include <gtest/gtest.h>
#include <malloc.h>

#include <cstdlib>
#include <filesystem>
#include <iterator>

#include "holdfast/pipeline/pipeline.hpp"
#include "holdfast/plugin/abi.hpp"
#include "support/brute_force_detector.hpp"
#include "support/point_pipeline.hpp"

namespace holdfast {
namespace {

std::size_t entries_of(const char* folder) {
  return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(folder), {}));
}

/// Bytes that the process has allocated and not freed.
std::size_t allocated() {
  const struct mallinfo2 info = mallinfo2();
  return info.uordblks + info.hblkhd;
}

void make_and_drop(test::PointWorld& world, int frames, bool finish) {
  PipelineParts parts = test::point_parts(world);
  parts.loop_detector = std::make_unique<test::BruteForceDetector>();
  parts.run.mode = RunMode::threaded;
  Pipeline pipeline(std::move(parts));
  for (int i = 0; i < frames; ++i)
    pipeline.feed(world.frame(static_cast<std::uint64_t>(i), i / 10.0, test::path_pose(i / 10.0)));
  if (finish) pipeline.finish();
}

TEST(Growth, PipelinesThatAreDroppedLeaveNothing) {
  const char* wanted = std::getenv("HOLDFAST_PIPELINES");
  const int count = wanted == nullptr ? 100 : std::atoi(wanted);
  const auto make_some = [](int pipelines) {
    for (int i = 0; i < pipelines; ++i) {
      test::PointWorld world(find_camera("tum_fr1").value(), 500);
      make_and_drop(world, i % 4, i % 2 == 0);
    }
  };
  make_some(8);  // what libraries allocate once
  const std::size_t before = allocated(), descriptors = entries_of("/proc/self/fd"),
                    threads = entries_of("/proc/self/task");
  make_some(count);
  EXPECT_EQ(entries_of("/proc/self/fd"), descriptors);
  EXPECT_EQ(entries_of("/proc/self/task"), threads);
  if (compiled_abi().sanitizers != 0) GTEST_SKIP() << "a sanitizer replaces the allocator that is asked";
  EXPECT_LT(allocated(), before + 65536 + 100 * static_cast<std::size_t>(count)) << "after " << count << " pipelines";
}

}  // namespace
}  // namespace holdfast
