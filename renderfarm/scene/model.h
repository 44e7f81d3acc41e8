// SPDX-License-Identifier: Apache-2.0
/// What an importer reads from one file, in that file's own axes and units.
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

namespace cyclorama {

enum class WrapMode : std::uint8_t { kRepeat, kMirror, kClamp };

/// 8-bit RGBA as stored in the file; whether RGB is sRGB-coded follows from what it is used for.
struct Texture {
  RgbaImage pixels;
  WrapMode wrap_u = WrapMode::kRepeat;
  WrapMode wrap_v = WrapMode::kRepeat;
  bool nearest = false;  ///< Sample the nearest texel instead of interpolating.
};

/// A texture as a material uses it. (u, v)' = transform * (u, v, 1); v counts down from the first row.
struct TextureUse {
  int texture = -1;  ///< Index into Model::textures; -1 is none.
  int texcoord = 0;  ///< Which of the mesh's sets, 0 or 1.
  Eigen::Matrix<float, 2, 3> transform = (Eigen::Matrix<float, 2, 3>() << 1, 0, 0, 0, 1, 0).finished();
};

enum class AlphaMode : std::uint8_t { kOpaque, kMask, kBlend };

/// glTF 2.0's metallic-roughness material; factors are linear. Source: glTF 2.0, section 3.9, and the ratified
/// extensions KHR_materials_ior, _specular, _clearcoat, _transmission and _volume, whose defaults these are.
struct Material {
  std::string name;
  Eigen::Vector4f base_colour = Eigen::Vector4f::Ones();
  TextureUse base_colour_texture;  ///< sRGB.
  float metallic = 1.0f;
  float roughness = 1.0f;
  TextureUse metallic_roughness_texture;  ///< Linear; roughness in G, metallic in B.
  TextureUse normal_texture;              ///< Linear; tangent space.
  float normal_scale = 1.0f;
  Eigen::Vector3f emissive = Eigen::Vector3f::Zero();  ///< Radiance; strength included.
  TextureUse emissive_texture;                         ///< sRGB.
  AlphaMode alpha_mode = AlphaMode::kOpaque;
  float alpha_cutoff = 0.5f;
  bool double_sided = false;

  float ior = 1.5f;                                           ///< Index of refraction, from 1 to kLargestIor.
  float specular = 1.0f;                                      ///< Strength of what a dielectric mirrors.
  Eigen::Vector3f specular_colour = Eigen::Vector3f::Ones();  ///< Tints that where one looks straight down.
  TextureUse specular_texture;                                ///< Linear, in A.
  TextureUse specular_colour_texture;                         ///< sRGB.

  float clearcoat = 0.0f;  ///< How much of the surface has a second, colourless one above it.
  float clearcoat_roughness = 0.0f;
  TextureUse clearcoat_texture;            ///< Linear, in R.
  TextureUse clearcoat_roughness_texture;  ///< Linear, in G.
  TextureUse clearcoat_normal_texture;     ///< Linear; tangent space. Without one the coat is smooth.
  float clearcoat_normal_scale = 1.0f;

