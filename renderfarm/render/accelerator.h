// SPDX-License-Identifier: Apache-2.0
/// The BVH of a scene: Embree's device and scenes, and the tables that interpret a hit.
#pragma once

#include <atomic>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "common/base/result.h"
#include "renderfarm/render/memory.h"
#include "renderfarm/render/splats/splat_scene.h"
#include "renderfarm/render/trace_scene.h"

namespace cyclorama::render {

/// Owns Embree's device and scenes. Borrows the vertex and index arrays of the scene for which it was built; they must
/// outlive it and not change. Thread-safe once built.
class Accelerator {
 public:
  /// Builds the BVH of `scene`, bakes its meshes that have one instance (see bake()), and fills `ret_traced` with
  /// tables that point into the scene. `wanted` is as in choose_memory_mode(). Errors: kInvalidArgument if there are
  /// neither triangles nor splats; kSystem if the scene would not fit into memory or Embree fails.
  static Result<std::unique_ptr<Accelerator>> build(scene::Scene& scene, int threads,
                                                    const std::function<void(double)>& progress,
                                                    std::optional<MemoryMode> wanted, TraceScene* ret_traced);
  ~Accelerator();
  Accelerator(const Accelerator&) = delete;
  Accelerator& operator=(const Accelerator&) = delete;

  [[nodiscard]] std::size_t bytes() const { return static_cast<std::size_t>(bytes_.load()); }
  [[nodiscard]] MemoryMode mode() const { return mode_; }

 private:
  Accelerator() = default;
  Status open_device(int threads);
  /// Returns a new scene of Embree with the flags that all have.
  [[nodiscard]] RTCScene new_scene() const;
  /// Returns Embree's error since the last call as one sentence, prefixed with `doing`.
  Status check(const char* doing) const;
  Status add_meshes(scene::Scene& scene, TraceScene* ret_traced);
  /// Adds a mesh. A mesh with several instances gets a separate BVH, which they share.
  void add_mesh(const scene::Model& model, scene::Mesh& mesh, int uses, TraceScene* ret_traced);
  /// Adds an instance, and bakes its mesh if the mesh has no other instance.
  void add_instance(scene::Model& model, scene::Instance& instance, const Eigen::Vector3d& origin,
                    TraceScene* ret_traced);
  /// Adds the geometry of the last placement to the panes.
  void add_pane(RTCGeometry geometry, TraceScene* ret_traced);
  Status add_lights(const scene::Scene& scene, TraceScene* ret_traced);
  RTCGeometry make_triangles(const scene::Mesh& mesh, SurfaceMesh* traced);
  Status commit(const std::function<void(double)>& progress);
  static bool count_memory(void* self, ssize_t bytes, bool post);

  MemoryMode mode_ = MemoryMode::kFast;
  RTCDevice device_ = nullptr;
  RTCScene top_ = nullptr;
  RTCScene panes_ = nullptr;  ///< Null if there are no panes.
  struct Part {
    RTCScene scene;
    std::size_t triangles;
  };
  std::vector<Part> parts_;
  std::unique_ptr<SplatScene> splats_;  ///< Null if there are no splats.
  std::vector<RTCScene> part_of_mesh_;  ///< Null for meshes that are used once.
  std::vector<bool> see_through_;       ///< For each texture of the model: whether any of its texels is transparent.
  std::size_t top_triangles_ = 0;
  std::atomic<std::int64_t> bytes_ = 0;
  std::int64_t limit_bytes_ = std::numeric_limits<std::int64_t>::max();
};

}  // namespace cyclorama::render
