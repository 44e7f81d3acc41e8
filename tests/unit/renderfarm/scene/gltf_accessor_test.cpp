// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene/gltf_accessor.h"

#include <gmock/gmock.h>

#include "tests/unit/renderfarm/scene/gltf_builder.h"

namespace cyclorama::scene {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

class GltfAccessorTest : public ::testing::Test {
 protected:
  Result<GltfAccessor> read(const GltfBuilder& builder, std::size_t index = 0) {
    bytes_ = builder.glb();
    context_.emplace(limits_);
    Result<GltfDocument> document = GltfDocument::open(bytes_, std::nullopt, &*context_);
    if (!document) return std::move(document).error();
    document_.emplace(*std::move(document));
    return read_accessor(&*document_, index, &context_->budget);
  }
  std::string error(const GltfBuilder& builder) {
    const Result<GltfAccessor> accessor = read(builder);
    return accessor ? "read" : accessor.error().message();
  }
  ImportLimits limits_;

 private:
  std::vector<std::byte> bytes_;
  std::optional<GltfContext> context_;
  std::optional<GltfDocument> document_;
};

GltfBuilder three_pairs() {
  GltfBuilder file;
  file.add_floats({1, 2, 3, 4, 5, 6}, "VEC2");
  return file;
}

TEST_F(GltfAccessorTest, reads_packed_floats) {
  const Result<GltfAccessor> accessor = read(three_pairs());
  ASSERT_TRUE(accessor.has_value());
  EXPECT_THAT(read_floats<2>(*accessor, GltfSelection::all(3)),
              ElementsAre(ElementsAre(1, 2), ElementsAre(3, 4), ElementsAre(5, 6)));
  EXPECT_THAT(read_floats<2>(*accessor, GltfSelection::some({0, 2})),
              ElementsAre(ElementsAre(1, 2), ElementsAre(5, 6)));
}

TEST_F(GltfAccessorTest, reads_interleaved_and_unaligned_elements) {
  GltfBuilder file;
  std::vector<std::uint8_t> raw(28, 0xee);
  for (std::size_t i = 0; i < 2; ++i) {
    const float value = static_cast<float>(i) + 0.5f;
    std::memcpy(raw.data() + 3 + 9 * i, &value, sizeof value);
  }
  file.add_accessor(raw, "SCALAR", 5121);
  file.json["bufferViews"][0]["byteStride"] = 9;
  file.json["accessors"][0] = {
      {"bufferView", 0}, {"byteOffset", 3}, {"componentType", 5126}, {"count", 3}, {"type", "VEC2"}};
  EXPECT_THAT(error(file), HasSubstr("do not fit"));  // The last pair ends one byte too late.
  file.json["accessors"][0]["count"] = 2;
  const Result<GltfAccessor> accessor = read(file);
  ASSERT_TRUE(accessor.has_value()) << accessor.error().message();
  EXPECT_EQ(read_floats<2>(*accessor, GltfSelection::all(2))[1][0], 1.5f);
}

TEST_F(GltfAccessorTest, normalises_integers_as_the_specification_does) {
  GltfBuilder file;
  file.add_accessor<std::int8_t>({127, -128, 0, -127}, "VEC4", 5120, true);
  file.add_accessor<std::uint16_t>({65535, 0, 13107, 1}, "VEC4", 5123, true);
  file.add_accessor<std::uint16_t>({65535, 0, 13107, 1}, "VEC4", 5123, false);
  EXPECT_THAT(read_floats<4>(*read(file, 0), GltfSelection::all(1))[0], ElementsAre(1, -1, 0, -1));
  EXPECT_THAT(read_floats<4>(*read(file, 1), GltfSelection::all(1))[0], ElementsAre(1, 0, 0.2f, 1.0f / 65535));
  EXPECT_THAT(read_floats<4>(*read(file, 2), GltfSelection::all(1))[0], ElementsAre(65535, 0, 13107, 1));
}

TEST_F(GltfAccessorTest, applies_sparse_values) {
  GltfBuilder file = three_pairs();
  file.json["accessors"][0]["sparse"] = {
      {"count", 1},
      {"indices", {{"bufferView", file.add_view<std::uint8_t>({1})}, {"componentType", 5121}}},
      {"values", {{"bufferView", file.add_view<float>({70, 80})}}}};
  EXPECT_THAT(read_floats<2>(*read(file), GltfSelection::all(3)),
              ElementsAre(ElementsAre(1, 2), ElementsAre(70, 80), ElementsAre(5, 6)));
  file.json["accessors"][0].erase("bufferView");
  EXPECT_THAT(read_floats<2>(*read(file), GltfSelection::all(3)),
              ElementsAre(ElementsAre(0, 0), ElementsAre(70, 80), ElementsAre(0, 0)));
}

TEST_F(GltfAccessorTest, refuses_sparse_values_outside_the_accessor) {
  GltfBuilder file = three_pairs();
  auto& sparse = file.json["accessors"][0]["sparse"];
  sparse = {{"count", 1},
            {"indices", {{"bufferView", file.add_view<std::uint8_t>({3})}, {"componentType", 5121}}},
            {"values", {{"bufferView", file.add_view<float>({70, 80})}}}};
  EXPECT_THAT(error(file), HasSubstr("/accessors/0/sparse/indices: index 3 of 3"));
  sparse["count"] = 4;
  EXPECT_THAT(error(file), HasSubstr("4 of 3 elements"));
  sparse["count"] = 2;
  EXPECT_THAT(error(file), HasSubstr("do not fit"));
  sparse["indices"]["componentType"] = 5126;
  EXPECT_THAT(error(file), HasSubstr("unsigned"));
  sparse.erase("values");
  EXPECT_THAT(error(file), HasSubstr("no indices or no values"));
}

TEST_F(GltfAccessorTest, nothing_outside_the_buffer_view_can_be_read) {
  const std::uint64_t huge = ~std::uint64_t{0};
  for (const auto& [count, offset, fits] :
       std::vector<std::tuple<std::uint64_t, std::uint64_t, bool>>{{3, 0, true},
                                                                   {4, 0, false},
                                                                   {2, 8, true},
                                                                   {3, 8, false},
                                                                   {1, 16, true},
                                                                   {1, 17, false},
                                                                   {0, 99, true},
                                                                   {1, huge, false},
                                                                   {1, huge - 7, false},
                                                                   {0xffffffff, 0, false},
                                                                   {huge, 0, false}}) {
    GltfBuilder file = three_pairs();
    file.json["accessors"][0]["count"] = count;
    file.json["accessors"][0]["byteOffset"] = offset;
    EXPECT_EQ(error(file) == "read", fits) << count << ' ' << offset;
  }
}

TEST_F(GltfAccessorTest, nothing_outside_the_buffer_can_be_viewed) {
  for (const auto& [key, value] :
       std::vector<std::pair<const char*, std::uint64_t>>{{"byteLength", 25},
                                                          {"byteLength", ~std::uint64_t{0}},
                                                          {"byteOffset", 1},
                                                          {"byteOffset", ~std::uint64_t{0}},
                                                          {"buffer", 1},
                                                          {"byteStride", 7},
                                                          {"byteStride", 0},
                                                          {"byteStride", ~std::uint64_t{0}}}) {
    GltfBuilder file = three_pairs();
    file.json["bufferViews"][0][key] = value;
    EXPECT_NE(error(file), "read") << key << ' ' << value;
  }
}

TEST_F(GltfAccessorTest, refuses_a_buffer_that_is_shorter_than_declared) {
  GltfBuilder file = three_pairs();
  file.json["buffers"] = {{{"byteLength", 29}}};
  EXPECT_THAT(error(file), HasSubstr("/buffers/0/byteLength: there are 24 of 29 bytes"));
  file.json["buffers"] = {{{"byteLength", 24}, {"uri", "data:;base64,AAAA"}}};
  EXPECT_THAT(error(file), HasSubstr("there are 3 of 24 bytes"));
  file.json["buffers"] = {{{"byteLength", 24}, {"uri", "elsewhere.bin"}}};
  EXPECT_THAT(error(file), HasSubstr("in memory"));
}

TEST_F(GltfAccessorTest, missing_and_unknown_properties_name_their_position) {
  for (const char* const key : {"componentType", "count", "type"}) {
    GltfBuilder file = three_pairs();
    file.json["accessors"][0].erase(key);
    EXPECT_THAT(error(file), HasSubstr(std::string("/accessors/0/") + key));
  }
  GltfBuilder file = three_pairs();
  file.json["accessors"][0]["type"] = "VEC5";
  EXPECT_THAT(error(file), HasSubstr("/accessors/0/type"));
  file = three_pairs();
  file.json["accessors"][0]["componentType"] = 5124;
  EXPECT_THAT(error(file), HasSubstr("5124 is no component type"));
}

TEST_F(GltfAccessorTest, zeros_without_data_count_towards_the_memory_limit) {
  GltfBuilder file = three_pairs();
  file.json["accessors"][0].erase("bufferView");
  file.json["accessors"][0]["count"] = 4'000'000'000;
  EXPECT_THAT(error(file), HasSubstr("no bufferView holds them"));
  file.json["accessors"][0]["count"] = 4'000'000;
  limits_.memory_bytes = std::size_t{16} << 20;
  EXPECT_THAT(error(file), HasSubstr("memory limit"));
}

}  // namespace
}  // namespace cyclorama::scene
