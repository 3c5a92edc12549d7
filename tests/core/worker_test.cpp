// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/core/worker.hpp"

#include <gtest/gtest.h>
#include <pthread.h>

namespace holdfast {
namespace {

TEST(Worker, ItsThreadHasItsName) {
  std::string name;
  Worker<int> worker("segmentation of keyframes", 1, [&](int&) {
    char text[16] = {};
    pthread_getname_np(pthread_self(), text, sizeof(text));
    name = text;
  });
  worker.queue().push(1);
  worker.finish();
  EXPECT_EQ(name, "segmentation of");  // the system keeps 15 bytes
}

}  // namespace
}  // namespace holdfast
