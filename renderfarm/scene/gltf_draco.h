// SPDX-License-Identifier: Apache-2.0
/// KHR_draco_mesh_compression, decoded by libdraco.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "common/base/result.h"
#include "renderfarm/scene/gltf_accessor.h"
#include "renderfarm/scene/gltf_triangles.h"

namespace cyclorama::scene {

/// Sizes that the primitive's accessors declare; compressed data that announces other sizes is refused before it is
/// decoded.
struct GltfDracoPromise {
  std::uint64_t triangles = 0;
  std::uint64_t vertices = 0;
};

/// One decoded primitive. Move-only, thread-bound.
class GltfDracoMesh {
 public:
  /// Decodes a primitive; `extension` is its KHR_draco_mesh_compression object. Errors: kBadData if the data is damaged
  /// or exceeds the budget.
  static Result<GltfDracoMesh> decode(GltfDocument* document, const GltfObject& extension,
                                      const GltfDracoPromise& promise, GltfBudget* budget);
  GltfDracoMesh(GltfDracoMesh&&) noexcept;
  GltfDracoMesh& operator=(GltfDracoMesh&&) noexcept;
  ~GltfDracoMesh();

  /// Returns the triangles. Precondition: the caller has charged the budget for them.
  [[nodiscard]] GltfTriangles triangles() const;
  /// Returns an attribute; nothing if `semantic` (such as "POSITION") is not compressed. `shape` is that of its
  /// accessor.
  Result<std::optional<GltfAccessor>> attribute(const char* semantic, const GltfAccessorShape& shape,
                                                GltfBudget* budget) const;

 private:
  struct State;
  explicit GltfDracoMesh(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace cyclorama::scene
