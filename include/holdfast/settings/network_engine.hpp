// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "holdfast/plugin/choice.hpp"

namespace holdfast {

/// Inference engine of a network: OpenCV's DNN module, oneDNN (if built with it), or ONNX Runtime (if its library is
/// found at run time). automatic: oneDNN for a network whose operators it is known to have, where the build has it;
/// otherwise ONNX Runtime where it is found; otherwise OpenCV.
enum class NetworkEngine { automatic, opencv, onednn, onnxruntime };

/// Numbers that a network computes with: 32 bits, or 16 bits with an exponent of eight (bfloat16), which needs a
/// processor with instructions for them.
enum class NetworkPrecision { fp32, bf16 };

template <>
inline constexpr Choice<NetworkEngine> choice_table<NetworkEngine>[] = {{"auto", NetworkEngine::automatic},
                                                                        {"opencv", NetworkEngine::opencv},
                                                                        {"onednn", NetworkEngine::onednn},
                                                                        {"onnxruntime", NetworkEngine::onnxruntime}};
template <>
inline constexpr Choice<NetworkPrecision> choice_table<NetworkPrecision>[] = {{"fp32", NetworkPrecision::fp32},
                                                                              {"bf16", NetworkPrecision::bf16}};

}  // namespace holdfast
