// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/coordinator/coordinator_config.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/base/file.h"

namespace cyclorama::coordinator {
namespace {

using testing::HasSubstr;

Result<CoordinatorOptions> read(const std::string& text) {
  const std::filesystem::path path = std::filesystem::path(testing::TempDir()) / "coordinator_config_test_farm.toml";
  EXPECT_TRUE(write_file_atomically(path, text));
  return read_coordinator_config(path);
}

constexpr const char* kGood = R"(museums = "[::1]:7401"
nodes = "[::1]:7402"
[[scene]]
name = "grotto"
path = "/srv/scenes/grotto"
[[scene]]
name = "relic"
path = "/srv/scenes/relic"
)";

TEST(CoordinatorConfig, reads_every_key_and_has_defaults) {
  const auto options = read(std::string(kGood) + "[limits]\nsessions = 3\n");
  ASSERT_TRUE(options) << options.error().message();
  EXPECT_EQ(options->museums, "[::1]:7401");
  EXPECT_EQ(options->inspect, "");
  ASSERT_EQ(options->scenes.size(), 2u);
  EXPECT_EQ(options->scenes[1].path, "/srv/scenes/relic");
  EXPECT_EQ(options->limits.sessions, 3u);
  EXPECT_EQ(options->limits.nodes, CoordinatorLimits{}.nodes);
  EXPECT_EQ(options->strategy, balance::BalanceStrategy::kCostMapStealing);
}

TEST(CoordinatorConfig, reads_which_scenes_are_distributed_and_how) {
  const auto plain = read(kGood);
  ASSERT_TRUE(plain);
  EXPECT_FALSE(plain->scenes[1].on_coordinator);
  EXPECT_EQ(plain->distribution.files.bytes_per_second, 0.0);
  const auto options = read(std::string(kGood) + "on = \"coordinator\"\n[distribution]\ndigests = \"/d\"\n" +
                            "limit_mbit_per_s = 80\nfiles = 2\n");
  ASSERT_TRUE(options) << options.error().message();
  EXPECT_FALSE(options->scenes[0].on_coordinator);
  EXPECT_TRUE(options->scenes[1].on_coordinator);
  EXPECT_EQ(options->distribution.digests, "/d");
  EXPECT_EQ(options->distribution.files.bytes_per_second, 1e7);
  EXPECT_EQ(options->distribution.files.streams, 2u);
  EXPECT_THAT(read(std::string(kGood) + "on = \"moon\"\n").error().message(), HasSubstr("coordinator"));
}

TEST(CoordinatorConfig, names_the_line_of_a_mistake) {
  EXPECT_THAT(read(std::string("colour = 3\n") + kGood).error().message(), HasSubstr("farm.toml:1"));
  EXPECT_THAT(read(std::string("balance = \"magic\"\n") + kGood).error().message(), HasSubstr("pbt"));
  EXPECT_THAT(read(std::string(kGood) + "[limits]\nsessions = 0\n").error().message(), HasSubstr("farm.toml:10"));
  EXPECT_FALSE(read("museums = 5\n"));
}

TEST(CoordinatorConfig, refuses_scenes_with_the_same_name) {
  EXPECT_THAT(read(std::string(kGood) + "[[scene]]\nname = \"grotto\"\npath = \"x\"\n").error().message(),
              HasSubstr("twice"));
  EXPECT_THAT(read("museums = \"[::]:1\"\nnodes = \"[::]:2\"\n").error().message(), HasSubstr("no scene"));
}

TEST(CoordinatorConfig, requires_tls_for_connections_from_other_machines) {
  const std::string scenes = "[[scene]]\nname = \"grotto\"\npath = \"x\"\n";
  const std::string open = "museums = \"[::]:7401\"\nnodes = \"[::1]:7402\"\n";
  EXPECT_THAT(read(open + scenes).error().message(), HasSubstr("cyclorama-authority"));
  EXPECT_THAT(read("museums = \"localhost:1\"\nnodes = \"10.0.0.1:2\"\n" + scenes).error().message(),
              HasSubstr("'10.0.0.1:2' can be reached"));
  EXPECT_TRUE(read(open + "insecure = true\n" + scenes));
  EXPECT_THAT(read(std::string("inspect = \"[::]:7406\"\n") + kGood).error().message(),
              HasSubstr("inspection address"));
  EXPECT_THAT(read(open + scenes + "[tls]\nauthority = \"a\"\ncertificate = \"c\"\n").error().message(),
              HasSubstr("key"));
  const auto safe = read(open + "museums_file = \"museums.toml\"\naudit = \"/var/log/audit\"\n" + scenes +
                         "[tls]\nauthority = \"a\"\ncertificate = \"c\"\nkey = \"/etc/k\"\nrevoked = \"r\"\n");
  ASSERT_TRUE(safe) << safe.error().message();
  const std::filesystem::path folder(testing::TempDir());
  EXPECT_EQ(safe->trust.tls, (TlsFiles{folder / "a", folder / "c", "/etc/k"}));
  EXPECT_EQ(safe->trust.revoked, folder / "r");
  EXPECT_EQ(safe->trust.museums, folder / "museums.toml");
  EXPECT_EQ(safe->trust.audit, "/var/log/audit");
}

TEST(FarmScene, has_a_name_and_a_path) {
  EXPECT_EQ(parse_farm_scene("a=/b=c")->path, "/b=c");
  for (const char* const bad : {"", "=", "a", "a=", "=b"}) EXPECT_FALSE(parse_farm_scene(bad)) << bad;
}

}  // namespace
}  // namespace cyclorama::coordinator
