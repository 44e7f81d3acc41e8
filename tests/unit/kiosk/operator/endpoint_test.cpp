// SPDX-License-Identifier: Apache-2.0
#include "kiosk/operator/endpoint.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "common/base/file.h"

namespace cyclorama::operations {
namespace {

using testing::HasSubstr;

std::filesystem::path file_with(const std::string& name, std::string_view text) {
  const std::filesystem::path path = std::filesystem::path(testing::TempDir()) / name;
  CHECK(write_file_atomically(path, text));
  return path;
}

TEST(Endpoints, are_given_by_options) {
  const auto endpoints = gather_endpoints({"tour=[::1]:7403", "simulated-room=host:1"}, std::nullopt);
  ASSERT_TRUE(endpoints);
  EXPECT_EQ((*endpoints)[0].name, "tour");
  EXPECT_EQ((*endpoints)[0].address, "[::1]:7403");
  EXPECT_EQ((*endpoints)[1].name, "simulated-room");
}

TEST(Endpoints, are_read_from_a_file_and_overridden_by_options) {
  const auto path = file_with("endpoints.toml",
                              "[[watch]]\nname = 'tour'\naddress = '[::1]:1'\n"
                              "[[watch]]\nname = 'display'\naddress = '[::1]:2'\n");
  const auto endpoints = gather_endpoints({"tour=[::1]:9"}, path);
  ASSERT_TRUE(endpoints) << endpoints.error().message();
  ASSERT_EQ(endpoints->size(), 2u);
  EXPECT_EQ((*endpoints)[0].address, "[::1]:9");
  EXPECT_EQ((*endpoints)[1].address, "[::1]:2");
}

TEST(Endpoints, are_refused_with_a_remedy) {
  for (const char* const text : {"", "tour", "=x", "tour=", "../x=[::1]:1", "a b=[::1]:1"}) {
    const auto endpoint = parse_endpoint(text);
    ASSERT_FALSE(endpoint) << text;
    EXPECT_THAT(endpoint.error().message(), HasSubstr("tour=[::1]:7403"));
  }
  EXPECT_FALSE(gather_endpoints({}, std::nullopt));
  EXPECT_FALSE(gather_endpoints({"a=[::1]:1", "a=[::1]:2"}, std::nullopt));
  EXPECT_FALSE(gather_endpoints(std::vector<std::string>(30, "a=[::1]:1"), std::nullopt));
  const auto twice =
      file_with("twice.toml", "[[watch]]\nname='a'\naddress='x:1'\n[[watch]]\nname='a'\naddress='x:2'\n");
  EXPECT_FALSE(gather_endpoints({}, twice));
  const auto wrong = gather_endpoints({}, file_with("wrong.toml", "[[watch]]\nname='a/b'\nadress='x:1'\n"));
  ASSERT_FALSE(wrong);
  EXPECT_THAT(wrong.error().message(), HasSubstr("wrong.toml:"));
}

}  // namespace
}  // namespace cyclorama::operations
