// SPDX-License-Identifier: Apache-2.0
/// Locates the data of one primitive: in accessors, or in a Draco mesh with accessors that describe it.
#pragma once

#include <optional>

#include "common/base/result.h"
#include "renderfarm/scene/gltf_accessor.h"
#include "renderfarm/scene/gltf_context.h"
#include "renderfarm/scene/gltf_draco.h"
#include "renderfarm/scene/gltf_triangles.h"
#include "renderfarm/scene/gltf_vertices.h"

namespace cyclorama::scene {

/// Borrows document and context. Thread-bound.
class GltfPrimitive {
 public:
  /// Returns nothing, with a note, for a primitive without a surface: points, lines, no positions, no vertices.
  static Result<std::optional<GltfPrimitive>> open(GltfDocument* document, GltfContext* context,
                                                   const GltfObject& primitive);

  [[nodiscard]] std::size_t vertex_count() const { return vertex_count_; }
  [[nodiscard]] bool has(const char* semantic) const { return attributes_.has(semantic); }
  /// All corners are below vertex_count().
  Result<GltfTriangles> triangles() const;
  /// Returns nothing if the primitive lacks it. Errors: kBadData if its type or count is wrong or it lies outside its
  /// buffer.
  Result<std::optional<GltfAccessor>> attribute(const char* semantic, GltfVertexKind kind) const;

 private:
  GltfPrimitive(GltfDocument* document, GltfContext* context, GltfObject object, GltfObject attributes)
      : document_(document), context_(context), object_(std::move(object)), attributes_(std::move(attributes)) {}
  Status open_draco(const GltfObject& extension);

  GltfDocument* document_;
  GltfContext* context_;
  GltfObject object_;
  GltfObject attributes_;
  GltfTopology topology_ = GltfTopology::kTriangles;
  std::size_t vertex_count_ = 0;
  std::optional<GltfDracoMesh> draco_;
};

}  // namespace cyclorama::scene
