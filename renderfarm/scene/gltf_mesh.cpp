// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene/gltf_mesh.h"

#include <fmt/format.h>

#include <utility>

#include "renderfarm/scene/gltf_morph.h"
#include "renderfarm/scene/gltf_primitive.h"
#include "renderfarm/scene/gltf_splats.h"
#include "renderfarm/scene/gltf_triangles.h"
#include "renderfarm/scene/gltf_vertices.h"
#include "renderfarm/scene/point_squares.h"

namespace cyclorama::scene {
namespace {

constexpr std::array<const char*, 2> kTexcoords = {"TEXCOORD_0", "TEXCOORD_1"};

/// Returns, for each set of texture coordinates, true if the material samples it; other sets would only take memory.
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
  if (normals && normal_mapped) {  // In glTF, tangents without normals are ignored.
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

/// Reads points as small squares; nothing, with a note, if some are not finite.
Result<std::optional<Mesh>> read_points(const GltfPrimitive& primitive, const std::string& place, int material,
                                        GltfContext* context) {
  const GltfSelection all = GltfSelection::all(primitive.vertex_count());
  TRY(context->budget.take(place, primitive.vertex_count(), kSquareBytes));
  TRY_ASSIGN(const std::optional<GltfAccessor> positions, primitive.attribute("POSITION", GltfVertexKind::kPosition));
  if (!are_positions_usable(*positions, all)) {
    context->notes.add("some points are not finite: the points are ignored", place);
    return std::optional<Mesh>();
  }
  Mesh mesh;
  mesh.material = material;
  TRY(read_positions(*positions, all, context, &mesh));
  TRY_ASSIGN(const std::optional<GltfAccessor> colours, primitive.attribute("COLOR_0", GltfVertexKind::kColour));
  if (colours) TRY(read_colours(*colours, all, context, &mesh));
  const double step = make_point_squares(&mesh);
  context->notes.add(fmt::format("points, about {:.3g} units apart, are shown as small squares", step), place);
  return std::optional(std::move(mesh));
}

}  // namespace

Result<const std::vector<int>*> GltfMeshes::load(std::size_t index) {
  const auto known = loaded_.find(index);
  if (known != loaded_.end()) return &known->second;
  TRY_ASSIGN(const GltfObject object, document_->item("meshes", index));
  TRY_ASSIGN(const GltfArray primitives, object.array("primitives"));
  if (!object.has("primitives")) return object.damaged("primitives", "is missing");
  TRY_ASSIGN(const std::vector<double> morph_weights, read_morph_weights(object));
  std::vector<int> meshes;
  for (std::size_t i = 0; i < primitives.size(); ++i) {
    TRY_ASSIGN(const GltfObject primitive, primitives.object(i));
    TRY_ASSIGN(const bool is_splats, is_gltf_splats(primitive));
    if (is_splats) continue;  // add_gltf_splats() reads splats.
    std::optional<GltfSkinning> skinning;
    TRY_ASSIGN(std::optional<Mesh> mesh, read_primitive(primitive, morph_weights, &skinning));
    if (!mesh) continue;
    mesh->name = object.name();
    meshes.push_back(static_cast<int>(model_->meshes.size()));
    if (skinning) skinnings_.emplace(meshes.back(), *std::move(skinning));
    model_->meshes.push_back(*std::move(mesh));
  }
  return &loaded_.emplace(index, std::move(meshes)).first->second;
}

Result<std::vector<int>> GltfMeshes::load_posed(std::size_t index, const std::vector<Eigen::Affine3d>& pose,
                                                const std::string& place) {
  TRY_ASSIGN(const std::vector<int>* const stored, load(index));
  std::vector<int> posed;
  for (const int mesh : *stored) {
    const auto skinning = skinnings_.find(mesh);
    if (skinning == skinnings_.end()) {
      context_->notes.add("a mesh with a skin has no joints: shown as stored", place);
      posed.push_back(mesh);
      continue;
    }
    const Mesh& original = model_->meshes[static_cast<std::size_t>(mesh)];
    const std::size_t vertices = original.positions.size();
    TRY(context_->budget.take(place, vertices, 60));
    TRY(context_->budget.take(place, original.triangles.size(), sizeof original.triangles[0]));
    Mesh moved = original;
    TRY(apply_pose(skinning->second, pose, place, &moved));
    posed.push_back(static_cast<int>(model_->meshes.size()));
    model_->meshes.push_back(std::move(moved));
  }
  return posed;
}

Result<std::optional<Mesh>> GltfMeshes::read_primitive(const GltfObject& object,
                                                       const std::vector<double>& morph_weights,
                                                       std::optional<GltfSkinning>* ret_skinning) {
  TRY_ASSIGN(const std::optional<GltfPrimitive> primitive, GltfPrimitive::open(document_, context_, object));
  if (!primitive) return std::optional<Mesh>();
  TRY_ASSIGN(const std::optional<std::size_t> material, document_->index(object, "material", "materials"));
  if (primitive->is_points()) {
    TRY_ASSIGN(const int plain, materials_.load(material, {false, false}, object.place()));
    return read_points(*primitive, object.place(), plain, context_);
  }
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
  TRY(apply_morphs(document_, object, morph_weights, primitive->vertex_count(), selection, context_, &mesh));
  if (!document_->root().has("skins")) return std::optional(std::move(mesh));
  TRY_ASSIGN(const std::optional<GltfAccessor> joints, primitive->attribute("JOINTS_0", GltfVertexKind::kJoints));
  TRY_ASSIGN(const std::optional<GltfAccessor> weights, primitive->attribute("WEIGHTS_0", GltfVertexKind::kWeights));
  if (joints && weights) {
    TRY_ASSIGN(*ret_skinning, read_skinning(*joints, *weights, selection, &context_->budget));
  }
  return std::optional(std::move(mesh));
}

}  // namespace cyclorama::scene
