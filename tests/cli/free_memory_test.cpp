// SPDX-License-Identifier: BSD-3-Clause
#include "free_memory.hpp"

#include <gtest/gtest.h>
#include <malloc.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <memory>
#include <vector>

namespace holdfast {
namespace {

std::size_t mapped() { return mallinfo2().hblkhd; }

std::size_t resident() {
  std::ifstream stream("/proc/self/statm");
  std::size_t total = 0, pages = 0;
  stream >> total >> pages;
  return pages * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
}

/// A buffer that was freed is no reason to keep the next one.
TEST(FreeMemory, LargeBuffersGoBackToTheSystem) {
  if (std::getenv("GLIBC_TUNABLES") != nullptr) GTEST_SKIP() << "GLIBC_TUNABLES says what the C library does";
  limit_free_memory();
  constexpr std::size_t size = 10 << 20;
  const std::size_t before = mapped();
  auto buffer = std::make_unique<std::vector<char>>(size);
  if (mapped() == before) GTEST_SKIP() << "this allocator does not say what it maps";
  for (int i = 0; i < 3; ++i) {
    buffer.reset();
    EXPECT_LT(mapped(), before + size);
    buffer = std::make_unique<std::vector<char>>(size);
    EXPECT_GE(mapped(), before + size) << "the buffer came from the heap";
  }
  // Images of a frame do come from the heap.
  const std::size_t with_buffer = mapped();
  const std::vector<char> image(640 * 480 * 4);
  EXPECT_EQ(mapped(), with_buffer);
}

TEST(FreeMemory, GapsBetweenBuffersThatStayGoBackToTheSystem) {
  if (mallinfo2().uordblks == 0) GTEST_SKIP() << "this allocator does not say what it uses";
  constexpr std::size_t size = 64 << 10, count = 800;  // smaller than what glibc maps
  std::vector<std::unique_ptr<std::vector<char>>> gaps, kept;
  for (std::size_t i = 0; i < count; ++i) {
    gaps.push_back(std::make_unique<std::vector<char>>(size, 'x'));
    kept.push_back(std::make_unique<std::vector<char>>(1000, 'x'));
  }
  gaps.clear();
  const std::size_t before = resident();
  return_free_memory();
  EXPECT_LT(resident() + size * count / 2, before);
}

}  // namespace
}  // namespace holdfast
