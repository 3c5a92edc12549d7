// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// Everything that a program which embeds Holdfast starts from; link holdfast::holdfast. The way through it:
/// a PipelineBuilder, or load_configuration() and build_pipeline() for YAML, then frames into Pipeline::feed(), poses
/// out of its results and of Pipeline::trajectory(), and evaluate() against a truth. Typed settings of the built-in
/// modules are in holdfast/settings/all.hpp. A program that needs only one of these compiles faster with that one
/// header.
#include "holdfast/config/configuration.hpp"
#include "holdfast/core/camera.hpp"
#include "holdfast/core/error.hpp"
#include "holdfast/core/sensor_frame.hpp"
#include "holdfast/core/trajectory.hpp"
#include "holdfast/core/version.hpp"
#include "holdfast/evaluation/evaluation.hpp"
#include "holdfast/interfaces/all.hpp"
#include "holdfast/map_io/map_export.hpp"
#include "holdfast/map_io/map_file.hpp"
#include "holdfast/pipeline/pipeline.hpp"
#include "holdfast/pipeline/pipeline_builder.hpp"
#include "holdfast/plugin/builtin.hpp"
#include "holdfast/plugin/loader.hpp"
#include "holdfast/plugin/plugin.hpp"
#include "holdfast/plugin/registry.hpp"
#include "holdfast/run/configured_pipeline.hpp"
