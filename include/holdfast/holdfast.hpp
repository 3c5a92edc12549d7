// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// Everything that a program which embeds Holdfast starts from; link holdfast::holdfast. The way through it:
/// a Registry with register_builtin_plugins() and load_plugin(), load_configuration(), build_pipeline(), then frames
/// into Pipeline::feed() and poses out of Pipeline::trajectory(), and evaluate() against a truth. A program that needs
/// only one of these compiles faster with that one header.
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
#include "holdfast/simulation/simulator.hpp"
