// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/light/scene_key.h"

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <iterator>
#include <memory>
#include <type_traits>

namespace cyclorama::light {
namespace {

/// Version of the hash; to be increased whenever light stored by earlier programs must not be used.
constexpr std::uint32_t kKeyVersion = 3;

class Hash {
 public:
  Hash() : state_(XXH3_createState(), &XXH3_freeState) { XXH3_128bits_reset(state_.get()); }

  template <typename Value>
  requires(std::is_arithmetic_v<Value> || std::is_enum_v<Value>) void add(const Value& value) {
    XXH3_128bits_update(state_.get(), &value, sizeof(value));
  }
  template <typename Value, int kRows, int kColumns>
  void add(const Eigen::Matrix<Value, kRows, kColumns>& matrix) {
    XXH3_128bits_update(state_.get(), matrix.data(), sizeof(matrix));
  }
  /// Adds a range of numbers or of arrays of numbers. Precondition: elements have no padding.
  template <typename Range>
  void add_all(const Range& range) {
    add(std::size(range));
    XXH3_128bits_update(state_.get(), std::data(range), std::size(range) * sizeof(*std::data(range)));
  }
  [[nodiscard]] SceneKey key() const {
    const XXH128_hash_t hash = XXH3_128bits_digest(state_.get());
    return {hash.low64, hash.high64};
  }

 private:
  std::unique_ptr<XXH3_state_t, decltype(&XXH3_freeState)> state_;
};

void add(const scene::TextureUse& use, Hash* hash) {
  hash->add(use.texture);
  hash->add(use.texcoord);
  hash->add(use.transform);
}

void add(const scene::Material& material, Hash* hash) {
  for (scene::TextureUse scene::Material::*const place : scene::texture_places()) add(material.*place, hash);
  hash->add(material.base_colour);
  hash->add(material.emissive);
  hash->add(material.specular_colour);
  hash->add(material.attenuation_colour);
  for (const float value :
       {material.metallic, material.roughness, material.normal_scale, material.alpha_cutoff, material.ior,
        material.specular, material.clearcoat, material.clearcoat_roughness, material.clearcoat_normal_scale,
        material.transmission, material.thickness, material.attenuation_distance}) {
    hash->add(value);
  }
  hash->add(material.alpha_mode);
  hash->add(material.double_sided);
  // Added only if set, so that scenes without unlit materials keep their earlier keys.
  if (material.unlit) hash->add(material.unlit);
}

void add(const scene::Mesh& mesh, Hash* hash) {
  hash->add(mesh.origin);
  hash->add_all(mesh.positions);
  hash->add_all(mesh.triangles);
  hash->add_all(mesh.normals);
  for (const auto& texcoords : mesh.texcoords) hash->add_all(texcoords);
  hash->add_all(mesh.tangents);
  hash->add_all(mesh.colours);
  hash->add(mesh.material);
}

void add(const scene::Light& light, Hash* hash) {
  hash->add(light.kind);
  hash->add(light.position);
  hash->add(light.direction);
  hash->add(light.across);
  hash->add(light.intensity);
  hash->add(light.size_m);
  for (const double value : {light.radius_m, light.range_m, light.inner_cone_rad, light.outer_cone_rad}) {
    hash->add(value);
  }
  hash->add(light.visible);
  hash->add(light.group);
}

}  // namespace

SceneKey key_of(const scene::Scene& scene) {
  Hash hash;
  hash.add(kKeyVersion);
  const scene::Model& model = scene.model;
  for (const scene::Texture& texture : model.textures) {
    hash.add(texture.pixels.width());
    hash.add_all(texture.pixels.data());
    hash.add(texture.wrap_u);
    hash.add(texture.wrap_v);
    hash.add(texture.nearest);
  }
  for (const scene::Material& material : model.materials) add(material, &hash);
  for (const scene::Mesh& mesh : model.meshes) add(mesh, &hash);
  for (const scene::SplatCloud& cloud : model.splats) {  // Scenes without splats keep their earlier keys.
    hash.add(cloud.origin);
    hash.add_all(cloud.positions);
    hash.add_all(cloud.scales);
    hash.add_all(cloud.opacities);
    hash.add_all(cloud.coefficients);
  }
  for (const scene::Instance& instance : model.instances) {
    hash.add(instance.mesh);
    hash.add(instance.T_model_mesh.matrix());
  }
  for (const scene::Light& light : model.lights) add(light, &hash);
  for (const Eigen::Vector3f& colour : {scene.sky.zenith, scene.sky.horizon, scene.sky.ground, scene.ambient}) {
    hash.add(colour);
  }
  if (scene.environment != nullptr) {
    hash.add(scene.environment->pixels.width());
    hash.add_all(scene.environment->pixels.data());
    hash.add(scene.environment->rotation_rad);
    hash.add(scene.environment->strength);
  }
  hash.add(scene.bounces);
  return hash.key();
}

}  // namespace cyclorama::light
