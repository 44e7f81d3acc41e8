// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene/gltf_draco.h"

#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#include <gmock/gmock.h>

#include "tests/unit/renderfarm/scene/gltf_builder.h"

namespace cyclorama {
namespace {

using ::testing::HasSubstr;

constexpr int kSide = 12;
constexpr int kTriangles = 2 * kSide * kSide;

/// A bumpy square with colours, compressed.
std::vector<std::uint8_t> compressed(int method) {
  draco::TriangleSoupMeshBuilder builder;
  builder.Start(kTriangles);
  const int position = builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
  const int colour = builder.AddAttribute(draco::GeometryAttribute::COLOR, 4, draco::DT_UINT8);
  const auto corner = [](int x, int y) {
    return std::array<float, 3>{static_cast<float>(x), static_cast<float>(y), static_cast<float>(x * y % 3)};
  };
  const auto tint = [](int x, int y) {
    return std::array<std::uint8_t, 4>{static_cast<std::uint8_t>(x * 20), static_cast<std::uint8_t>(y * 20), 0, 255};
  };
  std::uint32_t face = 0;
  const auto add = [&](std::array<int, 2> a, std::array<int, 2> b, std::array<int, 2> c) {
    const draco::FaceIndex index(face++);
    builder.SetAttributeValuesForFace(position, index, corner(a[0], a[1]).data(), corner(b[0], b[1]).data(),
                                      corner(c[0], c[1]).data());
    builder.SetAttributeValuesForFace(colour, index, tint(a[0], a[1]).data(), tint(b[0], b[1]).data(),
                                      tint(c[0], c[1]).data());
  };
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      add({x, y}, {x + 1, y}, {x + 1, y + 1});
      add({x, y}, {x + 1, y + 1}, {x, y + 1});
    }
  }
  const std::unique_ptr<draco::Mesh> mesh = builder.Finalize();
  draco::Encoder encoder;
  encoder.SetEncodingMethod(method);
  encoder.SetAttributeQuantization(draco::GeometryAttribute::POSITION, 16);
  draco::EncoderBuffer buffer;
  EXPECT_TRUE(encoder.EncodeMeshToBuffer(*mesh, &buffer).ok());
  return {buffer.data(), buffer.data() + buffer.size()};
}

GltfBuilder draco_file(const std::vector<std::uint8_t>& data) {
  GltfBuilder file;
  const int view = file.add_view(data);
  const int vertices = (kSide + 1) * (kSide + 1);
  file.json["accessors"] = {{{"componentType", 5125}, {"count", kTriangles * 3}, {"type", "SCALAR"}},
                            {{"componentType", 5126}, {"count", vertices}, {"type", "VEC3"}},
                            {{"componentType", 5121}, {"count", vertices}, {"type", "VEC4"}, {"normalized", true}}};
  nlohmann::json& primitive = file.add_primitive({{"POSITION", 1}, {"COLOR_0", 2}});
  primitive["indices"] = 0;
  primitive["extensions"]["KHR_draco_mesh_compression"] = {{"bufferView", view},
                                                           {"attributes", {{"POSITION", 0}, {"COLOR_0", 1}}}};
  file.json["extensionsRequired"] = {"KHR_draco_mesh_compression"};
  file.show();
  return file;
}

nlohmann::json& extension_of(GltfBuilder& file) {
  return file.json["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"];
}

class GltfDraco : public ::testing::TestWithParam<int> {};

TEST_P(GltfDraco, gives_back_what_was_compressed) {
  const Result<Model> model = draco_file(compressed(GetParam())).import();
  ASSERT_TRUE(model.has_value()) << error_of(model);
  const Mesh& mesh = model->meshes.at(0);
  EXPECT_EQ(mesh.triangles.size(), std::size_t{kTriangles});
  ASSERT_EQ(mesh.positions.size(), std::size_t{(kSide + 1) * (kSide + 1)});
  ASSERT_EQ(mesh.colours.size(), mesh.positions.size());
  double area = 0.0;
  for (const auto& t : mesh.triangles) {
    const auto& a = mesh.positions[t[0]];
    const auto& b = mesh.positions[t[1]];
    const auto& c = mesh.positions[t[2]];
    area += 0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]));
  }
  EXPECT_NEAR(area, kSide * kSide, 0.05);  // Seen from above, with its winding; quantised.
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const float linear = std::round(mesh.positions[i][0]) * 20.0f / 255.0f;
    const float code = mesh.colours[i][0] / 255.0f;
    const float back = code <= 0.04045f ? code / 12.92f : std::pow((code + 0.055f) / 1.055f, 2.4f);
    EXPECT_NEAR(back, linear, 0.01f);
  }
}

TEST_P(GltfDraco, every_truncation_is_refused) {
  const std::vector<std::uint8_t> whole = compressed(GetParam());
  for (std::size_t size = 1; size < whole.size(); size += 1 + size / 50) {
    const std::vector<std::uint8_t> part(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
    EXPECT_THAT(error_of(draco_file(part).import()), HasSubstr("/meshes/0/primitives/0")) << size;
  }
}

TEST_P(GltfDraco, flipped_bytes_load_or_give_an_error) {
  const std::vector<std::uint8_t> whole = compressed(GetParam());
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
  GltfBuilder file = draco_file(compressed(draco::MESH_EDGEBREAKER_ENCODING));
  file.json["accessors"][0]["count"] = 3;
  EXPECT_THAT(error_of(file.import()), HasSubstr("has 288 triangles"));
  file = draco_file(compressed(draco::MESH_SEQUENTIAL_ENCODING));
  file.json["accessors"][1]["count"] = 170;
  EXPECT_THAT(error_of(file.import()), HasSubstr("169 vertices where the accessors say 288 and 170"));
}

TEST(GltfDracoPromise, attributes_must_be_what_their_accessors_say) {
  GltfBuilder file = draco_file(compressed(draco::MESH_EDGEBREAKER_ENCODING));
  extension_of(file)["attributes"]["COLOR_0"] = 7;
  EXPECT_THAT(error_of(file.import()), HasSubstr("no attribute 7"));
  extension_of(file)["attributes"]["COLOR_0"] = 0;
  EXPECT_THAT(error_of(file.import()), HasSubstr("another type or count"));
  extension_of(file)["attributes"]["COLOR_0"] = ~std::uint64_t{0};
  EXPECT_THAT(error_of(file.import()), HasSubstr("no attribute"));
}

TEST(GltfDracoPromise, work_memory_is_paid_for) {
  ImportLimits limits;
  limits.memory_bytes = 40'000;
  EXPECT_THAT(error_of(draco_file(compressed(draco::MESH_EDGEBREAKER_ENCODING)).import(limits)),
              HasSubstr("memory limit"));
}

}  // namespace
}  // namespace cyclorama
