// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "holdfast/interfaces/dense_stereo.hpp"
#include "holdfast/interfaces/dynamic_filter.hpp"
#include "holdfast/interfaces/feature_extractor.hpp"
#include "holdfast/interfaces/feature_matcher.hpp"
#include "holdfast/interfaces/frame_source.hpp"
#include "holdfast/interfaces/loop_detector.hpp"
#include "holdfast/interfaces/observer.hpp"
#include "holdfast/interfaces/optimizer.hpp"
#include "holdfast/interfaces/segmenter.hpp"
