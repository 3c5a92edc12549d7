// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

/// Who calls whom: a pipeline waits for the modules that it calls, so that a module must not wait for its pipeline.
namespace holdfast::python {

/// Identity of a pipeline that Python feeds; compared, never followed.
using PipelineIdentity = const void*;

/// During its life, the modules that this thread makes belong to a pipeline.
class ModuleMaking {
 public:
  explicit ModuleMaking(PipelineIdentity pipeline);
  ~ModuleMaking();
  ModuleMaking(const ModuleMaking&) = delete;
  ModuleMaking& operator=(const ModuleMaking&) = delete;

  /// The pipeline for which this thread makes modules; nullptr for none.
  static PipelineIdentity pipeline();

 private:
  PipelineIdentity before_;
};

/// Whether the pipeline holds its map's lock while it calls a module.
enum class MapLock { free, held };

/// A call of a module in this thread, for the time that it takes.
class ModuleCall {
 public:
  /// `class_name` and `member` must outlive the call.
  ModuleCall(PipelineIdentity pipeline, const std::string& class_name, const char* member, MapLock map_lock);
  ~ModuleCall();
  ModuleCall(const ModuleCall&) = delete;
  ModuleCall& operator=(const ModuleCall&) = delete;

  /// The call of a module of this pipeline that is in progress in this thread; nullptr if there is none.
  static const ModuleCall* of(PipelineIdentity pipeline);
  /// "Watcher.on_frame".
  std::string name() const { return class_name_ + "." + member_; }
  MapLock map_lock() const { return map_lock_; }

 private:
  PipelineIdentity pipeline_;
  const std::string& class_name_;
  const char* member_;
  MapLock map_lock_;
  const ModuleCall* outer_;
};

}  // namespace holdfast::python
