// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/interfaces/optimizer.hpp"

#include "holdfast/core/check.hpp"

namespace holdfast {

PoseSummary Optimizer::optimize_pose(PoseProblem& problem) { return geometry::adjust_pose(problem); }

void geometry::PoseProblemTraits<PoseProblem>::begin(PoseProblem& problem) {
  const std::size_t size = problem.size();
  HOLDFAST_CHECK(problem.camera != nullptr, "a pose problem needs a camera");
  HOLDFAST_CHECK(problem.x.size() == size && problem.y.size() == size && problem.right_x.size() == size &&
                     problem.inverse_sigma2.size() == size && problem.weight.size() == size,
                 "points " << size << " x " << problem.x.size() << " y " << problem.y.size() << " right_x "
                           << problem.right_x.size() << " inverse_sigma2 " << problem.inverse_sigma2.size()
                           << " weight " << problem.weight.size());
  problem.inlier.assign(size, 0);
}

}  // namespace holdfast
