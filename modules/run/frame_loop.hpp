// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "holdfast/run/run.hpp"

namespace holdfast {

/// Feeds frames until the source ends, RunOptions::stop asks for the end or something throws, and finishes the
/// pipeline. In threaded mode, and in sequential mode for sources that can be read ahead, a FrameFeeder reads the
/// source. Fills the record's summary, frame_stamps, skipped, start_seconds, threads, was_interrupted and failure.
void feed_frames(BuiltPipeline& built, const RunOptions& options, RunRecord& record);

}  // namespace holdfast
