// SPDX-License-Identifier: Apache-2.0
/// Content of one imported file, in the axes and units of the file.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <filesystem>
#include <numbers>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "common/image/image.h"
#include "renderfarm/scene/splat_cloud.h"

namespace cyclorama::scene {

enum class WrapMode : std::uint8_t { kRepeat, kMirror, kClamp };

/// 8-bit RGBA as stored in the file; the use of the texture decides whether RGB is sRGB-coded.
struct Texture {
  RgbaImage pixels;
  WrapMode wrap_u = WrapMode::kRepeat;
  WrapMode wrap_v = WrapMode::kRepeat;
  bool nearest = false;  ///< The nearest texel is sampled, without interpolation.
};

/// A material's use of a texture. (u, v)' = transform * (u, v, 1); v increases downwards from the first row.
struct TextureUse {
  int texture = -1;  ///< Index into Model::textures; -1 for none.
  int texcoord = 0;  ///< The mesh's texture coordinate set, 0 or 1.
  Eigen::Matrix<float, 2, 3> transform = (Eigen::Matrix<float, 2, 3>() << 1, 0, 0, 0, 1, 0).finished();
};

enum class AlphaMode : std::uint8_t { kOpaque, kMask, kBlend };

/// A metallic-roughness material of glTF 2.0; factors are linear. Source: glTF 2.0, section 3.9, and the ratified
/// extensions KHR_materials_ior, _specular, _clearcoat, _transmission, _unlit and _volume, which also give the
/// defaults.
struct Material {
  std::string name;
  Eigen::Vector4f base_colour = Eigen::Vector4f::Ones();
  TextureUse base_colour_texture;  ///< sRGB.
  float metallic = 1.0f;
  float roughness = 1.0f;
  TextureUse metallic_roughness_texture;  ///< Linear; roughness in G, metallic in B.
  TextureUse normal_texture;              ///< Linear; tangent space.
  float normal_scale = 1.0f;
  Eigen::Vector3f emissive = Eigen::Vector3f::Zero();  ///< Radiance, including the strength.
  TextureUse emissive_texture;                         ///< sRGB.
  AlphaMode alpha_mode = AlphaMode::kOpaque;
  float alpha_cutoff = 0.5f;
  bool double_sided = false;
  /// The surface shows its base colour whatever light there is, as for a photograph, which already contains light. It
  /// reflects nothing and emits its base colour as radiance, but is not a lamp.
  bool unlit = false;

  float ior = 1.5f;                                           ///< Index of refraction, from 1 to kMaxIor.
  float specular = 1.0f;                                      ///< Strength of a dielectric's specular reflection.
  Eigen::Vector3f specular_colour = Eigen::Vector3f::Ones();  ///< Tints the specular reflection at normal incidence.
  TextureUse specular_texture;                                ///< Linear, in A.
  TextureUse specular_colour_texture;                         ///< sRGB.

  float clearcoat = 0.0f;  ///< Strength of a second, colourless layer above the surface.
  float clearcoat_roughness = 0.0f;
  TextureUse clearcoat_texture;            ///< Linear, in R.
  TextureUse clearcoat_roughness_texture;  ///< Linear, in G.
  TextureUse clearcoat_normal_texture;     ///< Linear; tangent space. Without this texture, the coat is smooth.
  float clearcoat_normal_scale = 1.0f;

