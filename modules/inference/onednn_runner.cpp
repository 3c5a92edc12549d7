// SPDX-License-Identifier: BSD-3-Clause
#include <map>
#include <optional>
#include <utility>

#include "holdfast/core/error.hpp"
#include "holdfast/inference/network.hpp"
#include "network_runner.hpp"
#include "onednn_interface.hpp"
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

class OnednnRunner final : public NetworkRunner {
 public:
  OnednnRunner(std::filesystem::path model, std::span<const std::uint8_t> bytes, OnnxNet::Use use,
               NetworkPrecision precision, int threads)
      : model_(std::move(model)), use_(std::move(use)), threads_(threads) {
    const ThreadCount count(threads_);
    const OnnxGraph graph = read_onnx_graph(bytes, model_);
    const NetworkPlan plan = plan_network(graph, {use_.inputs.begin(), use_.inputs.end()}, use_.outputs, model_);
    try {
      program_.emplace(plan, precision);
    } catch (const dnnl::error& error) {
      fail(error);
    }
  }

  void run(const Inputs& inputs, std::vector<cv::Mat>& results) override {
    const ThreadCount count(threads_);
    try {
      program_->run({inputs.begin(), inputs.end()}, results);
    } catch (const dnnl::error& error) {
      fail(error);
    }
  }

 private:
  [[noreturn]] void fail(const dnnl::error& error) const {
    throw InputError({model_.string()}, cannot_run("oneDNN", use_, error.what()) + ", or use `engine: opencv`");
  }

  std::filesystem::path model_;
  OnnxNet::Use use_;
  int threads_;
  std::optional<OnednnProgram> program_;
};

}  // namespace

bool has_onednn() { return true; }

void require_onednn(NetworkPrecision precision) {
  if (precision == NetworkPrecision::bf16 && !onednn::has_bf16())
    throw ConfigurationError(SourceLocation{},
                             "precision: found bf16, but this processor has no instructions for it (AVX512_BF16), or "
                             "ONEDNN_MAX_CPU_ISA forbids them; expected fp32");
}

std::unique_ptr<NetworkRunner> load_with_onednn(const std::filesystem::path& model, std::span<const std::uint8_t> bytes,
                                                const OnnxNet::Use& use, NetworkPrecision precision, int threads) {
  return std::make_unique<OnednnRunner>(model, bytes, use, precision, threads);
}

}  // namespace holdfast
