// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <new>
#include <oneapi/dnnl/dnnl.hpp>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "holdfast/settings/network_engine.hpp"
#include "network_plan.hpp"

namespace holdfast {

/// A plan compiled to oneDNN's primitives, with its weights in the layout that these want. Tensors that are not needed
/// at the same time share memory. Used by one thread at a time. Throws dnnl::error for what oneDNN cannot do.
class OnednnProgram {
 public:
  /// Weights are copied: neither the plan nor its graph needs to outlive the program.
  OnednnProgram(const NetworkPlan& plan, NetworkPrecision precision);

  /// Runs for inputs (32F, of the shapes that were planned; by name) and writes the outputs of the plan: 32F, in the
  /// program's own memory, valid until the next run.
  void run(const std::map<std::string, cv::Mat>& inputs, std::vector<cv::Mat>& results);

 private:
  using Arguments = std::unordered_map<int, dnnl::memory>;
  struct Step {
    dnnl::primitive primitive;
    Arguments arguments;
  };
  /// Memory that tensors use one after the other.
  struct Buffer {
    std::size_t bytes = 0;
    bool is_free = false;
    std::vector<dnnl::memory> users;
  };
  static constexpr std::align_val_t line{64};  ///< of the cache, and the widest vector
  struct Release {
    void operator()(std::byte* bytes) const { ::operator delete(bytes, line); }
  };
  struct Tensor {
    dnnl::memory memory;
    std::optional<std::size_t> buffer;  ///< none for inputs
    std::size_t last_reader = 0;        ///< index of a layer
  };

  void add(const NetworkPlan& plan, std::size_t index);
  void add_convolution(const PlannedLayer& layer, const NetworkPlan& plan, std::size_t index);
  void add_blocks(const PlannedLayer& layer, const NetworkPlan& plan);
  void add_pool(const PlannedLayer& layer, const NetworkPlan& plan);
  void add_concatenation(const PlannedLayer& layer, const NetworkPlan& plan);
  void add_sum(const PlannedLayer& layer);
  void add_softmax(const PlannedLayer& layer);
  void add_activation(const PlannedLayer& layer);

  dnnl::memory::desc any_layout(const NetworkPlan& plan, std::size_t tensor) const;
  dnnl::memory::data_type type_of(std::size_t tensor) const;
  /// The tensor in that layout and type: itself, or a copy for the time of one layer.
  dnnl::memory in_layout(std::size_t tensor, const dnnl::memory::desc& layout);
  dnnl::memory weights_in_layout(const dnnl::memory::desc& from, const std::vector<float>& values,
                                 const dnnl::memory::desc& to);
  std::size_t acquire(std::size_t bytes);
  dnnl::memory memory_in(std::size_t buffer, const dnnl::memory::desc& layout);
  void place(std::size_t tensor, const dnnl::memory::desc& layout);
  dnnl::primitive_attr attributes(const PlannedLayer& layer) const;
  void add_step(const dnnl::primitive& primitive, const dnnl::memory::desc& scratchpad, Arguments arguments);
  void add_copy(const dnnl::memory& from, const dnnl::memory& to);
  void release_copies();
  void allocate();

  dnnl::engine engine_;
  dnnl::stream stream_;
  dnnl::memory::data_type precision_;
  std::vector<Tensor> tensors_;
  std::vector<bool> is_output_;
  std::vector<Buffer> buffers_;
  std::vector<std::size_t> copies_;  ///< buffers that the present layer alone uses
  std::vector<Step> steps_;
  std::map<std::string, dnnl::memory> inputs_;
  std::vector<cv::Mat> results_;
  std::vector<std::unique_ptr<std::byte, Release>> storage_;
};

}  // namespace holdfast
