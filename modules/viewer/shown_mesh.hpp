// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <unordered_map>
#include <vector>

#include "holdfast/core/surface_patch.hpp"
#include "message.hpp"

namespace holdfast::viewer {

/// What one browser has been told of the mesh.
struct MeshProgress {
  std::uint64_t number = 0;  ///< of the mesh; another one: begin anew
  std::uint64_t change = 0;  ///< it has all changes up to this one
};

/// The mesh of the surface as browsers are told of it: patches by slot, each with the number of its last change. When
/// there are too many triangles, coarser patches are wanted, and everything is told anew; of the coarsest patches those
/// that come too late are left out. One thread.
class ShownMesh {
 public:
  static constexpr std::size_t most_triangles = 300'000;
  /// A message brings changed patches until they have so many triangles together; the others come with the next one.
  static constexpr std::size_t most_in_message = 20'000;
  static constexpr int coarsest = 2;

  /// Takes over patches that may have changed. Those that look the same as before are not told again; all are ignored
  /// if they are finer than wanted.
  void add(std::vector<SurfacePatch> patches, int coarseness);
  /// Replaces everything by the patches of a mesh, whatever their cubes.
  void replace(std::vector<SurfacePatch> patches);

  /// Of the patches that are wanted, see ObservedSurface::changes.
  int coarseness() const { return wanted_; }
  std::size_t triangle_count() const { return triangles_; }
  /// Whether describe() would say something.
  bool has_more(const MeshProgress& progress) const;
  /// Adds what the browser lacks, and moves its progress.
  void describe(MeshProgress& progress, Message& message) const;

 private:
  struct Slot {
    SurfacePatch patch;
    std::uint64_t change = 0;
  };
  void clear();
  void put(std::uint32_t number, SurfacePatch patch);

  std::vector<Slot> slots_;
  std::unordered_map<std::uint64_t, std::uint32_t> slot_of_;  // by the key of the cube; never iterated over
  std::map<std::uint64_t, std::uint32_t> changes_;            // slots by their last change
  std::uint64_t change_ = 0, number_ = 1;
  std::size_t triangles_ = 0;
  int shown_ = 0, wanted_ = 0;  // coarseness
};

}  // namespace holdfast::viewer
