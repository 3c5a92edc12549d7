// SPDX-License-Identifier: BSD-3-Clause
#include <map>
#include <optional>
#include <utility>

#include "holdfast/core/error.hpp"
#include "holdfast/inference/network.hpp"
#include "network_runner.hpp"
#include "onednn_program.hpp"
#include "onnx_graph.hpp"

#if DNNL_CPU_RUNTIME != DNNL_RUNTIME_OMP
#error "expected a oneDNN that runs on OpenMP"
#endif

// Of libgomp, on which oneDNN runs; the headers of another compiler's OpenMP would bring another library.
extern "C" {
void omp_set_num_threads(int count);
int omp_get_max_threads();
}

namespace holdfast {

namespace {

/// OpenMP's number of threads for what the calling thread starts. Others are not affected.
class ThreadCount {
 public:
  explicit ThreadCount(int count) : before_(omp_get_max_threads()) { omp_set_num_threads(count); }
  ~ThreadCount() { omp_set_num_threads(before_); }
  ThreadCount(const ThreadCount&) = delete;
  ThreadCount& operator=(const ThreadCount&) = delete;

 private:
  int before_;
};

/// Compiles the network for the shapes of the first run, and again when they change.
class OnednnRunner final : public NetworkRunner {
 public:
  OnednnRunner(std::filesystem::path model, std::span<const std::uint8_t> bytes, NetworkPrecision precision,
               int threads)
      : model_(std::move(model)), graph_(read_onnx_graph(bytes, model_)), precision_(precision), threads_(threads) {}

  void run(const Inputs& inputs, const std::vector<std::string>& outputs, std::vector<cv::Mat>& results,
           const std::string& advice) override {
    const ThreadCount count(threads_);
    std::map<std::string, cv::Mat> values;
    std::map<std::string, std::vector<std::int64_t>> shapes;
    for (const auto& [name, input] : inputs) {
      const std::string& known = name.empty() ? graph_.signature.inputs.front().name : name;
      values[known] = input;
      shapes[known] = {input.size.p, input.size.p + input.dims};
    }
    try {
      if (!program_ || shapes != shapes_ || outputs != outputs_) {
        program_.reset();
        program_.emplace(plan_network(graph_, shapes, outputs, model_), precision_);
        shapes_ = std::move(shapes);
        outputs_ = outputs;
      }
      program_->run(values, results);
    } catch (const dnnl::error& error) {
      throw InputError({model_.string()}, "cannot be run by oneDNN on an input of " + shapes_of(inputs) + " (" +
                                              error.what() + "); " + advice + ", or use `engine: opencv`");
    }
  }

 private:
  std::filesystem::path model_;
  OnnxGraph graph_;
  NetworkPrecision precision_;
  int threads_;
  std::map<std::string, std::vector<std::int64_t>> shapes_;
  std::vector<std::string> outputs_;
  std::optional<OnednnProgram> program_;
};

}  // namespace

bool has_onednn() { return true; }

void require_onednn(NetworkPrecision precision) {
  if (precision != NetworkPrecision::bf16) return;
  const dnnl::cpu_isa known = dnnl::get_effective_cpu_isa();
  // oneDNN emulates bf16 on others, slower than fp32.
  if (known != dnnl::cpu_isa::avx512_core_bf16 && known != dnnl::cpu_isa::avx512_core_amx)
    throw ConfigurationError(SourceLocation{},
                             "precision: found bf16, but this processor has no instructions for it (AVX512_BF16), or "
                             "ONEDNN_MAX_CPU_ISA forbids them; expected fp32");
}

std::unique_ptr<NetworkRunner> load_with_onednn(const std::filesystem::path& model, std::span<const std::uint8_t> bytes,
                                                NetworkPrecision precision, int threads) {
  return std::make_unique<OnednnRunner>(model, bytes, precision, threads);
}

}  // namespace holdfast
