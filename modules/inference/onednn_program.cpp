// SPDX-License-Identifier: BSD-3-Clause
#include "onednn_program.hpp"

#include <algorithm>
#include <utility>

#include "holdfast/core/check.hpp"
#include "onednn_interface.hpp"

namespace holdfast {

namespace {

using dnnl::memory;

constexpr auto float32 = memory::data_type::f32;

memory::dims dims(const PlaneShape& shape) { return {shape.begin(), shape.end()}; }
memory::dims pair(const std::array<std::int64_t, 2>& values) { return {values.begin(), values.end()}; }
memory::dims less_one(const std::array<std::int64_t, 2>& values) { return {values[0] - 1, values[1] - 1}; }
onednn::Window window_of(const PlannedLayer& layer) {
  const LayerWindow& window = layer.window;
  return {pair(window.size), pair(window.stride), less_one(window.dilation), pair(window.before), pair(window.after)};
}

memory::desc planes(const PlaneShape& shape) { return {dims(shape), float32, memory::format_tag::nchw}; }

/// Weights as an ONNX file has them: groups, outputs, inputs, rows, columns for oneDNN; those of transposed
/// convolutions lie with the inputs first.
memory::desc weights_in_file(const PlannedLayer& layer) {
  const std::vector<std::int64_t>& shape = layer.weights->shape;
  const bool is_transposed = layer.kind == LayerKind::transposed_convolution;
  const std::int64_t outputs = is_transposed ? shape[1] : shape[0] / layer.groups;
  const std::int64_t inputs = is_transposed ? shape[0] / layer.groups : shape[1];
  const std::int64_t area = shape[2] * shape[3];
  memory::dims sizes = {layer.groups, outputs, inputs, shape[2], shape[3]};
  memory::dims strides = {outputs * inputs * area, is_transposed ? area : inputs * area,
                          is_transposed ? outputs * area : area, shape[3], 1};
  if (layer.groups == 1) {
    sizes.erase(sizes.begin());
    strides.erase(strides.begin());
  }
  return {sizes, float32, strides};
}

/// Whether each value of the input alone makes a block of the output, as in the U-Net's 2x2 steps of 2: then the layer
/// is a convolution with a single pixel, whose result is spread out. oneDNN's own way is several times slower.
bool makes_blocks(const PlannedLayer& layer) {
  const LayerWindow& window = layer.window;
  const std::array<std::int64_t, 2> none = {0, 0};
  return layer.kind == LayerKind::transposed_convolution && layer.groups == 1 && !layer.added &&
         window.size == window.stride && window.dilation == std::array<std::int64_t, 2>{1, 1} &&
         window.before == none && window.after == none;
}

onednn::Elementwise function_of(const PlannedLayer& layer) {
  switch (layer.activation) {
    case Activation::leaky_relu:
      return {dnnl::algorithm::eltwise_relu, layer.first_parameter};
    case Activation::sigmoid:
      return {dnnl::algorithm::eltwise_logistic};
    case Activation::clip:
      return {dnnl::algorithm::eltwise_clip, layer.first_parameter, layer.second_parameter};
    case Activation::relu:
    case Activation::none:
      break;
  }
  return {dnnl::algorithm::eltwise_relu};
}

}  // namespace

OnednnProgram::OnednnProgram(const NetworkPlan& plan, NetworkPrecision precision)
    : engine_(dnnl::engine::kind::cpu, 0),
      stream_(engine_),
      precision_(precision == NetworkPrecision::bf16 ? memory::data_type::bf16 : float32),
      tensors_(plan.tensors.size()),
      is_output_(plan.tensors.size(), false) {
  const std::size_t end = plan.layers.size();
  for (std::size_t i = 0; i < end; ++i) {
    for (const std::size_t input : plan.layers[i].inputs) tensors_[input].last_reader = i;
    if (plan.layers[i].added) tensors_[*plan.layers[i].added].last_reader = i;
  }
  for (const std::size_t output : plan.outputs) {
    tensors_[output].last_reader = end;
    is_output_[output] = true;
  }
  for (const auto& [name, tensor] : plan.inputs) {
    tensors_[tensor].memory = memory(planes(plan.tensors[tensor]), engine_, nullptr);
    inputs_[name] = tensors_[tensor].memory;
  }
  for (std::size_t i = 0; i < end; ++i) add(plan, i);
  for (const std::size_t output : plan.outputs) {
    const PlaneShape& shape = plan.tensors[output];
    const int sizes[] = {static_cast<int>(shape[0]), static_cast<int>(shape[1]), static_cast<int>(shape[2]),
                         static_cast<int>(shape[3])};
    results_.emplace_back(4, sizes, CV_32F);
    add_copy(tensors_[output].memory, memory(planes(shape), engine_, results_.back().data));
  }
  allocate();
}

void OnednnProgram::run(const std::map<std::string, cv::Mat>& inputs, std::vector<cv::Mat>& results) {
  for (auto& [name, input] : inputs_) {
    const cv::Mat& values = inputs.at(name);
    HOLDFAST_CHECK(values.isContinuous() && values.depth() == CV_32F, "type " << values.type());
    input.set_data_handle(values.data);
  }
  for (const Step& step : steps_) step.primitive.execute(stream_, step.arguments);
  stream_.wait();
  results = results_;
}

void OnednnProgram::add(const NetworkPlan& plan, std::size_t index) {
  const PlannedLayer& layer = plan.layers[index];
  switch (layer.kind) {
    case LayerKind::convolution:
    case LayerKind::transposed_convolution:
      if (makes_blocks(layer))
        add_blocks(layer, plan);
      else
        add_convolution(layer, plan, index);
      break;
    case LayerKind::max_pool:
    case LayerKind::average_pool:
      add_pool(layer, plan);
      break;
    case LayerKind::concatenate:
      add_concatenation(layer, plan);
      break;
    case LayerKind::add:
      add_sum(layer);
      break;
    case LayerKind::softmax:
      add_softmax(layer);
      break;
    case LayerKind::activation:
      add_activation(layer);
      break;
  }
  release_copies();
  for (Tensor& tensor : tensors_)
    if (tensor.buffer && tensor.last_reader <= index)
      buffers_[*std::exchange(tensor.buffer, std::nullopt)].is_free = true;
}

memory::data_type OnednnProgram::type_of(std::size_t tensor) const { return is_output_[tensor] ? float32 : precision_; }

memory::desc OnednnProgram::any_layout(const NetworkPlan& plan, std::size_t tensor) const {
  return {dims(plan.tensors[tensor]), type_of(tensor), memory::format_tag::any};
}

void OnednnProgram::add_convolution(const PlannedLayer& layer, const NetworkPlan& plan, std::size_t index) {
  const memory::desc from_any(dims(plan.tensors[layer.inputs[0]]), precision_, memory::format_tag::any);
  const memory::desc stored = weights_in_file(layer);
  const memory::desc weights_any(onednn::dims(stored), precision_, memory::format_tag::any);
  memory::desc bias_layout;
  if (layer.bias != nullptr) bias_layout = {{layer.bias->shape[0]}, float32, memory::format_tag::x};
  // A sum is made in place, so that the result has the layout of the tensor to be added.
  memory::desc to_any = any_layout(plan, layer.output);
  if (layer.added && onednn::data_type(tensors_[*layer.added].memory.get_desc()) == type_of(layer.output))
    to_any = tensors_[*layer.added].memory.get_desc();
  const auto build = [&](auto kind, dnnl::algorithm algorithm) {
    using Primitive = decltype(kind);
    const auto [chosen, primitive] = onednn::convolution<Primitive>(engine_, algorithm, from_any, weights_any,
                                                                    layer.bias != nullptr ? &bias_layout : nullptr,
                                                                    to_any, window_of(layer), attributes(layer));
    Arguments arguments = {
        {DNNL_ARG_SRC, in_layout(layer.inputs[0], chosen.src_desc())},
        {DNNL_ARG_WEIGHTS, weights_in_layout(stored, layer.weights->numbers, chosen.weights_desc())}};
    if (layer.bias != nullptr)
      arguments[DNNL_ARG_BIAS] = weights_in_layout(bias_layout, layer.bias->numbers, bias_layout);
    Tensor& output = tensors_[layer.output];
    if (layer.added) {
      Tensor& added = tensors_[*layer.added];
      const bool in_place = added.buffer && added.last_reader == index && *layer.added != layer.inputs[0] &&
                            added.memory.get_desc() == chosen.dst_desc();
      if (in_place) {
        output.memory = added.memory;
        output.buffer = std::exchange(added.buffer, std::nullopt);
      } else {
        place(layer.output, chosen.dst_desc());
        add_copy(added.memory, output.memory);
      }
    } else {
      place(layer.output, chosen.dst_desc());
    }
    arguments[DNNL_ARG_DST] = output.memory;
    add_step(primitive, chosen.scratchpad_desc(), std::move(arguments));
  };
  if (layer.kind == LayerKind::convolution)
    build(dnnl::convolution_forward(), dnnl::algorithm::convolution_direct);
  else
    build(dnnl::deconvolution_forward(), dnnl::algorithm::deconvolution_direct);
}

void OnednnProgram::add_blocks(const PlannedLayer& layer, const NetworkPlan& plan) {
  const PlaneShape& from = plan.tensors[layer.inputs[0]];
  const std::vector<std::int64_t>& shape = layer.weights->shape;
  const std::int64_t inputs = shape[0], outputs = shape[1], rows = shape[2], columns = shape[3], area = rows * columns;
  // The channels of the convolution: row, column, channel of the output.
  std::vector<float> weights(static_cast<std::size_t>(area * outputs * inputs)), bias;
  auto* to = weights.data();
  for (std::int64_t pixel = 0; pixel < area; ++pixel)
    for (std::int64_t output = 0; output < outputs; ++output)
      for (std::int64_t input = 0; input < inputs; ++input)
        *to++ = layer.weights->numbers[static_cast<std::size_t>((input * outputs + output) * area + pixel)];
  for (std::int64_t pixel = 0; pixel < area && layer.bias != nullptr; ++pixel)
    bias.insert(bias.end(), layer.bias->numbers.begin(), layer.bias->numbers.end());
  bias.resize(static_cast<std::size_t>(area * outputs), 0.0F);

  const memory::desc stored({area * outputs, inputs, 1, 1}, float32, memory::format_tag::oihw);
  const memory::desc bias_layout({area * outputs}, float32, memory::format_tag::x);
  const memory::desc spread({from[0], area * outputs, from[2], from[3]}, precision_, memory::format_tag::nhwc);
  const auto [chosen, primitive] = onednn::convolution<dnnl::convolution_forward>(
      engine_, dnnl::algorithm::convolution_direct, {dims(from), precision_, memory::format_tag::any},
      {onednn::dims(stored), precision_, memory::format_tag::any}, &bias_layout, spread,
      {{1, 1}, {1, 1}, {0, 0}, {0, 0}, {0, 0}}, attributes(layer));
  const std::size_t buffer = acquire(spread.get_size());
  copies_.push_back(buffer);
  add_step(primitive, chosen.scratchpad_desc(),
           {{DNNL_ARG_SRC, in_layout(layer.inputs[0], chosen.src_desc())},
            {DNNL_ARG_WEIGHTS, weights_in_layout(stored, weights, chosen.weights_desc())},
            {DNNL_ARG_BIAS, weights_in_layout(bias_layout, bias, bias_layout)},
            {DNNL_ARG_DST, memory_in(buffer, spread)}});

  place(layer.output, {dims(plan.tensors[layer.output]), type_of(layer.output), memory::format_tag::nhwc});
  const std::int64_t piece = columns * outputs, row = from[3] * piece;  // values in a row of a block, of the output
  const memory::dims sizes = {from[0] * from[2], from[3], rows, piece};
  const memory::desc gathered(sizes, precision_, memory::dims{rows * row, rows * piece, piece, 1});
  const memory::desc laid_out(sizes, type_of(layer.output), memory::dims{rows * row, piece, row, 1});
  add_copy(memory_in(buffer, gathered), memory_in(*tensors_[layer.output].buffer, laid_out));
}

void OnednnProgram::add_pool(const PlannedLayer& layer, const NetworkPlan& plan) {
  const memory& from = tensors_[layer.inputs[0]].memory;
  const dnnl::algorithm algorithm = layer.kind == LayerKind::max_pool ? dnnl::algorithm::pooling_max
                                    : layer.counts_padding            ? dnnl::algorithm::pooling_avg_include_padding
                                                                      : dnnl::algorithm::pooling_avg_exclude_padding;
  const memory::desc to(dims(plan.tensors[layer.output]), onednn::data_type(from.get_desc()), memory::format_tag::any);
  const auto chosen = onednn::pooling(engine_, algorithm, from.get_desc(), to, window_of(layer), attributes(layer));
  place(layer.output, chosen.dst_desc());
  add_step(dnnl::pooling_forward(chosen), chosen.scratchpad_desc(),
           {{DNNL_ARG_SRC, from}, {DNNL_ARG_DST, tensors_[layer.output].memory}});
}

void OnednnProgram::add_concatenation(const PlannedLayer& layer, const NetworkPlan& plan) {
  std::vector<memory::desc> layouts;
  Arguments arguments;
  for (const std::size_t input : layer.inputs) {
    const memory::desc& here = tensors_[input].memory.get_desc();
    const memory::desc wanted(dims(plan.tensors[input]), precision_, memory::format_tag::nhwc);
    arguments[DNNL_ARG_MULTIPLE_SRC + static_cast<int>(layouts.size())] =
        onednn::data_type(here) == precision_ ? tensors_[input].memory : in_layout(input, wanted);
    layouts.push_back(onednn::data_type(here) == precision_ ? here : wanted);
  }
  const auto chosen = onednn::concatenation(engine_, layer.axis, layouts, attributes(layer));
  place(layer.output, chosen.dst_desc());
  arguments[DNNL_ARG_DST] = tensors_[layer.output].memory;
  add_step(dnnl::concat(chosen), chosen.scratchpad_desc(), std::move(arguments));
}

void OnednnProgram::add_sum(const PlannedLayer& layer) {
  const memory::desc layout = tensors_[layer.inputs[0]].memory.get_desc();
  const auto chosen = onednn::sum(engine_, layout, attributes(layer));
  const memory other = in_layout(layer.inputs[1], layout);
  place(layer.output, layout);
  add_step(dnnl::binary(chosen), chosen.scratchpad_desc(),
           {{DNNL_ARG_SRC_0, tensors_[layer.inputs[0]].memory},
            {DNNL_ARG_SRC_1, other},
            {DNNL_ARG_DST, tensors_[layer.output].memory}});
}

void OnednnProgram::add_softmax(const PlannedLayer& layer) {
  // In full precision, because it is what the user sees.
  const memory::desc here = tensors_[layer.inputs[0]].memory.get_desc();
  const memory::desc layout(onednn::dims(here), float32, memory::format_tag::nchw);
  const auto chosen = onednn::softmax(engine_, layout, layer.axis, attributes(layer));
  const memory from = in_layout(layer.inputs[0], layout);
  place(layer.output, layout);
  add_step(dnnl::softmax_forward(chosen), chosen.scratchpad_desc(),
           {{DNNL_ARG_SRC, from}, {DNNL_ARG_DST, tensors_[layer.output].memory}});
}

void OnednnProgram::add_activation(const PlannedLayer& layer) {
  const memory from = tensors_[layer.inputs[0]].memory;
  const auto chosen = onednn::elementwise(engine_, function_of(layer), from.get_desc(), attributes({}));
  place(layer.output, from.get_desc());
  add_step(dnnl::eltwise_forward(chosen), chosen.scratchpad_desc(),
           {{DNNL_ARG_SRC, from}, {DNNL_ARG_DST, tensors_[layer.output].memory}});
}

dnnl::primitive_attr OnednnProgram::attributes(const PlannedLayer& layer) const {
  dnnl::primitive_attr result;
  // Memory of our own: the library's belongs to the thread that made the primitive, which may be another one.
  result.set_scratchpad_mode(dnnl::scratchpad_mode::user);
  if (layer.kind != LayerKind::convolution && layer.kind != LayerKind::transposed_convolution) return result;
  dnnl::post_ops operations;
  if (layer.added) operations.append_sum();
  if (layer.activation != Activation::none) onednn::append(operations, function_of(layer));
  result.set_post_ops(operations);
  return result;
}

memory OnednnProgram::in_layout(std::size_t tensor, const memory::desc& layout) {
  const memory here = tensors_[tensor].memory;
  if (here.get_desc() == layout) return here;
  copies_.push_back(acquire(layout.get_size()));
  const memory copy = memory_in(copies_.back(), layout);
  add_copy(here, copy);
  return copy;
}

memory OnednnProgram::weights_in_layout(const memory::desc& from, const std::vector<float>& values,
                                        const memory::desc& to) {
  // oneDNN reads from memory that is not const.
  const memory source(from, engine_, const_cast<float*>(values.data()));
  memory result(to, engine_);
  dnnl::reorder(source, result).execute(stream_, {{DNNL_ARG_FROM, source}, {DNNL_ARG_TO, result}});
  stream_.wait();
  return result;
}

std::size_t OnednnProgram::acquire(std::size_t bytes) {
  const auto wasted = [&](const Buffer& buffer) {
    return buffer.bytes > bytes ? buffer.bytes - bytes : bytes - buffer.bytes;
  };
  std::size_t best = buffers_.size();
  for (std::size_t i = 0; i < buffers_.size(); ++i)
    if (buffers_[i].is_free && (best == buffers_.size() || wasted(buffers_[i]) < wasted(buffers_[best]))) best = i;
  if (best == buffers_.size()) buffers_.emplace_back();
  buffers_[best].is_free = false;
  buffers_[best].bytes = std::max(buffers_[best].bytes, bytes);
  return best;
}

memory OnednnProgram::memory_in(std::size_t buffer, const memory::desc& layout) {
  memory result(layout, engine_, nullptr);
  buffers_[buffer].users.push_back(result);
  return result;
}

void OnednnProgram::place(std::size_t tensor, const memory::desc& layout) {
  tensors_[tensor].buffer = acquire(layout.get_size());
  tensors_[tensor].memory = memory_in(*tensors_[tensor].buffer, layout);
}

void OnednnProgram::add_step(const dnnl::primitive& primitive, const memory::desc& scratchpad, Arguments arguments) {
  if (scratchpad.get_size() > 0) {
    copies_.push_back(acquire(scratchpad.get_size()));
    arguments[DNNL_ARG_SCRATCHPAD] = memory_in(copies_.back(), scratchpad);
  }
  steps_.push_back({primitive, std::move(arguments)});
}

void OnednnProgram::add_copy(const memory& from, const memory& to) {
  const dnnl::reorder::primitive_desc chosen(from, to);
  add_step(dnnl::reorder(chosen), {}, {{DNNL_ARG_FROM, from}, {DNNL_ARG_TO, to}});
}

void OnednnProgram::release_copies() {
  for (const std::size_t buffer : copies_) buffers_[buffer].is_free = true;
  copies_.clear();
}

void OnednnProgram::allocate() {
  for (const Buffer& buffer : buffers_) {
    storage_.emplace_back(static_cast<std::byte*>(::operator new(buffer.bytes, line)));
    for (const memory& user : buffer.users) user.set_data_handle(storage_.back().get());
  }
}

}  // namespace holdfast
