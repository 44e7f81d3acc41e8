// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene_distribution/scene_files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "renderfarm/scene_distribution/sha256.h"

namespace cyclorama::scene_distribution {
namespace {

using testing::HasSubstr;

const std::string kA(64, 'a');
const std::string kB(64, 'b');

std::string refusal_of(const SceneFiles& files) {
  const Status fine = validate(files);
  return fine ? "" : fine.error().message();
}

TEST(Sha256, agrees_with_the_standards_examples) {
  // The example of FIPS 180-4, and the empty text.
  EXPECT_EQ(sha256_of("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(sha256_of(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_TRUE(is_sha256(kA));
  for (const std::string& bad : {std::string(), std::string(63, 'a'), std::string(65, 'a'), std::string(64, 'A'),
                                 std::string(64, 'g'), std::string(63, 'a') + "/"}) {
    EXPECT_FALSE(is_sha256(bad)) << bad;
  }
}

TEST(SceneFiles, have_a_digest_that_depends_on_every_field) {
  const SceneFiles files{{"a.ply", 3, kA}, {"scene.toml", 5, kB}};
  EXPECT_EQ(text_of(files), "cyclorama scene files 1\n" + kA + " 3 a.ply\n" + kB + " 5 scene.toml\n");
  EXPECT_EQ(digest_of(files), sha256_of(text_of(files)));
  EXPECT_EQ(bytes_of(files), 8u);
  for (const SceneFiles& other :
       {SceneFiles{{"b.ply", 3, kA}, {"scene.toml", 5, kB}}, SceneFiles{{"a.ply", 4, kA}, {"scene.toml", 5, kB}},
        SceneFiles{{"a.ply", 3, kB}, {"scene.toml", 5, kB}}, SceneFiles{{"a.ply", 3, kA}}}) {
    EXPECT_NE(digest_of(files), digest_of(other));
  }
}

TEST(SceneFiles, survive_the_wire_in_any_order) {
  const SceneFiles files{{"a/b.ply", 3, kA}, {"scene.toml", 5, kB}, {"z.ply", 3, kA}};
  wire::SceneFiles message = to_wire(files);
  message.mutable_files()->SwapElements(0, 2);
  const auto back = from_wire(message, digest_of(files));
  ASSERT_TRUE(back) << back.error().message();
  EXPECT_EQ(*back, files);
  message.mutable_files(0)->set_bytes(4);
  message.mutable_files(2)->set_bytes(4);
  EXPECT_FALSE(from_wire(message, digest_of(files)));
}

TEST(SceneFiles, refuse_harmful_or_ambiguous_lists) {
  EXPECT_THAT(refusal_of({}), HasSubstr("no files"));
  EXPECT_THAT(refusal_of({{"a", 1, "no digest"}}), HasSubstr("no SHA-256"));
  EXPECT_THAT(refusal_of({{"a", 1, kA}, {"b", 2, kA}}), HasSubstr("another size"));
  EXPECT_THAT(refusal_of({{"b", 1, kA}, {"a", 1, kA}}), HasSubstr("in order"));
  EXPECT_THAT(refusal_of({{"a", 1, kA}, {"a", 1, kA}}), HasSubstr("come twice"));
  EXPECT_THAT(refusal_of({{"WALL.ply", 1, kA}, {"wall.ply", 1, kA}}), HasSubstr("case of its letters"));
  EXPECT_THAT(refusal_of({{"a", 1, kA}, {"a/b", 1, kA}}), HasSubstr("both a file and a folder"));
  EXPECT_THAT(refusal_of({{"A", 1, kA}, {"a/b", 1, kA}}), HasSubstr("both a file and a folder"));
  EXPECT_THAT(refusal_of({{"a", kMaxSceneBytes, kA}, {"b", 1, kB}}), HasSubstr("more than 1024 GiB"));
  EXPECT_THAT(refusal_of({{"a", ~std::uint64_t{0}, kA}, {"b", ~std::uint64_t{0}, kB}}), HasSubstr("GiB"));
  SceneFiles many;
  for (std::size_t i = 0; i <= kMaxSceneFiles; ++i) many.push_back({"f" + std::to_string(100'000 + i), 1, kA});
  EXPECT_THAT(refusal_of(many), HasSubstr("at most 10000"));
  many.pop_back();
  EXPECT_EQ(refusal_of(many), "");
}

TEST(SceneFiles, have_paths_that_stay_inside_and_mean_the_same_on_every_system) {
  for (const char* good : {"a", "scene.toml", "a/b/c.png", "Grüße/ä.ply", "a b", "x..y", "a.", "-rf", "a\\b"}) {
    EXPECT_TRUE(check_scene_path(good)) << good;
  }
  const std::string deep = "1/2/3/4/5/6/7/8/9/10/11/12/13/14/15/16";
  EXPECT_TRUE(check_scene_path(deep));
  for (const std::string& bad :
       {std::string(), std::string("/a"), std::string("a/"), std::string("a//b"), std::string("."), std::string(".."),
        std::string("a/../b"), std::string("../a"), std::string("./a"), std::string(".hidden"), std::string("a/.git/b"),
        std::string("a\nb"), std::string("a\0b", 3), std::string("a\x7f"), std::string("a\xff"), std::string(256, 'x'),
        std::string("Gr\xfcn"), deep + "/17"}) {
    EXPECT_FALSE(check_scene_path(bad)) << bad;
  }
  std::string longest = std::string(255, 'x') + "/" + std::string(255, 'x') + "/" + std::string(255, 'x') + "/";
  EXPECT_TRUE(check_scene_path(longest + std::string(255, 'x')));
  EXPECT_FALSE(check_scene_path(longest + "y/" + std::string(255, 'x')));
}

}  // namespace
}  // namespace cyclorama::scene_distribution
