// SPDX-License-Identifier: BSD-3-Clause
#include "module_call.hpp"

namespace holdfast::python {

namespace {

thread_local PipelineIdentity making = nullptr;
thread_local const ModuleCall* innermost = nullptr;

}  // namespace

ModuleMaking::ModuleMaking(PipelineIdentity pipeline) : before_(making) { making = pipeline; }
ModuleMaking::~ModuleMaking() { making = before_; }
PipelineIdentity ModuleMaking::pipeline() { return making; }

ModuleCall::ModuleCall(PipelineIdentity pipeline, const std::string& class_name, const char* member, MapLock map_lock)
    : pipeline_(pipeline), class_name_(class_name), member_(member), map_lock_(map_lock), outer_(innermost) {
  innermost = this;
}
ModuleCall::~ModuleCall() { innermost = outer_; }

const ModuleCall* ModuleCall::of(PipelineIdentity pipeline) {
  for (const ModuleCall* call = innermost; call != nullptr; call = call->outer_)
    if (call->pipeline_ == pipeline) return call;
  return nullptr;
}

}  // namespace holdfast::python
