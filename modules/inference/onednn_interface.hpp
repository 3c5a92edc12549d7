// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <oneapi/dnnl/dnnl.hpp>
#include <utility>
#include <vector>

/// What OnednnProgram needs of oneDNN's interface, which differs between its versions 2 and 3: version 2 describes a
/// primitive in two steps, an operation and its implementation, version 3 in one. All descriptions are for inference.
namespace holdfast::onednn {

using dnnl::memory;

constexpr auto inference = dnnl::prop_kind::forward_inference;

/// Where a convolution or pooling looks: rows, columns.
struct Window {
  memory::dims size, stride, dilation_less_one, before, after;
};

/// A function of each value alone.
struct Elementwise {
  dnnl::algorithm algorithm;
  float alpha = 0.0F, beta = 0.0F;
};

/// A primitive and the description of its implementation.
template <class Primitive>
struct Made {
  typename Primitive::primitive_desc chosen;
  Primitive primitive;
};

/// The primitive of oneDNN's favourite implementation that can be made: some that say they can do a layer then cannot
/// compile it.
template <class Primitive>
Made<Primitive> make(typename Primitive::primitive_desc chosen) {
  while (true) {
    try {
      const Primitive primitive(chosen);
      return {std::move(chosen), primitive};
    } catch (const dnnl::error&) {
      if (!chosen.next_impl()) throw;
    }
  }
}

#if DNNL_VERSION_MAJOR >= 3

inline memory::dims dims(const memory::desc& layout) { return layout.get_dims(); }
inline memory::data_type data_type(const memory::desc& layout) { return layout.get_data_type(); }

inline void append(dnnl::post_ops& operations, const Elementwise& function) {
  operations.append_eltwise(function.algorithm, function.alpha, function.beta);
}

/// `bias` is null for none. Primitive: dnnl::convolution_forward or dnnl::deconvolution_forward.
template <class Primitive>
Made<Primitive> convolution(const dnnl::engine& engine, dnnl::algorithm algorithm, const memory::desc& from,
                            const memory::desc& weights, const memory::desc* bias, const memory::desc& to,
                            const Window& window, const dnnl::primitive_attr& attributes) {
  using Description = typename Primitive::primitive_desc;
  if (bias == nullptr)
    return make<Primitive>(Description(engine, inference, algorithm, from, weights, to, window.stride,
                                       window.dilation_less_one, window.before, window.after, attributes));
  return make<Primitive>(Description(engine, inference, algorithm, from, weights, *bias, to, window.stride,
                                     window.dilation_less_one, window.before, window.after, attributes));
}

inline dnnl::pooling_forward::primitive_desc pooling(const dnnl::engine& engine, dnnl::algorithm algorithm,
                                                     const memory::desc& from, const memory::desc& to,
                                                     const Window& window, const dnnl::primitive_attr& attributes) {
  return {engine,        inference,    algorithm, from, to, window.stride, window.size, window.dilation_less_one,
          window.before, window.after, attributes};
}

inline dnnl::concat::primitive_desc concatenation(const dnnl::engine& engine, int axis,
                                                  const std::vector<memory::desc>& from,
                                                  const dnnl::primitive_attr& attributes) {
  return {engine, axis, from, attributes};
}

/// Of two tensors of the same layout.
inline dnnl::binary::primitive_desc sum(const dnnl::engine& engine, const memory::desc& layout,
                                        const dnnl::primitive_attr& attributes) {
  return {engine, dnnl::algorithm::binary_add, layout, layout, layout, attributes};
}

inline dnnl::softmax_forward::primitive_desc softmax(const dnnl::engine& engine, const memory::desc& layout, int axis,
                                                     const dnnl::primitive_attr& attributes) {
  return {engine, inference, dnnl::algorithm::softmax_accurate, layout, layout, axis, attributes};
}

inline dnnl::eltwise_forward::primitive_desc elementwise(const dnnl::engine& engine, const Elementwise& function,
                                                         const memory::desc& layout,
                                                         const dnnl::primitive_attr& attributes) {
  return {engine, inference, function.algorithm, layout, layout, function.alpha, function.beta, attributes};
}

#else

inline memory::dims dims(const memory::desc& layout) { return layout.dims(); }
inline memory::data_type data_type(const memory::desc& layout) { return layout.data_type(); }

inline void append(dnnl::post_ops& operations, const Elementwise& function) {
  operations.append_eltwise(1.0F, function.algorithm, function.alpha, function.beta);
}

template <class Primitive>
Made<Primitive> convolution(const dnnl::engine& engine, dnnl::algorithm algorithm, const memory::desc& from,
                            const memory::desc& weights, const memory::desc* bias, const memory::desc& to,
                            const Window& window, const dnnl::primitive_attr& attributes) {
  using Operation = typename Primitive::desc;
  // Outlives the search for an implementation, which keeps its address.
  const Operation operation = bias == nullptr ? Operation(inference, algorithm, from, weights, to, window.stride,
                                                          window.dilation_less_one, window.before, window.after)
                                              : Operation(inference, algorithm, from, weights, *bias, to, window.stride,
                                                          window.dilation_less_one, window.before, window.after);
  return make<Primitive>(typename Primitive::primitive_desc(operation, attributes, engine));
}

inline dnnl::pooling_forward::primitive_desc pooling(const dnnl::engine& engine, dnnl::algorithm algorithm,
                                                     const memory::desc& from, const memory::desc& to,
                                                     const Window& window, const dnnl::primitive_attr& attributes) {
  return {dnnl::pooling_forward::desc(inference, algorithm, from, to, window.stride, window.size, window.before,
                                      window.after),
          attributes, engine};
}

inline dnnl::concat::primitive_desc concatenation(const dnnl::engine& engine, int axis,
                                                  const std::vector<memory::desc>& from,
                                                  const dnnl::primitive_attr& attributes) {
  return {axis, from, engine, attributes};
}

inline dnnl::binary::primitive_desc sum(const dnnl::engine& engine, const memory::desc& layout,
                                        const dnnl::primitive_attr& attributes) {
  return {dnnl::binary::desc(dnnl::algorithm::binary_add, layout, layout, layout), attributes, engine};
}

inline dnnl::softmax_forward::primitive_desc softmax(const dnnl::engine& engine, const memory::desc& layout, int axis,
                                                     const dnnl::primitive_attr& attributes) {
  return {dnnl::softmax_forward::desc(inference, layout, axis), attributes, engine};
}

inline dnnl::eltwise_forward::primitive_desc elementwise(const dnnl::engine& engine, const Elementwise& function,
                                                         const memory::desc& layout,
                                                         const dnnl::primitive_attr& attributes) {
  return {dnnl::eltwise_forward::desc(inference, function.algorithm, layout, function.alpha, function.beta), attributes,
          engine};
}

#endif

/// Whether this processor, and ONEDNN_MAX_CPU_ISA, let oneDNN compute bf16 by instructions for it, and not emulate it,
/// which is slower than fp32. Every instruction set of oneDNN's enumeration has the bits of those that it includes.
inline bool has_bf16() {
  constexpr auto needed = static_cast<unsigned>(dnnl::cpu_isa::avx512_core_bf16);
  return (static_cast<unsigned>(dnnl::get_effective_cpu_isa()) & needed) == needed;
}

}  // namespace holdfast::onednn
