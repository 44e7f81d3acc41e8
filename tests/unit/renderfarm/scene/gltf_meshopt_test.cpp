// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene/gltf_meshopt.h"

#include <gmock/gmock.h>

#include "tests/unit/renderfarm/scene/meshopt_builder.h"

namespace cyclorama::scene {
namespace {

using ::testing::HasSubstr;

nlohmann::json& extension_of(GltfBuilder& file, std::size_t view) {
  return file.json["bufferViews"][view]["extensions"]["EXT_meshopt_compression"];
}

TEST(GltfMeshopt, a_compressed_square_is_what_was_compressed) {
  const Result<Model> model = meshopt_file(compressed_meshopt_square()).import();
  ASSERT_TRUE(model.has_value()) << error_of(model);
  const Mesh& mesh = model->meshes.at(0);
  ASSERT_EQ(mesh.triangles.size(), 2u);
  ASSERT_EQ(mesh.positions.size(), 4u);
  EXPECT_EQ(mesh.positions[2], (std::array<float, 3>{1, 1, 0}));
  EXPECT_TRUE(model->notes.empty());
}

TEST(GltfMeshopt, what_the_extension_does_not_allow_is_refused_with_its_place) {
  struct Case {
    std::size_t view;
    const char* key;
    nlohmann::json value;
    const char* complaint;
  };
  const std::vector<Case> cases = {{0, "mode", "BEST", "BEST is no mode"},
                                   {0, "byteStride", 6, "6 is no multiple of 4"},
                                   {0, "byteStride", 260, "260 is no multiple of 4"},
                                   {0, "byteStride", 0, "0 is no multiple of 4"},
                                   {1, "byteStride", 3, "indices have 2 or 4 bytes"},
                                   {1, "count", 5, "5 corners are no whole triangles"},
                                   {0, "filter", "OCTAHEDRAL", "OCTAHEDRAL does not go with ATTRIBUTES of 12"},
                                   {1, "filter", "EXPONENTIAL", "EXPONENTIAL does not go with TRIANGLES"},
                                   {0, "filter", "BLUR", "BLUR does not go"},
                                   {0, "count", 1000000000, "cannot be stored"},
                                   {1, "count", 3000000000, "cannot be stored"},
                                   {0, "byteOffset", 100000, "of a buffer of"},
                                   {0, "buffer", 1, "the data is not in this file"}};
  for (const Case& at : cases) {
    GltfBuilder file = meshopt_file(compressed_meshopt_square());
    extension_of(file, at.view)[at.key] = at.value;
    EXPECT_THAT(error_of(file.import()), HasSubstr(at.complaint));
  }
}

TEST(GltfMeshopt, damaged_or_shortened_data_is_refused) {
  const MeshoptSquare whole = compressed_meshopt_square();
  MeshoptSquare damaged = whole;
  damaged.positions[0] ^= 0xff;
  EXPECT_THAT(error_of(meshopt_file(damaged).import()), HasSubstr("/bufferViews/0/extensions/EXT_meshopt_compression"));
  for (std::size_t size = 0; size < whole.indices.size(); ++size) {
    damaged = whole;
    damaged.indices.resize(size);
    EXPECT_NE(error_of(meshopt_file(damaged).import()), "loaded") << size;
  }
}

TEST(GltfMeshopt, the_budget_is_charged_before_memory_is_taken) {
  ImportLimits limits;
  limits.memory_bytes = 1000;
  EXPECT_THAT(error_of(meshopt_file(compressed_meshopt_square()).import(limits)), HasSubstr("memory limit"));
}

}  // namespace
}  // namespace cyclorama::scene