  float transmission = 0.0f;        ///< Share of the light that enters a dielectric and is transmitted.
  TextureUse transmission_texture;  ///< Linear, in R.
  /// Zero if the mesh is a thin sheet; if above zero, the mesh encloses a volume, and the value itself is not used.
  float thickness = 0.0f;
  Eigen::Vector3f attenuation_colour = Eigen::Vector3f::Ones();  ///< Colour of white light after attenuation_distance.
  float attenuation_distance = 0.0f;                             ///< In the scene's metres; 0 disables absorption.
};

inline constexpr float kMaxIor = 1e6f;  ///< At this value all light is reflected; glTF writes it as 0.

/// Returns pointers to all texture members of Material.
[[nodiscard]] constexpr auto texture_places() {
  return std::array{&Material::base_colour_texture,      &Material::metallic_roughness_texture,
                    &Material::normal_texture,           &Material::emissive_texture,
                    &Material::specular_texture,         &Material::specular_colour_texture,
                    &Material::clearcoat_texture,        &Material::clearcoat_roughness_texture,
                    &Material::clearcoat_normal_texture, &Material::transmission_texture};
}

/// Indexed triangles with one material. All vectors of vertex data except `positions` may be empty; otherwise they have
/// one entry per vertex.
struct Mesh {
  std::string name;
  /// Added in double to every position, so that large coordinates keep their precision.
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  std::vector<std::array<float, 3>> positions;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<std::array<float, 3>> normals;  ///< Unit length. Empty for flat shading by the triangles' normals.
  std::array<std::vector<std::array<float, 2>>, 2> texcoords;
  std::vector<std::array<float, 4>> tangents;        ///< w is the handedness, as in glTF. May be empty.
  std::vector<std::array<std::uint8_t, 4>> colours;  ///< sRGB-coded RGB, linear alpha; multiplies base_colour.
  int material = 0;                                  ///< Index into Model::materials.
};

/// A mesh placed in the model: p_model = T_model_mesh * (origin + position).
struct Instance {
  int mesh = 0;
  Eigen::Affine3d T_model_mesh = Eigen::Affine3d::Identity();
};

/// Shape of a light. A sphere is a point light with a radius.
enum class LightKind : std::uint8_t { kPoint, kSpot, kDirectional, kRectangle, kDisk };

/// KHR_lights_punctual with a size for soft shadows, and area lights. A rectangle or disk has its centre at `position`
/// and emits the same radiance from every point in every direction on the side of `direction`; its back is black.
struct Light {
  std::string name;
  LightKind kind = LightKind::kPoint;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  /// Main direction of emission; unit length. Unused for point lights.
  Eigen::Vector3d direction = -Eigen::Vector3d::UnitY();
  /// Direction of a rectangle's width; unit length, not parallel to `direction`.
  Eigen::Vector3d across = Eigen::Vector3d::UnitX();
  /// Linear colour times candela (point, spot), lux (directional) or nits (rectangle, disk); nits are the unit of
  /// radiance.
  Eigen::Vector3f intensity = Eigen::Vector3f::Ones();
  Eigen::Vector2d size_m = Eigen::Vector2d::Zero();  ///< Rectangle: width and height.
  /// Radius of the sphere or disk; for directional lights, tangent of the angular radius.
  double radius_m = 0.0;
  double range_m = 0.0;         ///< Distance at which the light has faded to zero; 0 for no limit.
  double inner_cone_rad = 0.0;  ///< Spot: full intensity inside the inner cone, none outside the outer cone.
  double outer_cone_rad = 0.7853981633974483;
  /// True if rays hit the light: the eye and mirrors see it, and it casts shadows. Never true for directional lights or
  /// radius 0.
  bool visible = false;
  std::size_t group = 0;  ///< Below kMaxLampGroups; see lamp_groups.h.
};

/// Returns true for a rectangle or a disk.
[[nodiscard]] inline bool is_flat(LightKind kind) { return kind == LightKind::kRectangle || kind == LightKind::kDisk; }
/// Returns the area of a rectangle or disk in square metres; 0 for other lights.
[[nodiscard]] inline double area_of(const Light& light) {
  if (light.kind == LightKind::kRectangle) return light.size_m.prod();
  return light.kind == LightKind::kDisk ? std::numbers::pi * light.radius_m * light.radius_m : 0.0;
}

/// A camera in the file; scenes offer cameras as tour stops.
struct Viewpoint {
  std::string name;
  Eigen::Vector3d eye = Eigen::Vector3d::Zero();
  Eigen::Vector3d direction = -Eigen::Vector3d::UnitZ();  ///< Viewing direction; unit length.
};

/// A value. Invariants, kept by every importer: all indices are inside their vectors, all numbers are finite, and there
/// is at least one material.
struct Model {
  std::vector<Texture> textures;
  std::vector<Material> materials;
  std::vector<Mesh> meshes;
  std::vector<Instance> instances;
  std::vector<SplatCloud> splats;
  std::vector<Light> lights;
  std::vector<Viewpoint> viewpoints;
  std::string credits;  ///< Verbatim from the file; licences often require that visitors can read them.
  /// Features of the file that were not used, one sentence each: "KHR_materials_sheen is not supported: ignored".
  std::vector<std::string> notes;
};

/// Limits of one import; a file that exceeds them is refused before memory is allocated.
struct ImportLimits {
  std::size_t memory_bytes = std::size_t{16} << 30;
  std::size_t texture_px = std::size_t{16384} * 16384;  ///< Pixels of one texture.
};

// Importers. Reentrant. Triangles whose corners are not finite are dropped and counted in a note. Errors: kNotFound,
// kSystem if the file cannot be read, or kBadData, with file, place and remedy in one sentence.

/// glTF 2.0, text or binary.
Result<Model> import_gltf(const std::filesystem::path& path, const ImportLimits& limits);
/// PLY, ASCII or binary of either byte order.
Result<Model> import_ply(const std::filesystem::path& path, const ImportLimits& limits);
/// LAS 1.0 to 1.4 without compression. The file's z axis points up; the model is rotated so that y points up.
Result<Model> import_las(const std::filesystem::path& path, const ImportLimits& limits);
/// E57: all scans of the file, in the file's frame, rotated as in import_las().
Result<Model> import_e57(const std::filesystem::path& path, const ImportLimits& limits);
/// SPZ: Gaussian splats. PLY files may contain splats as well.
Result<Model> import_spz(const std::filesystem::path& path, const ImportLimits& limits);
/// Wavefront OBJ with its MTL files.
Result<Model> import_obj(const std::filesystem::path& path, const ImportLimits& limits);

}  // namespace cyclorama::scene
