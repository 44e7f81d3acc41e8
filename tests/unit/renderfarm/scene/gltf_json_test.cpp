// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene/gltf_json.h"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

namespace cyclorama::scene {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

GltfObject object(const json& value) { return *GltfObject::from(value, "/things/3"); }

TEST(GltfJson, an_absent_key_is_empty_and_not_an_error) {
  const json empty = json::object();
  EXPECT_FALSE(object(empty).number("a")->has_value());
  EXPECT_FALSE(object(empty).integer("a")->has_value());
  EXPECT_FALSE(object(empty).flag("a")->has_value());
  EXPECT_FALSE(object(empty).text("a")->has_value());
  EXPECT_FALSE(object(empty).object("a")->has_value());
  EXPECT_FALSE(object(empty).numbers<3>("a")->has_value());
  EXPECT_EQ(object(empty).array("a")->size(), 0u);
  EXPECT_EQ(object(empty).name(), "");
}

TEST(GltfJson, whole_numbers_may_be_written_as_floats) {
  const json value = {{"a", 3.0}, {"b", 3.5}, {"c", -1}, {"d", 1e300}, {"e", 9007199254740992.0}, {"f", "3"}};
  EXPECT_EQ(**object(value).integer("a"), 3u);
  EXPECT_FALSE(object(value).integer("b").has_value());
  EXPECT_FALSE(object(value).integer("c").has_value());
  EXPECT_FALSE(object(value).integer("d").has_value());
  EXPECT_EQ(**object(value).integer("e"), std::uint64_t{1} << 53);
  EXPECT_FALSE(object(value).integer("f").has_value());
}

TEST(GltfJson, a_wrong_type_names_the_position_and_the_remedy) {
  const json value = {{"a", "text"}, {"b", {1, 2}}};
  EXPECT_THAT(object(value).number("a").error().message(), HasSubstr("/things/3/a: a number is needed"));
  EXPECT_THAT(object(value).flag("a").error().message(), HasSubstr("export it again"));
  EXPECT_THAT(object(value).text("b").error().message(), HasSubstr("/things/3/b"));
  EXPECT_THAT(object(value).object("a").error().message(), HasSubstr("/things/3/a"));
  EXPECT_THAT(object(value).array("a").error().message(), HasSubstr("/things/3/a"));
  EXPECT_THAT(object(value).numbers<3>("b").error().message(), HasSubstr("3 numbers"));
  EXPECT_THAT(object(value).required_integer("c").error().message(), HasSubstr("/things/3/c: is missing"));
  EXPECT_THAT(object(value).array("b")->object(1).error().message(), HasSubstr("/things/3/b/1"));
  EXPECT_THAT(object(value).array("b")->text(1).error().message(), HasSubstr("/things/3/b/1"));
}

TEST(GltfJson, positions_are_escaped_as_json_pointers) {
  const json value = {{"a/b~c", "text"}};
  EXPECT_THAT(object(value).number("a/b~c").error().message(), HasSubstr("/things/3/a~1b~0c"));
}

TEST(GltfJson, a_name_that_is_not_text_is_ignored) {
  const json value = {{"name", 7}};
  EXPECT_EQ(object(value).name(), "");
}

TEST(GltfJson, extensions_are_found_by_name) {
  const json value = {{"extensions", {{"KHR_x", {{"a", 1}}}}}};
  const auto found = object(value).extension("KHR_x");
  ASSERT_TRUE(found.has_value() && found->has_value());
  EXPECT_EQ((*found)->place(), "/things/3/extensions/KHR_x");
  EXPECT_FALSE(object(value).extension("KHR_y")->has_value());
}

}  // namespace
}  // namespace cyclorama::scene
