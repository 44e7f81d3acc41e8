// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene/gltf_container.h"

#include <gmock/gmock.h>

#include "tests/unit/renderfarm/scene/gltf_builder.h"

namespace cyclorama::scene {
namespace {

using ::testing::HasSubstr;

std::vector<std::byte> bytes_of(std::string_view text) {
  const auto* const start = reinterpret_cast<const std::byte*>(text.data());
  return {start, start + text.size()};
}

std::string import_text(std::string_view text, const ImportLimits& limits = {}) {
  return error_of(import_gltf_bytes(bytes_of(text), std::nullopt, limits));
}

TEST(GltfContainer, every_truncation_of_a_binary_file_is_refused) {
  const std::vector<std::byte> whole = one_triangle().glb();
  ASSERT_EQ(error_of(import_gltf_bytes(whole, std::nullopt, {})), "loaded");
  for (std::size_t size = 0; size < whole.size(); ++size) {
    const Result<Model> model = import_gltf_bytes(std::span(whole).first(size), std::nullopt, {});
    ASSERT_FALSE(model.has_value()) << size;
    EXPECT_EQ(model.error().code(), ErrorCode::kBadData) << size;
  }
}

/// Returns the file with `extra` blanks after its JSON, of which the chunk's length counts `counted`.
std::vector<std::byte> with_blanks(std::size_t extra, std::size_t counted) {
  std::vector<std::byte> file = one_triangle().glb();
  const auto u32_at = [&](std::size_t at) {
    std::uint32_t value = 0;
    std::memcpy(&value, file.data() + at, sizeof value);
    return value;
  };
  const auto put = [&](std::size_t at, std::size_t value) {
    const auto word = static_cast<std::uint32_t>(value);
    std::memcpy(file.data() + at, &word, sizeof word);
  };
  const std::uint32_t json = u32_at(12);
  file.insert(file.begin() + 20 + json, extra, std::byte{' '});
  put(8, file.size());
  put(12, json + counted);
  return file;
}

TEST(GltfContainer, a_chunk_whose_length_is_no_multiple_of_4_ends_where_the_next_begins) {
  for (const auto& [extra, counted] : {std::pair{1, 1}, std::pair{3, 3}, std::pair{4, 1}, std::pair{4, 3}}) {
    const Result<Model> model =
        import_gltf_bytes(with_blanks(static_cast<std::size_t>(extra), static_cast<std::size_t>(counted)), {}, {});
    ASSERT_TRUE(model.has_value()) << extra << ", " << counted << ": " << error_of(model);
    EXPECT_EQ(model->instances.size(), 1u);
    EXPECT_THAT(model->notes, ::testing::Contains(HasSubstr("not padded")));
  }
  EXPECT_THAT(error_of(import_gltf_bytes(with_blanks(8, 1), {}, {})), HasSubstr("not a multiple of 4"));
}

TEST(GltfContainer, bytes_after_the_end_are_ignored) {
  std::vector<std::byte> file = one_triangle().glb();
  file.resize(file.size() + 7);
  EXPECT_EQ(error_of(import_gltf_bytes(file, std::nullopt, {})), "loaded");
}

TEST(GltfContainer, a_byte_order_mark_is_ignored) {
  EXPECT_EQ(import_text("\xef\xbb\xbf{\"asset\":{\"version\":\"2.0\"}}"), "loaded");
}

TEST(GltfContainer, files_that_are_not_gltf_are_named) {
  EXPECT_THAT(import_text(""), HasSubstr("empty"));
  EXPECT_THAT(import_text("PK\x03\x04"), HasSubstr("not glTF"));
  EXPECT_THAT(import_text("[]"), HasSubstr("not glTF"));
  EXPECT_THAT(import_text("   "), HasSubstr("not glTF"));
  EXPECT_THAT(import_text("glTF"), HasSubstr("header"));
}

TEST(GltfContainer, json_errors_name_the_position) {
  EXPECT_THAT(import_text("{\"asset\":{\"version\":\"2.0\"},\n \"nodes\": [1,}"), HasSubstr("line 2"));
  EXPECT_THAT(import_text("{\"asset\":{\"version\":\"2.0\"}, \"x\":1e999}"), HasSubstr("cannot be read"));
  EXPECT_THAT(import_text("{\"a\":\"\xff\"}"), HasSubstr("cannot be read"));
}

TEST(GltfContainer, deep_nesting_is_refused_before_parsing) {
  const std::string open = "{\"asset\":{\"version\":\"2.0\"},\"extras\":";
  EXPECT_EQ(import_text(open + std::string(200, '[') + std::string(200, ']') + "}"), "loaded");
  EXPECT_THAT(import_text(open + std::string(10'000'000, '[')), HasSubstr("nested"));
}

TEST(GltfContainer, too_many_values_are_refused_before_they_are_built) {
  ImportLimits limits;
  limits.memory_bytes = 1 << 20;
  std::string flood = "{\"asset\":{\"version\":\"2.0\"},\"extras\":[0";
  for (int i = 0; i < 20'000; ++i) flood += ",0";
  flood += "]}";
  EXPECT_EQ(import_text(flood), "loaded");
  EXPECT_THAT(import_text(flood, limits), HasSubstr("memory limit"));
}

TEST(GltfContainer, versions_other_than_two_are_refused_with_the_remedy) {
  EXPECT_THAT(import_text("{\"asset\":{\"version\":\"1.0\"}}"), HasSubstr("export the scene as glTF 2.0"));
  EXPECT_THAT(import_text("{\"asset\":{\"version\":\"2.1\",\"minVersion\":\"2.1\"}}"), HasSubstr("glTF '2.1'"));
  EXPECT_EQ(import_text("{\"asset\":{\"version\":\"2.1\"}}"), "loaded");
  EXPECT_THAT(import_text("{\"asset\":{}}"), HasSubstr("/asset/version: is missing"));
  EXPECT_THAT(import_text("{}"), HasSubstr("/asset: is missing"));
}

TEST(GltfContainer, required_extensions_are_refused_by_name_and_others_noted) {
  const std::string open = "{\"asset\":{\"version\":\"2.0\"},";
  EXPECT_THAT(import_text(open + "\"extensionsUsed\":[\"EXT_odd\"],\"extensionsRequired\":[\"EXT_odd\"]}"),
              HasSubstr("/extensionsRequired/0: EXT_odd is required"));
  for (const std::string name : {"KHR_materials_sheen", "EXT_texture_avif"}) {
    EXPECT_THAT(import_text(open + "\"extensionsRequired\":[\"" + name + "\"]}"), HasSubstr(name + " is required"));
    EXPECT_EQ(import_text(open + "\"extensionsUsed\":[\"" + name + "\"]}"), "loaded");
  }
  const Result<Model> model =
      import_gltf_bytes(bytes_of(open + "\"extensionsUsed\":[\"EXT_odd\",\"KHR_draco_mesh_compression\"]}"), {}, {});
  ASSERT_TRUE(model.has_value());
  EXPECT_THAT(model->notes, ::testing::Contains("EXT_odd is not supported: ignored"));
  EXPECT_THAT(model->notes, ::testing::Not(::testing::Contains(HasSubstr("draco"))));
}

TEST(GltfContainer, an_empty_scene_is_a_model_without_instances) {
  const Result<Model> model = import_gltf_bytes(bytes_of("{\"asset\":{\"version\":\"2.0\"}}"), {}, {});
  ASSERT_TRUE(model.has_value());
  EXPECT_TRUE(model->instances.empty());
  EXPECT_EQ(model->materials.size(), 1u);
  EXPECT_THAT(model->notes, ::testing::Contains(HasSubstr("no triangles")));
}

}  // namespace
}  // namespace cyclorama::scene
