// SPDX-License-Identifier: Apache-2.0
/// Locates the data of one primitive, either in accessors or in a Draco mesh that accessors describe.
#pragma once

#include <optional>

#include "common/base/result.h"
#include "renderfarm/scene/gltf_accessor.h"
#include "renderfarm/scene/gltf_context.h"
#include "renderfarm/scene/gltf_draco.h"
#include "renderfarm/scene/gltf_triangles.h"
#include "renderfarm/scene/gltf_vertices.h"

namespace cyclorama::scene {

/// One primitive with a surface or of points. Borrows document and context. Thread-bound.
class GltfPrimitive {
 public:
  /// Opens a primitive. Returns nothing, with a note, if it cannot be shown: if it has lines, no positions or no
  /// vertices.
  static Result<std::optional<GltfPrimitive>> open(GltfDocument* document, GltfContext* context,
                                                   const GltfObject& primitive);

  [[nodiscard]] std::size_t vertex_count() const { return vertex_count_; }
  [[nodiscard]] bool is_points() const { return topology_ == GltfTopology::kPoints; }
  [[nodiscard]] bool has(const char* semantic) const { return attributes_.has(semantic); }
  /// Returns the triangles; all corners are below vertex_count().
  Result<GltfTriangles> triangles() const;
  /// Returns an attribute; nothing if the primitive lacks it. Errors: kBadData if its type or count is wrong or its
  /// data is outside the buffer.
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
