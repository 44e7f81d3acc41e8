// SPDX-License-Identifier: Apache-2.0
/// Data that the ray kernels read: the scene's arrays as they are in memory, their placements in the render frame, and
/// the BVH.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "renderfarm/light/light_store.h"
#include "renderfarm/render/embree.h"
#include "renderfarm/render/lights/light_geometry.h"
#include "renderfarm/render/lights/light_set.h"
#include "renderfarm/render/mip_texture.h"
#include "renderfarm/render/surface_level.h"
#include "renderfarm/render/triangle_record.h"
#include "renderfarm/render/vectors.h"
#include "renderfarm/scene/scene.h"

namespace cyclorama::render {

class SplatScene;

/// A material with its resolved textures.
struct SurfaceMaterial {
  const scene::Material* source = nullptr;
  const MipTexture* base_colour = nullptr;  ///< Null if there is none, as for all textures here.
  const MipTexture* metallic_roughness = nullptr;
  const MipTexture* normal = nullptr;
  const MipTexture* emissive = nullptr;
  const MipTexture* specular = nullptr;
  const MipTexture* specular_colour = nullptr;
  const MipTexture* clearcoat = nullptr;
  const MipTexture* clearcoat_roughness = nullptr;
  const MipTexture* clearcoat_normal = nullptr;
  const MipTexture* transmission = nullptr;
  Vec3 absorption = Vec3::Zero();  ///< Per metre, in a body of glass.
  SurfaceLevel level = SurfaceLevel::kMatte;
  bool blends = false;   ///< Some of the material is transparent.
  bool cut_out = false;  ///< The material has holes.
  /// The material shows only its colour times the light that arrives: it is matte, without emission or a normal map.
  bool plain = false;
  bool pane = false;  ///< Shadow rays cross the material: see pane.h.
};

/// Borrows the arrays of one Mesh. A pointer is null where the mesh has no such array.
struct SurfaceMesh {
  const std::array<float, 3>* positions = nullptr;
  const std::array<std::uint32_t, 3>* triangles = nullptr;
  std::size_t triangle_count = 0;
  std::size_t vertex_count = 0;
  const std::array<float, 3>* normals = nullptr;
  std::array<const std::array<float, 2>*, 2> texcoords = {nullptr, nullptr};
  const std::array<float, 4>* tangents = nullptr;
  const std::array<std::uint8_t, 4>* colours = nullptr;
  const SurfaceMaterial* material = nullptr;
  /// One per triangle, in the frame of `positions`; created after baking. Empty unless the scene's MemoryMode is kFast:
  /// each hit then reads the arrays above.
  std::vector<TriangleRecord> records;

  /// Fetches what the next hit of a triangle reads first. Inlining is forced because gcc would treat a function that
  /// only prefetches as free of effects and drop the calls.
  [[gnu::always_inline]] inline void prefetch(std::uint32_t triangle) const {
    if (!records.empty()) __builtin_prefetch(&records[triangle]);
    __builtin_prefetch(&triangles[triangle]);
  }
  /// Fetches the vertices of a triangle for which prefetch() was called a while ago.
  [[gnu::always_inline]] inline void prefetch_vertices(std::uint32_t triangle) const {
    if (!records.empty() && texcoords[0] == nullptr && texcoords[1] == nullptr) return;
    for (const std::uint32_t corner : triangles[triangle]) {
      for (const std::array<float, 2>* const uv : texcoords) {
        if (uv != nullptr) __builtin_prefetch(&uv[corner]);
      }
      if (!records.empty()) continue;
      __builtin_prefetch(&positions[corner]);
      if (normals != nullptr) __builtin_prefetch(&normals[corner]);
      if (colours != nullptr) __builtin_prefetch(&colours[corner]);
    }
  }
};

/// A mesh in the render frame. Top-level geometry i of the BVH is placement i; lamps follow.
struct Placement {
  const SurfaceMesh* mesh = nullptr;
  bool baked = true;  ///< True if positions are in the render frame already and the matrices are the identity.
  Eigen::Matrix3f linear = Eigen::Matrix3f::Identity();
  Vec3 translation = Vec3::Zero();
  Eigen::Matrix3f normal_matrix = Eigen::Matrix3f::Identity();
};

/// Owned by the Renderer. Read-only while rays are traced.
struct TraceScene {
  RTCScene top = nullptr;
  RTCScene panes = nullptr;            ///< The panes of `top`, with the same geometry ids; null if there are none.
  const SplatScene* splats = nullptr;  ///< Null if there are no splats.
  MipTextures textures;
  std::vector<SurfaceMaterial> materials;
  std::vector<SurfaceMesh> meshes;
  std::vector<Placement> placements;
  LightSet lights;
  LampGeometries lamps;  ///< Lights that rays can hit.
  Vec3 ambient = Vec3::Zero();
  Vec3 eye_lamp = Vec3::Zero();
  const light::LightStore* light = nullptr;  ///< Stored light of views that have none of their own; null if none.
};

/// Returns `source` with its textures requested; they exist once `textures` is built. Borrows all three arguments.
[[nodiscard]] SurfaceMaterial trace_material(const scene::Model& model, const scene::Material& source,
                                             MipTextures* textures);
/// Returns the mesh without its material. Borrows the arrays of `mesh`.
[[nodiscard]] SurfaceMesh trace_mesh(const scene::Mesh& mesh);
/// Returns an instance of a mesh that is not baked.
[[nodiscard]] Placement place(const SurfaceMesh& mesh, const Eigen::Affine3d& T_render_mesh);

}  // namespace cyclorama::render
