// SPDX-License-Identifier: BSD-3-Clause
// Counts the allocations of this program through operator new.
#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <new>

#include "both_optimizers.hpp"
#include "geometry/synthetic.hpp"

namespace {
std::atomic<std::size_t> allocations = 0;
}

void* operator new(std::size_t size) {
  ++allocations;
  if (void* memory = std::malloc(size == 0 ? 1 : size)) return memory;
  throw std::bad_alloc();
}
// std::stable_sort asks this one; replaced as well, because what the replaced delete frees must come from malloc.
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  ++allocations;
  return std::malloc(size == 0 ? 1 : size);
}
// Not inlined, because GCC would then see free() of what a new returned that it does not inline.
[[gnu::noinline]] void operator delete(void* memory) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }

namespace holdfast {
namespace {

TEST(SchurMemory, IsKeptBetweenProblems) {
  const Camera camera = synthetic::camera();
  const std::atomic<bool> go_on = false;
  const auto optimizer = make_optimizer("schur");
  const auto count = [&](int points) {
    BundleProblem problem = synthetic::bundle_case(camera, 3, 6, points, 8, 1.0, 0.05, 1).problem;
    const std::size_t before = allocations;
    EXPECT_TRUE(optimizer->optimize_bundle(problem, go_on).usable);
    return allocations - before;
  };
  count(600);
  EXPECT_LE(count(600), 2U) << "allocations of a problem that was solved before";
  EXPECT_LE(count(150), 2U) << "allocations of a smaller problem";
}

}  // namespace
}  // namespace holdfast
