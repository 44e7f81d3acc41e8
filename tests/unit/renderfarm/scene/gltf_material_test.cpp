// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene/gltf_material.h"

#include <gmock/gmock.h>

#include <cmath>

#include "common/image/png.h"
#include "tests/unit/renderfarm/scene/gltf_builder.h"

namespace cyclorama::scene {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// One triangle with texture coordinates and a material; texture 0 is a picture of 2 x 1 pixels.
struct Painted : GltfBuilder {
  Painted() : GltfBuilder(one_triangle()) {
    RgbImage picture(2, 1);
    picture.at(0, 0)[0] = 255;
    picture.at(1, 0)[2] = 255;
    const int view = add_view(*encode_png(picture));
    json["images"] = {{{"bufferView", view}, {"mimeType", "image/png"}, {"name", "stripes"}}};
    json["textures"] = {{{"source", 0}}};
    json["materials"] = {nlohmann::json::object()};
    primitive()["material"] = 0;
    primitive()["attributes"]["TEXCOORD_0"] = add_floats({0, 0, 1, 0, 0, 1}, "VEC2");
  }
  nlohmann::json& primitive() { return json["meshes"][0]["primitives"][0]; }
  nlohmann::json& material() { return json["materials"][0]; }
  nlohmann::json& base_texture() { return material()["pbrMetallicRoughness"]["baseColorTexture"]; }
};

nlohmann::json& base_colour_of(Painted& file) { return file.material()["pbrMetallicRoughness"]["baseColorFactor"]; }

Model import_good(const GltfBuilder& file) {
  Result<Model> model = file.import();
  EXPECT_TRUE(model.has_value()) << error_of(model);
  if (model) return *std::move(model);
  Model empty;
  empty.materials.emplace_back();
  empty.meshes.emplace_back();
  return empty;
}

TEST(GltfMaterial, an_empty_material_is_the_specifications_default) {
  const Model model = import_good(Painted());
  const Material& material = model.materials.at(static_cast<std::size_t>(model.meshes[0].material));
  EXPECT_EQ(material.metallic, 1.0f);
  EXPECT_EQ(material.roughness, 1.0f);
  EXPECT_EQ(material.base_colour, Eigen::Vector4f::Ones());
  EXPECT_EQ(material.alpha_mode, AlphaMode::kOpaque);
  EXPECT_FALSE(material.double_sided);
  EXPECT_THAT(model.textures, IsEmpty());
}

TEST(GltfMaterial, reads_every_factor) {
  Painted file;
  file.material() = {{"name", "gold"},
                     {"pbrMetallicRoughness",
                      {{"baseColorFactor", {0.1, 0.2, 0.3, 0.4}}, {"metallicFactor", 0.5}, {"roughnessFactor", 0.25}}},
                     {"emissiveFactor", {1.0, 0.5, 0.25}},
                     {"extensions", {{"KHR_materials_emissive_strength", {{"emissiveStrength", 60.0}}}}},
                     {"alphaMode", "MASK"},
                     {"alphaCutoff", 0.75},
                     {"doubleSided", true}};
  const Material material = import_good(file).materials.at(0);
  EXPECT_EQ(material.name, "gold");
  EXPECT_EQ(material.base_colour, Eigen::Vector4f(0.1f, 0.2f, 0.3f, 0.4f));
  EXPECT_EQ(material.metallic, 0.5f);
  EXPECT_EQ(material.roughness, 0.25f);
  EXPECT_EQ(material.emissive, Eigen::Vector3f(60, 30, 15));
  EXPECT_EQ(material.alpha_mode, AlphaMode::kMask);
  EXPECT_EQ(material.alpha_cutoff, 0.75f);
  EXPECT_TRUE(material.double_sided);
}

TEST(GltfMaterial, gloss_coat_and_body_have_the_specifications_defaults) {
  Painted file;
  file.material()["extensions"] = {{"KHR_materials_ior", nlohmann::json::object()},
                                   {"KHR_materials_specular", nlohmann::json::object()},
                                   {"KHR_materials_clearcoat", nlohmann::json::object()},
                                   {"KHR_materials_transmission", nlohmann::json::object()},
                                   {"KHR_materials_volume", nlohmann::json::object()}};
  const Model model = import_good(file);
  const Material& material = model.materials[0];
  EXPECT_EQ(material.ior, 1.5f);
  EXPECT_EQ(material.specular, 1.0f);
  EXPECT_EQ(material.specular_colour, Eigen::Vector3f(1, 1, 1));
  EXPECT_EQ(material.clearcoat, 0.0f);
  EXPECT_EQ(material.transmission, 0.0f);
  EXPECT_EQ(material.thickness, 0.0f);
  EXPECT_EQ(material.attenuation_colour, Eigen::Vector3f(1, 1, 1));
  EXPECT_EQ(material.attenuation_distance, 0.0f);
  EXPECT_THAT(model.notes, IsEmpty());
}

TEST(GltfMaterial, reads_gloss_coat_and_body) {
  Painted file;
  const nlohmann::json picture = {{"index", 0}};
  const nlohmann::json bump = {{"index", 0}, {"scale", 0.25}};
  file.json["extensionsUsed"] = {"KHR_materials_ior", "KHR_materials_specular", "KHR_materials_clearcoat",
                                 "KHR_materials_transmission", "KHR_materials_volume"};
  file.material()["extensions"] = {
      {"KHR_materials_ior", {{"ior", 1.76}}},
      {"KHR_materials_specular",
       {{"specularFactor", 0.5},
        {"specularColorFactor", {2.0, 0.5, 0.25}},
        {"specularTexture", picture},
        {"specularColorTexture", picture}}},
      {"KHR_materials_clearcoat",
       {{"clearcoatFactor", 0.75},
        {"clearcoatRoughnessFactor", 0.125},
        {"clearcoatTexture", picture},
        {"clearcoatRoughnessTexture", picture},
        {"clearcoatNormalTexture", bump}}},
      {"KHR_materials_transmission", {{"transmissionFactor", 0.875}, {"transmissionTexture", picture}}},
      {"KHR_materials_volume",
       {{"thicknessFactor", 2.5}, {"attenuationColor", {0.5, 0.25, 0.125}}, {"attenuationDistance", 0.3125}}}};
  const Model model = import_good(file);
  const Material& material = model.materials[0];
  EXPECT_EQ(material.ior, 1.76f);
  EXPECT_EQ(material.specular, 0.5f);
  EXPECT_EQ(material.specular_colour, Eigen::Vector3f(2, 0.5f, 0.25f));
  EXPECT_EQ(material.clearcoat, 0.75f);
  EXPECT_EQ(material.clearcoat_roughness, 0.125f);
  EXPECT_EQ(material.clearcoat_normal_scale, 0.25f);
  EXPECT_EQ(material.transmission, 0.875f);
  EXPECT_EQ(material.thickness, 2.5f);
  EXPECT_EQ(material.attenuation_colour, Eigen::Vector3f(0.5f, 0.25f, 0.125f));
  EXPECT_EQ(material.attenuation_distance, 0.3125f);
  for (const auto* use :
       {&material.specular_texture, &material.specular_colour_texture, &material.clearcoat_texture,
        &material.clearcoat_roughness_texture, &material.clearcoat_normal_texture, &material.transmission_texture}) {
    EXPECT_EQ(use->texture, 0);
  }
  EXPECT_EQ(model.meshes[0].texcoords[0].size(), 3u);
  EXPECT_THAT(model.notes, IsEmpty());
}

TEST(GltfMaterial, gloss_coat_and_body_are_clipped_to_valid_values) {
  Painted file;
  auto& extensions = file.material()["extensions"];
  extensions = {{"KHR_materials_ior", {{"ior", 0.5}}},
                {"KHR_materials_clearcoat", {{"clearcoatFactor", 4}, {"clearcoatRoughnessFactor", -1}}},
                {"KHR_materials_transmission", {{"transmissionFactor", 1e300}}},
                {"KHR_materials_volume",
                 {{"thicknessFactor", -1}, {"attenuationDistance", -2}, {"attenuationColor", {-1, 2, 0.5}}}}};
  const Model model = import_good(file);
  const Material& material = model.materials[0];
  EXPECT_EQ(material.ior, 1.0f);
  EXPECT_EQ(material.clearcoat, 1.0f);
  EXPECT_EQ(material.clearcoat_roughness, 0.0f);
  EXPECT_EQ(material.transmission, 1.0f);
  EXPECT_EQ(material.thickness, 0.0f);
  EXPECT_EQ(material.attenuation_distance, 0.0f);
  EXPECT_EQ(material.attenuation_colour, Eigen::Vector3f(0, 1, 0.5f));
  for (const char* const name : {"refraction", "clearcoatFactor", "clearcoatRoughness", "transmissionFactor",
                                 "thicknessFactor", "attenuationDistance"}) {
    EXPECT_THAT(model.notes, Contains(HasSubstr(name)));
  }
  extensions = {{"KHR_materials_ior", {{"ior", 0}}}};
  EXPECT_EQ(import_good(file).materials[0].ior, kMaxIor);  // The specification's value for a perfect mirror.
  extensions = {{"KHR_materials_clearcoat", {{"clearcoatFactor", 1}, {"clearcoatTexture", {{"index", 7}}}}}};
  EXPECT_THAT(error_of(file.import()), HasSubstr("clearcoatTexture/index: index 7 of 1 textures"));
  extensions = {{"KHR_materials_specular", {{"specularColorFactor", {1, 2}}}}};
  EXPECT_THAT(error_of(file.import()), HasSubstr("specularColorFactor: 3 numbers"));
}

TEST(GltfMaterial, factors_outside_their_range_are_clipped_and_noted) {
  Painted file;
  file.material()["pbrMetallicRoughness"] = {{"metallicFactor", 7}, {"roughnessFactor", -1}};
  const Model model = import_good(file);
  EXPECT_EQ(model.materials[0].metallic, 1.0f);
  EXPECT_EQ(model.materials[0].roughness, 0.0f);
  EXPECT_THAT(model.notes, Contains(HasSubstr("metallicFactor")));
  file.material()["pbrMetallicRoughness"] = {{"baseColorFactor", {1, 2, 3}}};
  EXPECT_THAT(error_of(file.import()), HasSubstr("/materials/0/pbrMetallicRoughness/baseColorFactor: 4 numbers"));
}

TEST(GltfMaterial, a_texture_has_its_pixels_and_its_sampler) {
  Painted file;
  file.base_texture() = {{"index", 0}};
  file.json["samplers"] = {{{"wrapS", 33071}, {"wrapT", 33648}, {"magFilter", 9728}}};
  file.json["textures"][0]["sampler"] = 0;
  const Model model = import_good(file);
  ASSERT_EQ(model.textures.size(), 1u);
  const Texture& texture = model.textures[0];
  EXPECT_EQ(texture.pixels.width(), 2);
  EXPECT_EQ(texture.pixels.at(1, 0)[2], 255);
  EXPECT_EQ(texture.wrap_u, WrapMode::kClamp);
  EXPECT_EQ(texture.wrap_v, WrapMode::kMirror);
  EXPECT_TRUE(texture.nearest);
  EXPECT_EQ(model.meshes[0].texcoords[0].size(), 3u);
  EXPECT_THAT(model.meshes[0].texcoords[1], IsEmpty());
}

TEST(GltfMaterial, a_picture_shared_by_several_textures_is_stored_once) {
  Painted file;
  file.base_texture() = {{"index", 0}};
  file.material()["emissiveTexture"] = {{"index", 1}};
  file.json["textures"].push_back({{"source", 0}});
  EXPECT_EQ(import_good(file).textures.size(), 1u);
  file.json["samplers"] = {{{"wrapS", 33071}}};
  file.json["textures"][1]["sampler"] = 0;
  EXPECT_EQ(import_good(file).textures.size(), 2u);
}

TEST(GltfMaterial, unused_texture_coordinates_are_dropped) {
  EXPECT_THAT(import_good(Painted()).meshes[0].texcoords[0], IsEmpty());
}

TEST(GltfMaterial, the_texture_transform_rotates_counter_clockwise_after_scaling) {
  Painted file;
  file.base_texture() = {
      {"index", 0},
      {"extensions",
       {{"KHR_texture_transform", {{"offset", {0.5, 0.25}}, {"rotation", std::acos(0.0)}, {"scale", {2, 3}}}}}}};
  const auto transform = import_good(file).materials[0].base_colour_texture.transform;
  const Eigen::Vector2f moved = transform * Eigen::Vector3f(1, 1, 1);
  EXPECT_NEAR(moved.x(), 0.5f + 3.0f, 1e-6f);
  EXPECT_NEAR(moved.y(), 0.25f - 2.0f, 1e-6f);
}

TEST(GltfMaterial, a_texture_without_coordinates_is_left_out_for_that_primitive_only) {
  Painted file;
  file.base_texture() = {{"index", 0}};
  file.add_primitive({{"POSITION", 0}})["material"] = 0;
  const Model model = import_good(file);
  ASSERT_EQ(model.meshes.size(), 2u);
  const auto use = [&](std::size_t mesh) {
    return model.materials[static_cast<std::size_t>(model.meshes[mesh].material)].base_colour_texture.texture;
  };
  EXPECT_EQ(use(0), 0);
  EXPECT_EQ(use(1), -1);
  EXPECT_EQ(model.textures.size(), 1u);
  EXPECT_THAT(model.notes, Contains(HasSubstr("no texture coordinates")));
}

TEST(GltfMaterial, the_second_set_of_coordinates_is_read_and_a_third_is_noted) {
  Painted file;
  file.primitive()["attributes"]["TEXCOORD_1"] =
      file.add_accessor<std::uint8_t>({0, 0, 255, 0, 0, 255}, "VEC2", 5121, true);
  file.base_texture() = {{"index", 0}, {"texCoord", 1}};
  Model model = import_good(file);
  EXPECT_EQ(model.materials[0].base_colour_texture.texcoord, 1);
  EXPECT_THAT(model.meshes[0].texcoords[0], IsEmpty());
  EXPECT_EQ(model.meshes[0].texcoords[1].at(2)[1], 1.0f);
  file.base_texture()["texCoord"] = 2;
  model = import_good(file);
  EXPECT_EQ(model.materials[0].base_colour_texture.texture, -1);
  EXPECT_THAT(model.notes, Contains(HasSubstr("third set")));
}

TEST(GltfMaterial, a_broken_picture_is_named_and_the_surface_stays_plain) {
  Painted file;
  file.base_texture() = {{"index", 0}};
  file.json["images"][0] = {{"bufferView", file.add_view<std::uint8_t>({1, 2, 3, 4})}, {"name", "stripes"}};
  Model model = import_good(file);
  EXPECT_EQ(model.materials[0].base_colour_texture.texture, -1);
  EXPECT_THAT(model.textures, IsEmpty());
  EXPECT_THAT(model.notes, Contains(HasSubstr("'stripes' is not used")));
  file.json["images"][0] = {{"uri", "../stripes.png"}};
  EXPECT_THAT(import_good(file).notes, Contains(HasSubstr("'../stripes.png' is not used")));
  file.json["textures"][0].erase("source");
  EXPECT_THAT(import_good(file).notes, Contains(HasSubstr("no PNG, JPEG, WebP or KTX2")));
}

TEST(GltfMaterial, a_picture_over_the_limit_is_not_decoded) {
  Painted file;
  file.base_texture() = {{"index", 0}};
  ImportLimits limits;
  limits.texture_px = 1;
  const Result<Model> model = file.import(limits);
  ASSERT_TRUE(model.has_value());
  EXPECT_THAT(model->textures, IsEmpty());
  EXPECT_THAT(model->notes, Contains(HasSubstr("'stripes' is not used")));
}

TEST(GltfMaterial, dangling_references_are_errors) {
  Painted file;
  file.base_texture() = {{"index", 1}};
  EXPECT_THAT(error_of(file.import()), HasSubstr("baseColorTexture/index: index 1 of 1 textures"));
  file.base_texture() = {{"index", 0}};
  file.json["textures"][0]["source"] = 5;
  EXPECT_THAT(error_of(file.import()), HasSubstr("/textures/0/source: index 5 of 1 images"));
  file.primitive()["material"] = 9;
  EXPECT_THAT(error_of(file.import()), HasSubstr("/meshes/0/primitives/0/material: index 9 of 1 materials"));
}

TEST(GltfMaterial, tangents_are_kept_for_normal_maps_only) {
  Painted file;
  file.primitive()["attributes"]["NORMAL"] = file.add_floats({0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3");
  file.primitive()["attributes"]["TANGENT"] = file.add_floats({2, 0, 0, 1, 2, 0, 0, 1, 2, 0, 0, -1}, "VEC4");
  EXPECT_THAT(import_good(file).meshes[0].tangents, IsEmpty());
  file.material()["normalTexture"] = {{"index", 0}, {"scale", 0.5}};
  const Model model = import_good(file);
  EXPECT_EQ(model.materials[0].normal_scale, 0.5f);
  ASSERT_EQ(model.meshes[0].tangents.size(), 3u);
  EXPECT_THAT(model.meshes[0].tangents[2], ::testing::ElementsAre(1, 0, 0, -1));
}

TEST(GltfMaterial, specular_glossiness_becomes_metal_or_dielectric) {
  Painted file;
  auto& extension = file.material()["extensions"]["KHR_materials_pbrSpecularGlossiness"];
  extension = {{"diffuseFactor", {0.5, 0.25, 0.125, 0.75}}, {"specularFactor", {0, 0, 0}}, {"glossinessFactor", 0.25}};
  Material material = import_good(file).materials[0];
  EXPECT_EQ(material.metallic, 0.0f);
  EXPECT_NEAR(material.roughness, 0.75f, 1e-6f);
  EXPECT_NEAR(material.base_colour.y() / material.base_colour.x(), 0.5f, 1e-5f);
  EXPECT_EQ(material.base_colour.w(), 0.75f);
  extension = {{"diffuseFactor", {0, 0, 0, 1}}, {"specularFactor", {0.9, 0.6, 0.3}}};
  material = import_good(file).materials[0];
  EXPECT_NEAR(material.metallic, 1.0f, 1e-3f);
  EXPECT_NEAR(material.base_colour.x(), 0.9f, 1e-3f);
  EXPECT_NEAR(material.base_colour.z(), 0.3f, 1e-3f);
  extension = {{"diffuseTexture", {{"index", 0}}}};
  const Model model = import_good(file);
  EXPECT_EQ(model.materials[0].base_colour_texture.texture, 0);
  EXPECT_EQ(model.materials[0].metallic, 0.0f);
  EXPECT_THAT(model.notes, Contains(HasSubstr("approximated")));
}

TEST(GltfMaterial, an_unlit_material_keeps_only_its_base_colour_and_alpha) {
  Painted file;
  file.json["extensionsRequired"] = {"KHR_materials_unlit"};
  base_colour_of(file) = {0.5, 0.25, 0.125, 0.75};
  file.base_texture() = {{"index", 0}};
  file.material()["emissiveFactor"] = {1, 1, 1};
  file.material()["normalTexture"] = {{"index", 0}};
  file.material()["alphaMode"] = "BLEND";
  EXPECT_FALSE(import_good(file).materials[0].unlit);
  file.material()["extensions"]["KHR_materials_unlit"] = nlohmann::json::object();
  const Model model = import_good(file);
  const Material& material = model.materials[0];
  EXPECT_TRUE(material.unlit);
  EXPECT_EQ(material.base_colour, Eigen::Vector4f(0.5f, 0.25f, 0.125f, 0.75f));
  EXPECT_EQ(material.base_colour_texture.texture, 0);
  EXPECT_EQ(material.alpha_mode, AlphaMode::kBlend);
  EXPECT_TRUE(material.emissive.isZero());
  EXPECT_EQ(material.normal_texture.texture, -1);
  EXPECT_THAT(model.notes, IsEmpty());
}

TEST(GltfMaterial, unsupported_features_are_noted) {
  Painted file;
  file.json["extensionsUsed"] = {"KHR_materials_sheen"};
  file.material()["alphaMode"] = "GLOW";
  const Model model = import_good(file);
  EXPECT_THAT(model.notes, Contains("KHR_materials_sheen is not supported: ignored"));
  EXPECT_THAT(model.notes, Contains(HasSubstr("alphaMode")));
}

TEST(GltfMaterial, a_thousand_similar_notes_become_one_sentence) {
  GltfNotes notes;
  for (int i = 0; i < 1000; ++i) notes.add("grass is grey", "/meshes/" + std::to_string(i));
  EXPECT_THAT(notes.sentences(), ::testing::ElementsAre("grass is grey (1000 times, first at /meshes/0)"));
  for (int i = 0; i < 1000; ++i) notes.add("note " + std::to_string(i), "");
  EXPECT_LT(notes.sentences().size(), 70u);
  EXPECT_THAT(notes.sentences().back(), HasSubstr("more things"));
}

}  // namespace
}  // namespace cyclorama::scene
