// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/node/node_config.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/base/file.h"

namespace cyclorama::node {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

Result<FarmNodeOptions> read(const std::string& text) {
  const std::filesystem::path path = std::filesystem::path(testing::TempDir()) / "node_config_test_node.toml";
  EXPECT_TRUE(write_file_atomically(path, text));
  return read_node_config(path);
}

TEST(NodeConfig, reads_every_key_and_leaves_the_rest_to_the_host) {
  const auto full = read(
      "coordinators = [\"[::1]:1\", \"[::1]:2\"]\nname = \"r7\"\nthreads = 3\nmemory_gib = 1.5\n"
      "cache = \"/c\"\ncache_gib = 0.5\ncompute_light = false\n");
  ASSERT_TRUE(full) << full.error().message();
  EXPECT_THAT(full->coordinators, ElementsAre("[::1]:1", "[::1]:2"));
  EXPECT_EQ(full->name, "r7");
  EXPECT_EQ(full->threads, 3);
  EXPECT_EQ(full->memory_limit_bytes, std::uint64_t{3} << 29);
  EXPECT_EQ(full->cache.folder, "/c");
  EXPECT_EQ(full->cache.limit_bytes, std::uint64_t{1} << 29);
  EXPECT_FALSE(full->computes_light);
  const auto short_one = read("coordinator = \"[::1]:1\"\n");
  ASSERT_TRUE(short_one) << short_one.error().message();
  EXPECT_THAT(short_one->coordinators, ElementsAre("[::1]:1"));
  EXPECT_EQ(short_one->memory_limit_bytes, 0u);
  EXPECT_TRUE(short_one->computes_light);
  EXPECT_EQ(short_one->cache.folder, "");
  const auto done = complete(*short_one);
  ASSERT_TRUE(done);
  EXPECT_NE(done->name, "");
  EXPECT_GE(done->threads, 1);
}

TEST(NodeConfig, names_the_nodes_certificate_or_none) {
  EXPECT_FALSE(read("coordinator = \"[::1]:1\"\n")->tls);
  const auto options = read("coordinator = \"[::1]:1\"\n[tls]\nauthority = \"a\"\ncertificate = \"c\"\nkey = \"/k\"\n");
  ASSERT_TRUE(options) << options.error().message();
  const std::filesystem::path folder(testing::TempDir());
  EXPECT_EQ(options->tls, (TlsFiles{folder / "a", folder / "c", "/k"}));
  EXPECT_FALSE(read("coordinator = \"[::1]:1\"\n[tls]\nauthority = \"a\"\n"));
}

TEST(NodeConfig, names_a_mistake_and_its_line) {
  const auto refusal_of = [](const std::string& text) {
    const auto options = read(text);
    return options ? std::string() : options.error().message();
  };
  EXPECT_THAT(refusal_of("coordinator = \"a:1\"\ncoordinators = [\"b:1\"]\n"), HasSubstr("beside 'coordinators'"));
  EXPECT_THAT(refusal_of("coordinator = \"a:1\"\nmemory_gib = 0.1\n"), HasSubstr("memory_gib"));
  EXPECT_THAT(refusal_of("coordinator = \"a:1\"\nmemory_mib = 100\n"), HasSubstr("memory_mib"));
  EXPECT_THAT(refusal_of("coordinators = 7\n"), HasSubstr("coordinators"));
  EXPECT_THAT(refusal_of("cache_gib = -1\n"), HasSubstr("cache_gib"));
  EXPECT_THAT(complete(*read("threads = 2\n")).error().message(), HasSubstr("no coordinator is given"));
}

}  // namespace
}  // namespace cyclorama::node
