// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/inference/network.hpp"

#include <algorithm>
#include <array>
#include <opencv2/core/utility.hpp>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "holdfast/core/counted.hpp"
#include "holdfast/core/error.hpp"
#include "holdfast/inference/object_masks.hpp"
#include "holdfast/inference/onnx_net.hpp"
#include "holdfast/plugin/did_you_mean.hpp"

namespace holdfast {

namespace {

/// Whether an input is one image, without a dimension for several: torchvision exports detectors so.
bool is_without_batch(const OnnxTensor& input) { return input.shape.size() == 3; }

/// The size of the input, from the options and from what the model declares, which must agree.
cv::Size input_size(const NetworkOptions& options, const OnnxNet& net) {
  const OnnxSignature& signature = net.signature();
  const auto fail = [&](const std::string& message) { throw InputError({options.model.string()}, message); };
  if (signature.inputs.size() != 1)
    fail("has " + std::to_string(signature.inputs.size()) + " inputs, " + names(signature.inputs) +
         "; expected a network with one, an image");
  const OnnxTensor& input = signature.inputs.front();
  const char* expected =
      options.channels_last ? "1 x height x width x 3 (layout nhwc)" : "1 x 3 x height x width (layout nchw)";
  std::array<std::int64_t, 4> shape = {-1, -1, -1, -1};
  if (!input.shape.empty()) {
    if (input.shape.size() != 4 && !is_without_batch(input))
      fail("has an input of " + input.shape_text() + "; expected " + expected);
    std::copy(input.shape.rbegin(), input.shape.rend(), shape.rbegin());
  }
  const std::int64_t channels = shape[options.channels_last ? 3 : 1];
  if ((shape[0] != -1 && shape[0] != 1) || (channels != -1 && channels != 3))
    fail("has an input of " + input.shape_text() + "; expected " + expected + "; correct `layout`, or export the " +
         "network for one colour image");
  const std::size_t row = options.channels_last ? 1 : 2;
  const int height = net.agreed_size(input, options.height, shape[row], "height");
  return {net.agreed_size(input, options.width, shape[row + 1], "width"), height};
}

std::string chosen_output(const NetworkOptions& options, const OnnxSignature& signature) {
  std::vector<std::string> known;
  for (const OnnxTensor& output : signature.outputs) known.push_back(output.name);
  if (options.every_output) return known.front();
  if (options.output_name.empty()) {
    if (known.size() > 1)
      throw InputError({options.model.string()}, "has " + std::to_string(known.size()) + " outputs, " +
                                                     names(signature.outputs) + "; name one in `output_name`");
    return known.front();
  }
  if (std::find(known.begin(), known.end(), options.output_name) == known.end())
    throw InputError({options.model.string()}, "has no output '" + options.output_name + "'; " +
                                                   did_you_mean(options.output_name, known) + "; it has " +
                                                   names(signature.outputs));
  return options.output_name;
}

/// Whether the elements of an input are integers: not float, float16, double or bfloat16.
bool takes_integers(const OnnxTensor& input) {
  constexpr std::array<int, 5> real = {0, 1, 10, 11, 16};
  return std::find(real.begin(), real.end(), input.element_type) == real.end();
}

void require_three(const InputPreparation& options) {
  const auto fail = [](const char* name, const std::string& message) {
    throw ConfigurationError(SourceLocation{}, std::string(name) + ": " + message);
  };
  for (const auto& [name, values] :
       {std::pair("mean", &options.mean), std::pair("standard_deviation", &options.standard_deviation)})
    if (values->size() != 3)
      fail(name, "found " + counted(values->size(), "number") + "; expected 3, one for each channel");
  for (const double value : options.standard_deviation)
    if (!(value > 0.0)) fail("standard_deviation", "found " + std::to_string(value) + "; expected numbers above 0");
}

}  // namespace

struct Network::Parts {
  explicit Parts(const NetworkOptions& given)
      : options(given),
        net({given.model, given.bytes, given.in_background, given.engine, given.precision, std::max(1, given.threads),
             given.provider, given.engine_library}) {}

  NetworkOptions options;
  cv::Size size;
  OnnxTensor output;  // that run() computes
  OnnxNet net;
  InputPreparation preparation;
  FramePlace place;  // of the last image
  cv::Mat resized, input;
  std::vector<cv::Mat> scores;
  std::array<std::array<float, 256>, 3> value;  ///< of a pixel's value, by channel of the network

  void prepare(const InputPreparation& given) {
    require_range(given);
    preparation = given;
    place = {};
    for (std::size_t channel = 0; channel < 3; ++channel)
      for (std::size_t number = 0; number < 256; ++number)
        value[channel][number] = static_cast<float>((static_cast<double>(number) * given.scale - given.mean[channel]) /
                                                    given.standard_deviation[channel]);
  }

  /// Refuses numbers of which an input of integers would keep next to nothing.
  void require_range(const InputPreparation& given) const {
    if (options.engine != NetworkEngine::onnxruntime || !takes_integers(net.signature().inputs.front())) return;
    constexpr double least_range = 2.0;
    for (const double deviation : given.standard_deviation)
      if (255.0 * given.scale / deviation < least_range)
        throw InputError({options.model.string()},
                         "has an input of whole numbers, to which `scale` " + std::to_string(given.scale) +
                             " rounds all pixels to 0 or 1; expected `scale: 1` for such a network");
  }

