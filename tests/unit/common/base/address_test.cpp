// SPDX-License-Identifier: Apache-2.0
#include "common/base/address.h"

#include <gtest/gtest.h>

namespace cyclorama {
namespace {

TEST(Address, has_a_host_and_a_port) {
  const auto address = parse_address("[2001:db8::1]:7404");
  ASSERT_TRUE(address);
  EXPECT_EQ(address->host, "2001:db8::1");
  EXPECT_EQ(address->port, 7404);
  ASSERT_TRUE(parse_address("farm.example.org:0"));
  for (const char* const wrong :
       {"", "7404", "::1:7404", "[::1]", "[::1]:99999", "[::1]:-1", "[::1]:x", ":80", "[]:1"}) {
    const auto refused = parse_address(wrong);
    ASSERT_FALSE(refused) << wrong;
    EXPECT_EQ(refused.error().code(), ErrorCode::kInvalidArgument) << wrong;
  }
}

TEST(Address, is_local_only_if_no_other_machine_can_connect_to_it) {
  for (const char* const near : {"[::1]:1", "127.0.0.1:1", "127.9.8.7:1", "localhost:1", "unix:/run/farm.sock"}) {
    EXPECT_TRUE(is_loopback(near)) << near;
  }
  for (const char* const far :
       {"[::]:1", "0.0.0.0:1", "127.example.org:1", "10.0.0.1:1", "[::1]", "farm:1", "unix:x", ""}) {
    EXPECT_FALSE(is_loopback(far)) << far;
  }
}

}  // namespace
}  // namespace cyclorama
