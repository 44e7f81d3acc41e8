// SPDX-License-Identifier: Apache-2.0
// Real files give the counts that their makers state.
#include <gmock/gmock.h>

#include <cmath>

#include "renderfarm/scene/model.h"
#include "tests/data_sets/shared_data.h"

namespace cyclorama::scene {
namespace {

using ::testing::Contains;
using ::testing::Each;
using ::testing::HasSubstr;

struct Expected {
  const char* name;
  std::size_t stored;
  std::size_t seen;
  std::size_t textures;
};

std::size_t stored(const Model& model) {
  std::size_t count = 0;
  for (const Mesh& mesh : model.meshes) count += mesh.triangles.size();
  return count;
}

std::size_t seen(const Model& model) {
  std::size_t count = 0;
  for (const Instance& instance : model.instances) {
    count += model.meshes[static_cast<std::size_t>(instance.mesh)].triangles.size();
  }
  return count;
}

template <std::size_t N>
bool all_finite(const std::vector<std::array<float, N>>& values) {
  return std::all_of(values.begin(), values.end(), [](const std::array<float, N>& value) {
    return std::all_of(value.begin(), value.end(), [](float v) { return std::isfinite(v); });
  });
}

/// Model's invariants, as its header states them.
void expect_sound(const Model& model) {
  EXPECT_FALSE(model.materials.empty());
  for (const Mesh& mesh : model.meshes) {
    ASSERT_LT(static_cast<std::size_t>(mesh.material), model.materials.size());
    const std::size_t count = mesh.positions.size();
    for (const auto& t : mesh.triangles) ASSERT_LT(std::max({t[0], t[1], t[2]}), count);
    for (const std::size_t size : {mesh.normals.size(), mesh.tangents.size(), mesh.colours.size(),
                                   mesh.texcoords[0].size(), mesh.texcoords[1].size()}) {
      ASSERT_TRUE(size == 0 || size == count);
    }
    EXPECT_TRUE(all_finite(mesh.positions) && all_finite(mesh.normals) && all_finite(mesh.tangents));
    EXPECT_TRUE(all_finite(mesh.texcoords[0]) && all_finite(mesh.texcoords[1]));
    const Material& material = model.materials[static_cast<std::size_t>(mesh.material)];
    for (TextureUse Material::*const at : texture_places()) {
      const TextureUse& use = material.*at;
      if (use.texture < 0) continue;
      ASSERT_LT(static_cast<std::size_t>(use.texture), model.textures.size());
      ASSERT_EQ(mesh.texcoords[static_cast<std::size_t>(use.texcoord)].size(), count);
    }
  }
  for (const Instance& instance : model.instances) {
    ASSERT_LT(static_cast<std::size_t>(instance.mesh), model.meshes.size());
    EXPECT_TRUE(instance.T_model_mesh.matrix().allFinite());
  }
}

class GltfShared : public ::testing::TestWithParam<Expected> {};

TEST_P(GltfShared, has_the_number_of_triangles_that_its_makers_state) {
  const Expected& expected = GetParam();
  CYCLORAMA_SHARED_DATA(file, expected.name);
  const Result<Model> model = import_gltf(file, ImportLimits{});
  ASSERT_TRUE(model.has_value()) << model.error().message();
  expect_sound(*model);
  EXPECT_EQ(stored(*model), expected.stored);
  EXPECT_EQ(seen(*model), expected.seen);
  EXPECT_EQ(model->textures.size(), expected.textures);
}

// Triangle counts come from the manifest; textures are those that a material samples, which excludes occlusion.
INSTANTIATE_TEST_SUITE_P(
    Manifest, GltfShared,
    ::testing::Values(
        Expected{"scenes/grotto_thousand_buddhas.glb", 719240, 9434870, 0},
        Expected{"scenes/cave_scan_draco.glb", 595410, 595410, 0}, Expected{"scenes/hotel_room.glb", 99029, 99029, 6},
        Expected{"scenes/webxr_cave/cave.gltf", 5894, 5894, 0},
        Expected{"relics/buddha_head_100k.glb", 99999, 99999, 0}, Expected{"relics/Hermes.glb", 19670, 19670, 1},
        Expected{"relics/EpicMetro.glb", 18942, 18942, 1}, Expected{"relics/Gutenberg.glb", 17346, 17346, 1},
        Expected{"relics/DeChalon.glb", 13572, 13572, 1}, Expected{"relics/BustManWreath.glb", 31514, 31514, 1},
        Expected{"relics/egyptian_cat.glb", 4622, 4622, 3}, Expected{"materials/ClearCoatTest.glb", 37116, 37116, 6},
        Expected{"materials/TransmissionRoughnessTest.glb", 77792, 77792, 5},
        Expected{"materials/AttenuationTest.glb", 232, 292, 2}, Expected{"materials/SpecularTest.glb", 44828, 44828, 4},
        Expected{"materials/AlphaBlendModeTest.glb", 61, 61, 8},
        Expected{"materials/SimpleSparseAccessor/SimpleSparseAccessor.gltf", 12, 12, 0},
        Expected{"materials/sphere_lights.gltf", 224, 224, 2},
        Expected{"materials/spheres_scaled_instances/spheres_scaled_instances.gltf", 224, 672, 0},
        Expected{"materials/vertex_colour_cube.glb", 48, 48, 0},
        Expected{"materials/TextureTransformTest/TextureTransformTest.gltf", 18, 24, 5}),
    [](const auto& test) {
      std::string name = test.param.name;
      std::replace_if(
          name.begin(), name.end(), [](char c) { return std::isalnum(static_cast<unsigned char>(c)) == 0; }, '_');
      return name;
    });

Material material_called(const Model& model, const std::string& name) {
  for (const Material& material : model.materials) {
    if (material.name == name) return material;
  }
  ADD_FAILURE() << "no material " << name;
  return Material{};
}

TEST(GltfSharedDetails, khronos_materials_are_read_completely) {
  CYCLORAMA_SHARED_DATA(coated, "materials/ClearCoatTest.glb");
  CYCLORAMA_SHARED_DATA(rough_glass, "materials/TransmissionRoughnessTest.glb");
  CYCLORAMA_SHARED_DATA(tinted_glass, "materials/AttenuationTest.glb");
  CYCLORAMA_SHARED_DATA(shiny, "materials/SpecularTest.glb");
  const auto read = [](const auto& file) {
    const Result<Model> model = import_gltf(file, ImportLimits{});
    EXPECT_TRUE(model.has_value());
    EXPECT_THAT(model->notes, ::testing::IsEmpty()) << file;
    return *model;
  };
  const Material coat = material_called(read(coated), "Partial_Coated");
  EXPECT_EQ(coat.clearcoat, 1.0f);
  EXPECT_EQ(coat.clearcoat_roughness, 0.03f);
  EXPECT_GE(coat.clearcoat_texture.texture, 0);
  const Material diamond = material_called(read(rough_glass), "Mat_IOR_2.42");
  EXPECT_EQ(diamond.ior, 2.42f);
  EXPECT_EQ(diamond.transmission, 1.0f);
  EXPECT_EQ(diamond.thickness, 0.005f);
  const Material glass = material_called(read(tinted_glass), "R2_ThicknessFac_2.0");
  EXPECT_EQ(glass.attenuation_colour, Eigen::Vector3f(0.1f, 0.5f, 0.9f));
  EXPECT_EQ(glass.attenuation_distance, 1.0f);
  EXPECT_EQ(material_called(read(shiny), "M1.2_specFac").specular, 0.051269f);
}

TEST(GltfSharedDetails, missing_features_of_a_sphere_with_every_extension_are_noted_once) {
  CYCLORAMA_SHARED_DATA(file, "materials/pbr_next_sphere/sphere.gltf");
  const Result<Model> model = import_gltf(file, ImportLimits{});
  ASSERT_TRUE(model.has_value()) << model.error().message();
  EXPECT_THAT(model->notes, ::testing::ElementsAre("KHR_materials_sheen is not supported: ignored"));
  const Material& material = model->materials[0];
  EXPECT_EQ(material.ior, 1.55f);
  EXPECT_EQ(material.transmission, 0.75f);
  EXPECT_EQ(material.clearcoat, 0.95f);
  EXPECT_EQ(material.specular_colour, Eigen::Vector3f(0.212f, 0.521f, 0.051f));
  EXPECT_EQ(material.attenuation_distance, 0.155f);
}

TEST(GltfSharedDetails, the_grotto_keeps_its_lamps_and_their_strength) {
  CYCLORAMA_SHARED_DATA(file, "scenes/grotto_thousand_buddhas.glb");
  const Result<Model> model = import_gltf(file, ImportLimits{});
  ASSERT_TRUE(model.has_value());
  EXPECT_EQ(model->lights.size(), 7u);
  EXPECT_EQ(model->viewpoints.size(), 6u);
  EXPECT_THAT(model->notes, ::testing::IsEmpty());
  const auto glow =
      std::max_element(model->materials.begin(), model->materials.end(),
                       [](const auto& a, const auto& b) { return a.emissive.maxCoeff() < b.emissive.maxCoeff(); });
  EXPECT_FLOAT_EQ(glow->emissive.x(), 60.0f);
}

TEST(GltfSharedDetails, a_scene_over_the_memory_limit_is_refused) {
  CYCLORAMA_SHARED_DATA(file, "scenes/grotto_thousand_buddhas.glb");
  ImportLimits limits;
  limits.memory_bytes = 8 << 20;
  const Result<Model> model = import_gltf(file, limits);
  ASSERT_FALSE(model.has_value());
  EXPECT_THAT(model.error().message(), HasSubstr("grotto_thousand_buddhas.glb: /accessors/"));
  EXPECT_THAT(model.error().message(), HasSubstr("raise the memory limit"));
}

TEST(GltfSharedDetails, the_generators_valid_files_load_except_two) {
  CYCLORAMA_SHARED_DATA(folder, "materials/asset_generator");
  std::size_t count = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (entry.path().extension() != ".gltf") continue;
    const Result<Model> model = import_gltf(entry.path(), ImportLimits{});
    const std::string name = entry.path().stem().string();
    const bool must_fail = name == "Compatibility_04" || name == "Compatibility_05";
    EXPECT_EQ(model.has_value(), !must_fail) << name << ": " << (model ? "loaded" : model.error().message());
    if (model) expect_sound(*model);
    ++count;
  }
  EXPECT_EQ(count, 37u);
}

TEST(GltfSharedDetails, vertex_colours_of_any_type_agree) {
  CYCLORAMA_SHARED_DATA(folder, "materials/asset_generator/Mesh_PrimitiveVertexColor");
  std::vector<std::array<std::uint8_t, 4>> first;
  for (int i = 0; i < 6; ++i) {
    const Result<Model> model =
        import_gltf(folder / ("Mesh_PrimitiveVertexColor_0" + std::to_string(i) + ".gltf"), ImportLimits{});
    ASSERT_TRUE(model.has_value()) << model.error().message();
    std::vector<std::array<std::uint8_t, 4>> colours = model->meshes.at(0).colours;
    ASSERT_FALSE(colours.empty());
    if (i == 0) first = colours;
    for (std::size_t k = 0; k < colours.size(); ++k) {
      for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(colours[k][c], first[k][c], 1) << i;
    }
  }
}

TEST(GltfSharedDetails, every_primitive_mode_with_a_surface_covers_the_same_square) {
  CYCLORAMA_SHARED_DATA(folder, "materials/asset_generator/Mesh_PrimitiveMode");
  for (const char* const number : {"04", "05", "06", "11", "12", "13", "14", "15"}) {
    const Result<Model> model =
        import_gltf(folder / (std::string("Mesh_PrimitiveMode_") + number + ".gltf"), ImportLimits{});
    ASSERT_TRUE(model.has_value()) << model.error().message();
    double area = 0.0;
    const Mesh& mesh = model->meshes.at(0);
    for (const auto& t : mesh.triangles) {
      const auto& [a, b, c] = std::tie(mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]);
      area += 0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]));
    }
    EXPECT_NEAR(area, 1.0, 1e-6) << number;
  }
}

}  // namespace
}  // namespace cyclorama::scene