  void fill_input(const cv::Mat& colour) {
    if (place.frame != colour.size()) {
      place = place_of_frame(colour.size(), size, preparation.letterbox);
      fill_padding();
    }
    const cv::Mat* image = &colour;
    if (colour.size() != place.content.size()) {
      const bool shrinks = colour.cols >= place.content.width && colour.rows >= place.content.height;
      cv::resize(colour, resized, place.content.size(), 0, 0, shrinks ? cv::INTER_AREA : cv::INTER_LINEAR);
      image = &resized;
    }
    const std::ptrdiff_t to_pixel = next_pixel(), to_channel = next_channel();
    for (int y = 0; y < image->rows; ++y) {
      const auto* from = image->ptr<std::uint8_t>(y);
      const std::ptrdiff_t first = (std::ptrdiff_t{place.content.y} + y) * size.width + place.content.x;
      float* to = input.ptr<float>() + first * to_pixel;
      for (int x = 0; x < image->cols; ++x, from += 3, to += to_pixel)
        for (std::size_t channel = 0; channel < 3; ++channel)
          to[static_cast<std::ptrdiff_t>(channel) * to_channel] =
              value[channel][from[preparation.rgb ? 2 - channel : channel]];
    }
  }

  std::ptrdiff_t next_pixel() const { return options.channels_last ? 3 : 1; }
  std::ptrdiff_t next_channel() const { return options.channels_last ? 1 : size.area(); }

  /// Grey around a letterbox.
  void fill_padding() {
    constexpr std::size_t grey = 114;
    if (place.content == cv::Rect({}, size)) return;
    float* to = input.ptr<float>();
    for (int i = 0; i < size.area(); ++i, to += next_pixel())
      for (std::size_t channel = 0; channel < 3; ++channel)
        to[static_cast<std::ptrdiff_t>(channel) * next_channel()] = value[channel][grey];
  }

  void mirror_input() {
    const int columns = size.width, channels = options.channels_last ? 3 : 1;
    const int rows = static_cast<int>(input.total()) / (columns * channels);
    cv::Mat lines(rows, columns, CV_32FC(channels), input.data);
    cv::flip(lines, lines, 1);
  }

  std::string input_text() const {
    return shape_text(std::vector<std::int64_t>(input.size.p, input.size.p + input.dims));
  }

  cv::Mat forward() {
    net.set_input(input, net.signature().inputs.front().name);
    net.run(scores);
    return scores.front();
  }
};

Network::Network(const NetworkOptions& options) {
  const InputPreparation preparation{false, options.rgb, options.scale, options.mean, options.standard_deviation};
  require_three(preparation);
  parts_ = std::make_unique<Parts>(options);
  const OnnxSignature& signature = parts_->net.signature();
  parts_->size = input_size(options, parts_->net);
  parts_->output = parts_->net.output(chosen_output(options, signature), "output_name");
  parts_->prepare(preparation);
  if (options.engine == NetworkEngine::opencv && options.threads > 0) cv::setNumThreads(options.threads);
  const int h = parts_->size.height, w = parts_->size.width;
  const int channels_first[] = {1, 3, h, w}, channels_last[] = {1, h, w, 3};
  cv::Mat& input = parts_->input;
  const int dimensions = is_without_batch(signature.inputs.front()) ? 3 : 4;
  input.create(dimensions, (options.channels_last ? channels_last : channels_first) + 4 - dimensions, CV_32F);
  std::vector<std::string> outputs = {parts_->output.name};
  if (options.every_output) {
    outputs.clear();
    for (const OnnxTensor& output : signature.outputs) outputs.push_back(output.name);
  }
  parts_->net.load({.inputs = {{signature.inputs.front().name, {input.size.p, input.size.p + input.dims}}},
                    .outputs = std::move(outputs),
                    .advice = "expected a network for such an image; check width, height and layout"});
}

Network::~Network() = default;

cv::Mat Network::run(const cv::Mat& colour) {
  HOLDFAST_CHECK(colour.type() == CV_8UC3 && !colour.empty(), "type " << colour.type());
  parts_->fill_input(colour);
  return parts_->forward();
}

void Network::set_preparation(const InputPreparation& preparation) {
  require_three(preparation);
  parts_->prepare(preparation);
}

const std::vector<cv::Mat>& Network::outputs() const { return parts_->scores; }
const OnnxSignature& Network::signature() const { return parts_->net.signature(); }

cv::Mat Network::run_mirrored() {
  parts_->mirror_input();
  return parts_->forward();
}

void Network::finish_loading() { parts_->net.finish_loading(); }

int Network::width() const { return parts_->size.width; }
int Network::height() const { return parts_->size.height; }

const OnnxTensor& Network::output() const { return parts_->output; }

std::string Network::input_text() const { return parts_->input_text(); }
std::string Network::engine_text() const { return parts_->net.engine_text(); }

}  // namespace holdfast
