// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene/gltf_draco.h"

#include <gmock/gmock.h>

#include "tests/unit/renderfarm/scene/draco_builder.h"

namespace cyclorama::scene {
namespace {

using ::testing::HasSubstr;

nlohmann::json& extension_of(GltfBuilder& file) {
  return file.json["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"];
}

class GltfDraco : public ::testing::TestWithParam<int> {};

TEST_P(GltfDraco, decodes_what_was_compressed) {
  const Result<Model> model = draco_file(compressed_square(GetParam())).import();
  ASSERT_TRUE(model.has_value()) << error_of(model);
  const Mesh& mesh = model->meshes.at(0);
  EXPECT_EQ(mesh.triangles.size(), std::size_t{kDracoTriangles});
  ASSERT_EQ(mesh.positions.size(), std::size_t{(kDracoSide + 1) * (kDracoSide + 1)});
  ASSERT_EQ(mesh.colours.size(), mesh.positions.size());
  double area = 0.0;
  for (const auto& t : mesh.triangles) {
    const auto& a = mesh.positions[t[0]];
    const auto& b = mesh.positions[t[1]];
    const auto& c = mesh.positions[t[2]];
    area += 0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]));
  }
  EXPECT_NEAR(area, kDracoSide * kDracoSide, 0.05);  // Projected from above, with the winding; quantised.
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const float linear = std::round(mesh.positions[i][0]) * 20.0f / 255.0f;
    const float code = mesh.colours[i][0] / 255.0f;
    const float back = code <= 0.04045f ? code / 12.92f : std::pow((code + 0.055f) / 1.055f, 2.4f);
    EXPECT_NEAR(back, linear, 0.01f);
  }
}

TEST_P(GltfDraco, every_truncation_is_refused) {
  const std::vector<std::uint8_t> whole = compressed_square(GetParam());
  for (std::size_t size = 1; size < whole.size(); size += 1 + size / 50) {
    const std::vector<std::uint8_t> part(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
    EXPECT_THAT(error_of(draco_file(part).import()), HasSubstr("/meshes/0/primitives/0")) << size;
  }
}

TEST_P(GltfDraco, damaged_data_loads_or_gives_an_error) {
  const std::vector<std::uint8_t> whole = compressed_square(GetParam());
  for (std::size_t i = 0; i < whole.size(); ++i) {
    std::vector<std::uint8_t> bent = whole;
    bent[i] ^= 0xff;
    const Result<Model> model = draco_file(bent).import();
    EXPECT_TRUE(model.has_value() || model.error().code() == ErrorCode::kBadData) << i << error_of(model);
  }
}

INSTANTIATE_TEST_SUITE_P(BothMethods, GltfDraco,
                         ::testing::Values(draco::MESH_SEQUENTIAL_ENCODING, draco::MESH_EDGEBREAKER_ENCODING));

TEST(GltfDracoPromise, data_that_announces_other_sizes_than_the_accessors_is_not_decoded) {
  GltfBuilder file = draco_file(compressed_square(draco::MESH_EDGEBREAKER_ENCODING));
  file.json["accessors"][0]["count"] = 3;
  EXPECT_THAT(error_of(file.import()), HasSubstr("has 288 triangles"));
  file = draco_file(compressed_square(draco::MESH_SEQUENTIAL_ENCODING));
  file.json["accessors"][1]["count"] = 170;
  EXPECT_THAT(error_of(file.import()), HasSubstr("169 vertices where the accessors say 288 and 170"));
}

TEST(GltfDracoPromise, attributes_must_be_what_their_accessors_say) {
  GltfBuilder file = draco_file(compressed_square(draco::MESH_EDGEBREAKER_ENCODING));
  extension_of(file)["attributes"]["COLOR_0"] = 7;
  EXPECT_THAT(error_of(file.import()), HasSubstr("no attribute 7"));
  extension_of(file)["attributes"]["COLOR_0"] = 0;
  EXPECT_THAT(error_of(file.import()), HasSubstr("another type or count"));
  extension_of(file)["attributes"]["COLOR_0"] = ~std::uint64_t{0};
  EXPECT_THAT(error_of(file.import()), HasSubstr("no attribute"));
}

TEST(GltfDracoPromise, working_memory_counts_towards_the_limit) {
  ImportLimits limits;
  limits.memory_bytes = 40'000;
  EXPECT_THAT(error_of(draco_file(compressed_square(draco::MESH_EDGEBREAKER_ENCODING)).import(limits)),
              HasSubstr("memory limit"));
}

}  // namespace
}  // namespace cyclorama::scene
