// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene/gltf_mesh.h"

#include <utility>

#include "renderfarm/scene/gltf_primitive.h"
#include "renderfarm/scene/gltf_triangles.h"
#include "renderfarm/scene/gltf_vertices.h"

namespace cyclorama::scene {
namespace {

constexpr std::array<const char*, 2> kTexcoords = {"TEXCOORD_0", "TEXCOORD_1"};

/// Texture coordinate sets that the material samples; the others would only take memory.
std::array<bool, 2> sampled_texcoords(const Material& material) {
  std::array<bool, 2> sampled = {false, false};
  for (TextureUse Material::*const at : texture_places()) {
    const TextureUse& use = material.*at;
    if (use.texture >= 0) sampled[static_cast<std::size_t>(use.texcoord)] = true;
  }
  return sampled;
}

Status read_vertices(const GltfPrimitive& primitive, const GltfSelection& selection, const Material& material,
                     GltfContext* context, Mesh* mesh) {
  TRY_ASSIGN(const std::optional<GltfAccessor> positions, primitive.attribute("POSITION", GltfVertexKind::kPosition));
  TRY(read_positions(*positions, selection, context, mesh));
  TRY_ASSIGN(const std::optional<GltfAccessor> normals, primitive.attribute("NORMAL", GltfVertexKind::kNormal));
  if (normals) TRY(read_normals(*normals, selection, context, mesh));
  const bool normal_mapped = material.normal_texture.texture >= 0 || material.clearcoat_normal_texture.texture >= 0;
  if (normals && normal_mapped) {  // glTF: tangents without normals are ignored.
    TRY_ASSIGN(const std::optional<GltfAccessor> tangents, primitive.attribute("TANGENT", GltfVertexKind::kTangent));
    if (tangents) TRY(read_tangents(*tangents, selection, context, mesh));
  }
  const std::array<bool, 2> sampled = sampled_texcoords(material);
  for (int set = 0; set < 2; ++set) {
    if (!sampled[static_cast<std::size_t>(set)]) continue;
    TRY_ASSIGN(const std::optional<GltfAccessor> texcoords,
               primitive.attribute(kTexcoords[static_cast<std::size_t>(set)], GltfVertexKind::kTexcoord));
    TRY(read_texcoords(*texcoords, selection, set, context, mesh));
  }
  TRY_ASSIGN(const std::optional<GltfAccessor> colours, primitive.attribute("COLOR_0", GltfVertexKind::kColour));
  if (colours) TRY(read_colours(*colours, selection, context, mesh));
  return Done{};
}

}  // namespace

Result<const std::vector<int>*> GltfMeshes::load(std::size_t index) {
  const auto known = loaded_.find(index);
  if (known != loaded_.end()) return &known->second;
  TRY_ASSIGN(const GltfObject object, document_->item("meshes", index));
  TRY_ASSIGN(const GltfArray primitives, object.array("primitives"));
  if (!object.has("primitives")) return object.damaged("primitives", "is missing");
  std::vector<int> meshes;
  for (std::size_t i = 0; i < primitives.size(); ++i) {
    TRY_ASSIGN(const GltfObject primitive, primitives.object(i));
    TRY_ASSIGN(std::optional<Mesh> mesh, read_primitive(primitive));
    if (!mesh) continue;
    mesh->name = object.name();
    meshes.push_back(static_cast<int>(model_->meshes.size()));
    model_->meshes.push_back(*std::move(mesh));
  }
  return &loaded_.emplace(index, std::move(meshes)).first->second;
}

Result<std::optional<Mesh>> GltfMeshes::read_primitive(const GltfObject& object) {
  TRY_ASSIGN(const std::optional<GltfPrimitive> primitive, GltfPrimitive::open(document_, context_, object));
  if (!primitive) return std::optional<Mesh>();
  if (object.has("targets")) {
    context_->notes.add("morph targets are not supported: the base shape is shown", object.place());
  }
  TRY_ASSIGN(const std::optional<std::size_t> material, document_->index(object, "material", "materials"));
  Mesh mesh;
  TRY_ASSIGN(mesh.material,
             materials_.load(material, {primitive->has(kTexcoords[0]), primitive->has(kTexcoords[1])}, object.place()));
  TRY(context_->budget.take(object.place(), 1, sizeof mesh));
  TRY_ASSIGN(mesh.triangles, primitive->triangles());
  if (mesh.triangles.empty()) {
    context_->notes.add("a primitive has no triangles: ignored", object.place());
    return std::optional<Mesh>();
  }
  const GltfSelection selection = select_vertices(&mesh.triangles, primitive->vertex_count());
  const Material& loaded = model_->materials[static_cast<std::size_t>(mesh.material)];
  TRY(read_vertices(*primitive, selection, loaded, context_, &mesh));
  return std::optional(std::move(mesh));
}

}  // namespace cyclorama::scene
