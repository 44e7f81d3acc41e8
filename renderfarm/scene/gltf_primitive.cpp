// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene/gltf_primitive.h"

#include <fmt/format.h>

namespace cyclorama::scene {
namespace {

constexpr const char* kPosition = "POSITION";

}  // namespace

Result<std::optional<GltfPrimitive>> GltfPrimitive::open(GltfDocument* document, GltfContext* context,
                                                         const GltfObject& primitive) {
  TRY_ASSIGN(const std::optional<std::uint64_t> declared_mode, primitive.integer("mode"));
  const std::uint64_t mode = declared_mode.value_or(static_cast<std::uint64_t>(GltfTopology::kTriangles));
  if (mode > static_cast<std::uint64_t>(GltfTopology::kFan)) {
    return primitive.damaged("mode", fmt::format("{} is no kind of primitive", mode));
  }
  const bool is_points = mode == static_cast<std::uint64_t>(GltfTopology::kPoints);
  if (mode < static_cast<std::uint64_t>(GltfTopology::kTriangles) && !is_points) {
    context->notes.add("lines have no surface: ignored", primitive.place());
    return std::optional<GltfPrimitive>();
  }
  TRY_ASSIGN(std::optional<GltfObject> attributes, primitive.object("attributes"));
  if (!attributes) return primitive.damaged("attributes", "is missing");
  TRY_ASSIGN(const std::optional<std::size_t> position, document->index(*attributes, kPosition, "accessors"));
  if (!position) {
    context->notes.add("a primitive has no positions: ignored", primitive.place());
    return std::optional<GltfPrimitive>();
  }
  TRY_ASSIGN(const GltfAccessorShape shape, read_accessor_shape(*document, *position));
  if (shape.count == 0) {
    context->notes.add("a primitive has no vertices: ignored", primitive.place());
    return std::optional<GltfPrimitive>();
  }
  GltfPrimitive opened(document, context, primitive, *std::move(attributes));
  opened.topology_ = static_cast<GltfTopology>(mode);
  opened.vertex_count_ = static_cast<std::size_t>(shape.count);
  TRY_ASSIGN(const std::optional<GltfObject> draco, primitive.extension("KHR_draco_mesh_compression"));
  if (draco) {
    TRY(opened.open_draco(*draco));
  } else {
    // The file must have data for all vertices before triangles are made of them.
    TRY(check_accessor(document, *position));
  }
  return std::optional(std::move(opened));
}

Status GltfPrimitive::open_draco(const GltfObject& extension) {
  TRY_ASSIGN(const std::size_t indices, document_->required_index(object_, "indices", "accessors"));
  TRY_ASSIGN(const GltfAccessorShape shape, read_accessor_shape(*document_, indices));
  // Draco encodes only triangles. The extension also allows strips, but then the count of the accessor does not
  // determine the number of triangles.
  if (topology_ != GltfTopology::kTriangles) {
    return object_.damaged("mode", "Draco data of strips and fans is not supported");
  }
  TRY(context_->budget.take(object_.place(), shape.count / 3, sizeof(GltfTriangles::value_type)));
  TRY_ASSIGN(draco_, GltfDracoMesh::decode(document_, extension, {shape.count / 3, vertex_count_}, &context_->budget));
  return Done{};
}

Result<GltfTriangles> GltfPrimitive::triangles() const {
  if (draco_) {
    GltfTriangles triangles = draco_->triangles();
    TRY(check_corners(triangles, vertex_count_, object_.place()));
    return triangles;
  }
  TRY_ASSIGN(const std::optional<std::size_t> index, document_->index(object_, "indices", "accessors"));
  std::optional<GltfAccessor> indices;
  if (index) {
    TRY_ASSIGN(indices, read_accessor(document_, *index, &context_->budget));
  }
  return read_triangles(indices, vertex_count_, topology_, object_.place(), context_);
}

Result<std::optional<GltfAccessor>> GltfPrimitive::attribute(const char* semantic, GltfVertexKind kind) const {
  TRY_ASSIGN(const std::optional<std::size_t> index, document_->index(attributes_, semantic, "accessors"));
  if (!index) return std::optional<GltfAccessor>();
  std::optional<GltfAccessor> accessor;
  if (draco_) {
    TRY_ASSIGN(const GltfAccessorShape shape, read_accessor_shape(*document_, *index));
    TRY_ASSIGN(accessor, draco_->attribute(semantic, shape, &context_->budget));
  }
  if (!accessor) {
    TRY_ASSIGN(accessor, read_accessor(document_, *index, &context_->budget));
  }
  if (accessor->count != vertex_count_) {
    return attributes_.damaged(semantic, fmt::format("{} elements for {} vertices", accessor->count, vertex_count_));
  }
  TRY(check_vertex_format(*accessor, kind, document_->uses("KHR_mesh_quantization")));
  return accessor;
}

}  // namespace cyclorama::scene
