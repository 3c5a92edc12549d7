// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "holdfast/cli/run_results.hpp"
#include "holdfast/core/stage_times.hpp"
#include "holdfast/pipeline/pipeline_builder.hpp"

namespace holdfast {

/// Feeds frames until the source ends, a signal comes or something throws, and finishes the pipeline; what was found
/// until then is kept, and what was thrown is the record's failure. In threaded mode the source is read in a thread of
/// its own, at the pace that the configuration names. Fills the record's summary, stamps, start and threads.
void feed_frames(BuiltPipeline& built, bool quiet, const Stopwatch& since_start, RunRecord& record);

}  // namespace holdfast