  float transmission = 0.0f;        ///< The part of the light under a dielectric's surface that goes through.
  TextureUse transmission_texture;  ///< Linear, in R.
  /// 0: the mesh is a thin sheet. Above: it encloses a body. How thick that is, the mesh itself says.
  float thickness = 0.0f;
  Eigen::Vector3f attenuation_colour = Eigen::Vector3f::Ones();  ///< What is left of white after attenuation_distance.
  float attenuation_distance = 0.0f;                             ///< In the scene's metres. 0: nothing is absorbed.
};

inline constexpr float kLargestIor = 1e6f;  ///< Mirrors all; glTF writes 0.

/// Every place where a Material has a texture.
[[nodiscard]] constexpr auto texture_places() {
  return std::array{&Material::base_colour_texture,      &Material::metallic_roughness_texture,
                    &Material::normal_texture,           &Material::emissive_texture,
                    &Material::specular_texture,         &Material::specular_colour_texture,
                    &Material::clearcoat_texture,        &Material::clearcoat_roughness_texture,
                    &Material::clearcoat_normal_texture, &Material::transmission_texture};
}

/// Indexed triangles with one material. All vectors but positions may be empty; else they have one entry per vertex.
struct Mesh {
  std::string name;
  /// Added in double to every position: files with large coordinates keep their precision.
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  std::vector<std::array<float, 3>> positions;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<std::array<float, 3>> normals;  ///< Unit length. Empty: flat, from the triangle.
  std::array<std::vector<std::array<float, 2>>, 2> texcoords;
  std::vector<std::array<float, 4>> tangents;        ///< As glTF: w is the handedness. May be empty.
  std::vector<std::array<std::uint8_t, 4>> colours;  ///< sRGB-coded RGB, linear alpha; multiplies base_colour.
  int material = 0;                                  ///< Index into Model::materials.
};

/// A mesh placed in the model: p_model = T_model_mesh * (origin + position).
struct Instance {
  int mesh = 0;
  Eigen::Affine3d T_model_mesh = Eigen::Affine3d::Identity();
};

/// A sphere is a point light with a radius.
enum class LightKind : std::uint8_t { kPoint, kSpot, kDirectional, kRectangle, kDisk };

/// KHR_lights_punctual with a size for soft shadows, and flat lights. A rectangle or disk has its middle at `position`
/// and shines alike from every place, in every direction on the side to which `direction` points; its back is black.
struct Light {
  std::string name;
  LightKind kind = LightKind::kPoint;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  Eigen::Vector3d direction = -Eigen::Vector3d::UnitY();  ///< Where it shines; unit length. All but points.
  Eigen::Vector3d across = Eigen::Vector3d::UnitX();      ///< Rectangle: along its width; unit length, not `direction`.
  /// Linear colour times candela (point, spot), lux (directional), or nits: the radiance (rectangle, disk).
  Eigen::Vector3f intensity = Eigen::Vector3f::Ones();
  Eigen::Vector2d size_m = Eigen::Vector2d::Zero();  ///< Rectangle: width and height.
  /// Of the shining sphere or disk; for directional lights, tangent of its angular radius.
  double radius_m = 0.0;
  double range_m = 0.0;         ///< Fades to nothing there; 0 is without end.
  double inner_cone_rad = 0.0;  ///< Spot: full intensity inside, none outside the outer cone.
  double outer_cone_rad = 0.7853981633974483;
  /// Whether rays meet it: the eye and mirrors see it, and it casts shadows. Not directional, nor of radius 0.
  bool visible = false;
};

/// Rectangle and disk.
[[nodiscard]] inline bool is_flat(LightKind kind) { return kind == LightKind::kRectangle || kind == LightKind::kDisk; }
/// Square metres of a rectangle or disk; 0 for others.
[[nodiscard]] inline double area_of(const Light& light) {
  if (light.kind == LightKind::kRectangle) return light.size_m.prod();
  return light.kind == LightKind::kDisk ? std::numbers::pi * light.radius_m * light.radius_m : 0.0;
}

/// A camera that the file placed; scenes offer them as tour stops.
struct Viewpoint {
  std::string name;
  Eigen::Vector3d eye = Eigen::Vector3d::Zero();
  Eigen::Vector3d direction = -Eigen::Vector3d::UnitZ();  ///< Where it looks; unit length.
};

/// A value. Invariants, kept by every importer: all indices are inside their vectors, all numbers are finite, there is
/// at least one material.
struct Model {
  std::vector<Texture> textures;
  std::vector<Material> materials;
  std::vector<Mesh> meshes;
  std::vector<Instance> instances;
  std::vector<Light> lights;
  std::vector<Viewpoint> viewpoints;
  std::string credits;  ///< As the file states them; licences often ask that visitors can read them.
  /// What the file asked for and did not get, one sentence each: "KHR_materials_sheen is not supported: ignored".
  std::vector<std::string> notes;
};

/// What one import may cost; a file that asks for more is refused before memory is taken.
struct ImportLimits {
  std::size_t memory_bytes = std::size_t{16} << 30;
  std::size_t texture_px = std::size_t{16384} * 16384;  ///< Of one texture.
};

// Importers. Each returns kNotFound, kSystem (the file cannot be read) or kBadData: one sentence with file, place and
// remedy. Reentrant. Triangles whose corners are not finite are dropped and counted in a note.

/// glTF 2.0, text or binary.
Result<Model> import_gltf(const std::filesystem::path& path, const ImportLimits& limits);
/// PLY, ASCII or binary of either byte order.
Result<Model> import_ply(const std::filesystem::path& path, const ImportLimits& limits);
/// Wavefront OBJ with its MTL files.
Result<Model> import_obj(const std::filesystem::path& path, const ImportLimits& limits);

}  // namespace cyclorama
