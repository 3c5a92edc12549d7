// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "holdfast/plugin/choice.hpp"
#include "holdfast/settings/network_engine.hpp"

namespace holdfast {

class Segmenter;
template <class Settings>
class ParameterTable;

/// Order of the channels of a colour image. automatic: of the network's preset, otherwise rgb.
enum class ColourOrder { automatic, rgb, bgr };
/// Layout of the network's input and output: channels first or channels last.
enum class TensorLayout { nchw, nhwc };
/// Output of a network for segmentation. Of a semantic network: scores before softmax, probabilities, or class indices.
/// Of a network for objects: instances with masks (boxes, coefficients and prototypes), or boxes. automatic: objects if
/// the model's metadata and outputs are those of a known family, otherwise logits.
enum class NetworkOutput { automatic, logits, probabilities, labels, instances, boxes };
/// How an image becomes a network's input of another aspect ratio: stretched, or scaled by one factor, centred and
/// padded with grey. automatic: as the family is trained; semantic networks stretch.
enum class InputFit { automatic, stretch, letterbox };
/// Family of a network for objects: what its outputs mean and how its input is prepared (`holdfast modules onnx`).
enum class ObjectFamily {
  automatic,
  yolo,
  yolov5,
  yolo_end_to_end,
  rtdetr,
  detr,
  ssd,
  mask_rcnn,
  maskformer,
  fastestdet
};

template <>
inline constexpr Choice<ColourOrder> choice_table<ColourOrder>[] = {
    {"auto", ColourOrder::automatic}, {"rgb", ColourOrder::rgb}, {"bgr", ColourOrder::bgr}};
template <>
inline constexpr Choice<TensorLayout> choice_table<TensorLayout>[] = {{"nchw", TensorLayout::nchw},
                                                                      {"nhwc", TensorLayout::nhwc}};
template <>
inline constexpr Choice<NetworkOutput> choice_table<NetworkOutput>[] = {{"auto", NetworkOutput::automatic},
                                                                        {"logits", NetworkOutput::logits},
                                                                        {"probabilities", NetworkOutput::probabilities},
                                                                        {"labels", NetworkOutput::labels},
                                                                        {"instances", NetworkOutput::instances},
                                                                        {"boxes", NetworkOutput::boxes}};
template <>
inline constexpr Choice<InputFit> choice_table<InputFit>[] = {
    {"auto", InputFit::automatic}, {"stretch", InputFit::stretch}, {"letterbox", InputFit::letterbox}};
template <>
inline constexpr Choice<ObjectFamily> choice_table<ObjectFamily>[] = {
    {"auto", ObjectFamily::automatic},
    {"yolo", ObjectFamily::yolo},
    {"yolov5", ObjectFamily::yolov5},
    {"yolo_end_to_end", ObjectFamily::yolo_end_to_end},
    {"rtdetr", ObjectFamily::rtdetr},
    {"detr", ObjectFamily::detr},
    {"ssd", ObjectFamily::ssd},
    {"mask_rcnn", ObjectFamily::mask_rcnn},
    {"maskformer", ObjectFamily::maskformer},
    {"fastestdet", ObjectFamily::fastestdet}};

/// Settings of the segmenter `onnx`. Ranges and units: `holdfast modules onnx`.
struct OnnxSettings {
  using Interface = Segmenter;
  static constexpr const char* module = "onnx";

  std::filesystem::path model;  ///< ONNX file; required
  /// Name of a preset of the module, or a YAML file, relative to the model's folder: values for parameters with their
  /// defaults.
  std::string preset;
  int width = 0;   ///< width of the network input [px]; 0 = as declared by the model
  int height = 0;  ///< height of the network input [px]; 0 = as declared by the model
  ColourOrder colour_order = ColourOrder::automatic;  ///< of the input
  /// Input = (pixel * scale - mean) / standard_deviation with pixels from 0 to 255; 1/255 maps them to [0, 1].
  double scale = 1.0 / 255.0;
  std::vector<double> mean;                ///< per channel, in colour_order; empty = of the family, otherwise 0
  std::vector<double> standard_deviation;  ///< per channel, in colour_order; empty = of the family, otherwise 1
  InputFit fit = InputFit::automatic;
  TensorLayout layout = TensorLayout::nchw;
  NetworkOutput output = NetworkOutput::automatic;
  ObjectFamily family = ObjectFamily::automatic;  ///< of a network for objects
  double min_score = 0.0;                         ///< of an object; 0 = usual for the family
  double max_overlap = 0.0;                       ///< IoU of two objects of a class; 0 = usual for the family
  std::string output_name;                        ///< name of the output; needed if the model has several
  /// Class names by channel or label; the first is the background. Empty = those of the model's metadata, which
  /// networks for objects have, otherwise background and person.
  std::vector<std::string> classes;
  /// The subset of classes that can move; empty = person for a network for objects, otherwise not
  /// specified.
  std::vector<std::string> movable;
  NetworkEngine engine = NetworkEngine::automatic;      ///< what computes the network
  NetworkPrecision precision = NetworkPrecision::fp32;  ///< bf16: with onednn, where the processor has it
  std::string provider = "cpu";                         ///< of ONNX Runtime: what it computes on
  /// ONNX Runtime's library, or its folder; empty = the variable HOLDFAST_ONNXRUNTIME, otherwise the usual places.
  std::filesystem::path engine_library;
  /// OpenCV: for the whole process, 0 = unchanged; other engines: for this network, 0 = 1.
  int threads = 0;

  static void describe(ParameterTable<OnnxSettings>& table);
};

}  // namespace holdfast
