// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "holdfast/interfaces/optimizer.hpp"

namespace holdfast::test {

/// The motion-only adjustment that every optimizer has by default, and nothing else.
class PoseOptimizer : public Optimizer {
 public:
  BundleSummary optimize_bundle(BundleProblem&, const std::atomic<bool>&) override { return {}; }
  GraphSummary optimize_pose_graph(PoseGraphProblem&) override { return {}; }
};

}  // namespace holdfast::test
