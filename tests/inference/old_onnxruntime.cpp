// SPDX-License-Identifier: BSD-3-Clause
// What a library of ONNX Runtime before 1.12 answers.
#include <cstdint>

namespace {

const void* api(std::uint32_t) noexcept { return nullptr; }
const char* version() noexcept { return "1.7.2"; }

struct Base {
  const void* (*get_api)(std::uint32_t) noexcept;
  const char* (*get_version)() noexcept;
};

}  // namespace

extern "C" const Base* OrtGetApiBase() noexcept {
  static const Base base = {&api, &version};
  return &base;
}
