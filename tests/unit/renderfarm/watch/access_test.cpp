// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/watch/access.h"

#include <gtest/gtest.h>

#include "common/base/file.h"
#include "renderfarm/watch/watch_options.h"

namespace cyclorama::watch {
namespace {

constexpr const char* kToken = "aladdin-opens-sesame";

TEST(Access, admits_by_bearer_or_by_the_operators_password) {
  const Access access(kToken);
  EXPECT_TRUE(access.admits("Bearer aladdin-opens-sesame", "farm:7404"));
  // echo -n operator:aladdin-opens-sesame | base64
  EXPECT_TRUE(access.admits("Basic b3BlcmF0b3I6YWxhZGRpbi1vcGVucy1zZXNhbWU=", "farm:7404"));
}

TEST(Access, admits_nobody_else) {
  const Access access(kToken);
  for (const char* const wrong : {"", "Bearer", "Bearer ", "Bearer aladdin-opens-sesam", "Bearer aladdin-opens-sesame ",
                                  "aladdin-opens-sesame", "Basic YWRtaW46YWxhZGRpbi1vcGVucy1zZXNhbWU=",
                                  "Basic b3BlcmF0b3I6", "Basic ====", "Bearer aladdin-opens-sesamf"}) {
    EXPECT_FALSE(access.admits(wrong, "localhost:7404")) << wrong;
  }
}

TEST(Access, without_a_token_only_this_machines_own_names_are_admitted) {
  const Access access;
  for (const char* const own : {"localhost:7404", "[::1]:7404", "127.0.0.1", "[::1]"}) {
    EXPECT_TRUE(access.admits("", own)) << own;
  }
  for (const char* const foreign : {"evil.example:7404", "evil.example", "", "[2001:db8::1]:7404"}) {
    EXPECT_FALSE(access.admits("", foreign)) << foreign;
  }
}

TEST(Access, reads_the_first_line_of_its_file) {
  const std::filesystem::path file = testing::TempDir() + "cyclorama-token-" + std::to_string(::getpid());
  ASSERT_TRUE(write_file_atomically(file, std::string_view("  aladdin-opens-sesame \nmore\n")));
  const auto access = Access::read(file);
  ASSERT_TRUE(access) << access.error().message();
  EXPECT_TRUE(access->admits("Bearer aladdin-opens-sesame", ""));
  for (const char* const bad : {"", "\n", "short\n", "has blanks in the middle\n", "umlaut-\xc3\xa4-in-the-middle\n"}) {
    ASSERT_TRUE(write_file_atomically(file, std::string_view(bad)));
    const auto refused = Access::read(file);
    ASSERT_FALSE(refused) << bad;
    EXPECT_EQ(refused.error().code(), ErrorCode::kBadData) << bad;
  }
  std::filesystem::remove(file);
  EXPECT_EQ(Access::read(file).error().code(), ErrorCode::kNotFound);
}

TEST(WatchOptions, require_a_token_if_others_can_connect) {
  const auto parsed = [](const char* text) {
    auto config = Config::parse(text, "farm.toml");
    CHECK(config);
    WatchOptions options = read_watch_options(config->root().table("watch"), "/etc/farm");
    CHECK(config->finish());
    return options;
  };
  EXPECT_TRUE(validate(parsed("[watch]\n")));
  EXPECT_EQ(parsed("[watch]\ntoken_file = 'token'\n").token_file, "/etc/farm/token");
  EXPECT_TRUE(validate(parsed("[watch]\nmetrics_file = '/run/farm.prom'\n")));
  EXPECT_TRUE(validate(parsed("[watch]\naddress = '[::1]:7404'\n")));
  EXPECT_TRUE(validate(parsed("[watch]\naddress = '[::]:7404'\ntoken_file = '/etc/token'\n")));
  for (const char* const open : {"[watch]\naddress = '[::]:7404'\n", "[watch]\naddress = 'farm.example:7404'\n",
                                 "[watch]\naddress = '7404'\n"}) {
    const Status refused = validate(parsed(open));
    ASSERT_FALSE(refused) << open;
    EXPECT_EQ(refused.error().code(), ErrorCode::kInvalidArgument);
  }
}

}  // namespace
}  // namespace cyclorama::watch
