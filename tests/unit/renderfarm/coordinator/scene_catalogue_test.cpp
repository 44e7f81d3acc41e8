// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/coordinator/scene_catalogue.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/doubles/fake_scene.h"

namespace cyclorama::coordinator {
namespace {

using testing::HasSubstr;

wire::SceneLoaded loaded(const std::string& scene) {
  wire::SceneLoaded message;
  message.set_scene(scene);
  *message.mutable_description() = fake_scene(scene);
  return message;
}

class SceneCatalogueTest : public testing::Test {
 protected:
  SceneCatalogue catalogue{{{"cave", "/cave"}, {"hall", "/hall", true}}};
};

TEST_F(SceneCatalogueTest, finds_the_first_scene_of_a_grant_and_hides_the_others) {
  const trust::Grant hall_only{.museum = "m", .scenes = {"hall"}};
  EXPECT_EQ(catalogue.find("", {}, "m")->name, "cave");
  EXPECT_EQ(catalogue.find("", hall_only, "m")->name, "hall");
  EXPECT_THAT(catalogue.find("cave", hall_only, "m").error().message(), HasSubstr("no scene 'cave'"));
  EXPECT_EQ(catalogue.find("tomb", {}, "m").error().code(), ErrorCode::kNotFound);
  EXPECT_THAT(catalogue.find("", {.scenes = {"tomb"}}, "m").error().message(), HasSubstr("no scene for 'm'"));
  ASSERT_EQ(catalogue.list(hall_only).scenes_size(), 1);
  EXPECT_EQ(catalogue.list(hall_only).scenes(0).title(), "hall") << "no node has told its title";
}

TEST_F(SceneCatalogueTest, announces_a_scene_on_its_disk_once_its_files_were_read) {
  EXPECT_TRUE(catalogue.at("cave").is_ready());
  EXPECT_FALSE(catalogue.at("hall").is_ready());
  EXPECT_EQ(catalogue.set_digest("hall", "d").digest, "d");
  EXPECT_TRUE(catalogue.at("hall").is_ready());
}

TEST_F(SceneCatalogueTest, replaces_what_it_knew_of_a_scene) {
  EXPECT_EQ(catalogue.description("cave"), nullptr);
  wire::SceneLoaded message = loaded("cave");
  message.set_bounces(3);
  ASSERT_TRUE(catalogue.learn(message));
  EXPECT_EQ(catalogue.list({}).scenes(0).title(), fake_scene("cave").title());
  EXPECT_EQ(catalogue.governed(50.0, 64, "cave", false)->bounces, 3);
  ASSERT_TRUE(catalogue.learn(loaded("cave")));
  EXPECT_EQ(catalogue.governed(50.0, 64, "cave", false)->bounces, governor::kStandardBounces);
}

TEST_F(SceneCatalogueTest, refuses_what_no_scene_has) {
  wire::SceneLoaded message = loaded("cave");
  message.set_bounces(100'000);
  EXPECT_FALSE(catalogue.learn(message));
  message = loaded("cave");
  message.set_front("no = front");
  EXPECT_FALSE(catalogue.learn(message));
  message = loaded("cave");
  message.mutable_description()->clear_name();
  EXPECT_FALSE(catalogue.learn(message));
}

}  // namespace
}  // namespace cyclorama::coordinator
