// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/tracking/filter_chain.hpp"

#include <cmath>

namespace holdfast {

void FilterChain::apply(const FilterContext& context, Frame& frame) {
  evidence_.reset(frame.size());
  for (std::size_t i = 0; i < filters_.size(); ++i) {
    evidence_.begin_stage(names_[i]);
    filters_[i]->apply(context, evidence_);
  }
  for (const StaticEvidence::Statement& statement : evidence_.statements()) {
    const float log_odds = evidence_.log_odds(statement.feature);
    frame.static_probability[statement.feature] = 1.0F / (1.0F + std::exp(-log_odds));
  }
}

}  // namespace holdfast
