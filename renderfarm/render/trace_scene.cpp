// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/render/trace_scene.h"

#include "renderfarm/render/bsdf/bsdf.h"
#include "renderfarm/render/pane.h"
#include "renderfarm/render/requirements.h"

namespace cyclorama::render {
namespace {

template <typename T>
const T* data_or_null(const std::vector<T>& values) {
  return values.empty() ? nullptr : values.data();
}

}  // namespace

SurfaceMaterial trace_material(const scene::Model& model, const scene::Material& source, MipTextures* textures) {
  const bool sees_through = source.alpha_mode != scene::AlphaMode::kOpaque;
  const TextureContent base = sees_through ? TextureContent::kColourWithAlpha : TextureContent::kColour;
  SurfaceMaterial material;
  material.source = &source;
  material.base_colour = textures->request(model, source.base_colour_texture, base);
  material.metallic_roughness = textures->request(model, source.metallic_roughness_texture, TextureContent::kData);
  material.normal = textures->request(model, source.normal_texture, TextureContent::kData);
  material.emissive = textures->request(model, source.emissive_texture, TextureContent::kColour);
  material.specular = textures->request(model, source.specular_texture, TextureContent::kData);
  material.specular_colour = textures->request(model, source.specular_colour_texture, TextureContent::kColour);
  material.clearcoat = textures->request(model, source.clearcoat_texture, TextureContent::kData);
  material.clearcoat_roughness = textures->request(model, source.clearcoat_roughness_texture, TextureContent::kData);
  material.clearcoat_normal = textures->request(model, source.clearcoat_normal_texture, TextureContent::kData);
  material.transmission = textures->request(model, source.transmission_texture, TextureContent::kData);
  material.absorption = absorption_of(source);
  material.level = surface_level_of(source, model.textures);
  material.pane = is_pane(source, material.level);
  material.cut_out = source.alpha_mode == scene::AlphaMode::kMask;
  material.plain = material.level == SurfaceLevel::kMatte && material.normal == nullptr && !source.unlit &&
                   source.emissive.isZero(0.0f);
  return material;
}

SurfaceMesh trace_mesh(const scene::Mesh& mesh) {
  SurfaceMesh traced;
  traced.positions = mesh.positions.data();
  traced.triangles = mesh.triangles.data();
  traced.triangle_count = mesh.triangles.size();
  traced.vertex_count = mesh.positions.size();
  traced.normals = data_or_null(mesh.normals);
  traced.texcoords = {data_or_null(mesh.texcoords[0]), data_or_null(mesh.texcoords[1])};
  traced.tangents = data_or_null(mesh.tangents);
  traced.colours = data_or_null(mesh.colours);
  return traced;
}

Placement place(const SurfaceMesh& mesh, const Eigen::Affine3d& T_render_mesh) {
  Placement placement;
  placement.mesh = &mesh;
  placement.baked = false;
  placement.linear = T_render_mesh.linear().cast<float>();
  placement.translation = T_render_mesh.translation().cast<float>();
  placement.normal_matrix = normal_matrix_of(T_render_mesh.linear());
  return placement;
}

}  // namespace cyclorama::render
