// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "holdfast/inference/network.hpp"
#include "holdfast/plugin/parameter_table.hpp"

namespace holdfast {

/// Adds the parameters that say what a network takes: size, colours and normalisation of its image. The texts are
/// appended to those of the mean and of the standard deviation.
template <class Settings>
void describe_network_input(ParameterTable<Settings>& table, const std::string& of_mean = "",
                            const std::string& of_deviation = "") {
  table.add("width", &Settings::width, "width of the network input; 0 = as declared by the model")
      .range(0, 8192)
      .unit("px");
  table.add("height", &Settings::height, "height of the network input; 0 = as declared by the model")
      .range(0, 8192)
      .unit("px");
  table.add("colour_order", &Settings::colour_order,
            "order of the input channels; auto = of the preset, otherwise rgb");
  table.add("scale", &Settings::scale, "input = (pixel * scale - mean) / standard_deviation, pixels from 0 to 255");
  table.add("mean", &Settings::mean, "subtracted from each channel, in colour_order, after scale" + of_mean);
  table.add("standard_deviation", &Settings::standard_deviation,
            "divides each channel, in colour_order" + of_deviation);
}

/// Adds the parameters that say what computes a network.
template <class Settings>
void describe_network_engine(ParameterTable<Settings>& table) {
  table.add("engine", &Settings::engine,
            "what computes the network: opencv; onednn, which is faster and knows fewer operators; onnxruntime, which "
            "knows most operators and numbers, where its library is found; auto = onednn for the built-in network "
            "where this build has it, otherwise onnxruntime where it is found, otherwise opencv");
  table.add("engine_library", &Settings::engine_library,
            "library of ONNX Runtime (libonnxruntime.so) or its folder; empty = the environment variable "
            "HOLDFAST_ONNXRUNTIME, otherwise the usual places");
  table.add("provider", &Settings::provider,
            "what ONNX Runtime computes on: cpu, cuda, tensorrt, openvino or another that its library has");
  table.add("precision", &Settings::precision,
            "numbers that the network computes with; bf16 needs `engine: onednn` and a processor with AVX512_BF16; "
            "onnxruntime computes with those of the file, float16 and int8 too");
  table
      .add("threads", &Settings::threads,
           "number of threads; of OpenCV for the whole process, because it has no other setting, 0 = unchanged "
           "(holdfast: 1); of other engines for this network, 0 = 1")
      .range(0, 256);
}

/// Sets what computes the network. `is_for_onednn`: `auto` means oneDNN where this build has it. Throws
/// ConfigurationError for settings of ONNX Runtime beside another engine.
template <class Settings>
void set_network_engine(NetworkOptions& options, const Settings& settings, bool is_for_onednn) {
  options.engine = chosen_engine({settings.engine, settings.provider, settings.engine_library}, is_for_onednn);
  options.provider = settings.provider;
  options.engine_library = settings.engine_library;
  options.precision = settings.precision;
  options.threads = settings.threads;
}

/// The options of a network with these parameters and the settings `model` and `output_name`.
template <class Settings>
NetworkOptions network_options(const Settings& settings) {
  return {.model = settings.model,
          .width = settings.width,
          .height = settings.height,
          .rgb = settings.colour_order != decltype(settings.colour_order)::bgr,
          .scale = settings.scale,
          .mean = settings.mean,
          .standard_deviation = settings.standard_deviation,
          .output_name = settings.output_name};
}

}  // namespace holdfast
