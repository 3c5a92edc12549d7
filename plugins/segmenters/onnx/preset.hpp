// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "holdfast/plugin/parameter.hpp"
#include "holdfast/settings/onnx.hpp"

namespace holdfast::onnx_plugin {

/// The values of a preset that the module has (presets.yaml). Throws ConfigurationError with the known names for
/// another one.
ParameterValues shipped_preset(const std::string& name);

/// The settings with the values of the preset that they name, one of the module's or a YAML file (.yaml, .yml; relative
/// to the model's folder), as with_preset(); a preset of a family says the family too. Throws ConfigurationError for an
/// unknown name, and InputError with file and line for a file that is missing or has a value that is no such
/// parameter's.
OnnxSettings with_named_preset(const OnnxSettings& settings);

/// The settings with the values of a preset for all parameters that have their defaults. The mean and the standard
/// deviation of a preset follow the order of the colours, if the settings have another one than it.
OnnxSettings with_preset(const OnnxSettings& settings, const ParameterValues& preset);

/// What the colours of an input are and the range of its values, for people: "rgb from 0 to 1". Settings without a mean
/// or a standard deviation have 0 or 1.
std::string colour_text(const OnnxSettings& settings);

}  // namespace holdfast::onnx_plugin
