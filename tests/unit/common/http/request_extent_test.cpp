// SPDX-License-Identifier: Apache-2.0
#include "common/http/request_extent.h"

#include <gtest/gtest.h>

#include <string>

namespace cyclorama {
namespace {

constexpr std::size_t kHead = 200;
constexpr std::size_t kBody = 10;

RequestExtent extent(const std::string& text) { return request_extent(text, kHead, kBody); }

TEST(RequestExtent, is_unknown_until_the_empty_line) {
  const std::string head = "GET / HTTP/1.1\r\nHost: x\r\n\r\n";
  for (std::size_t n = 0; n < head.size(); ++n) {
    EXPECT_EQ(extent(head.substr(0, n)).bytes, 0u) << n;
    EXPECT_EQ(extent(head.substr(0, n)).refusal, 0) << n;
  }
  EXPECT_EQ(extent(head).bytes, head.size());
  EXPECT_EQ(extent(head + "GET /next").bytes, head.size());
}

TEST(RequestExtent, contains_the_body) {
  const std::string head = "POST / HTTP/1.1\r\ncontent-LENGTH:\t 10 \r\n\r\n";
  EXPECT_EQ(extent(head).bytes, head.size() + 10);
  const std::string twice = "POST / HTTP/1.1\r\nContent-Length: 3\r\nContent-Length: 3\r\n\r\n";
  EXPECT_EQ(extent(twice).bytes, twice.size() + 3);
}

TEST(RequestExtent, leaves_out_a_body_that_is_too_long) {
  const std::string head = "POST / HTTP/1.1\r\nContent-Length: 11\r\n\r\n";
  EXPECT_EQ(extent(head).bytes, head.size());
  EXPECT_TRUE(extent(head).is_body_left_out);
  EXPECT_FALSE(extent("POST / HTTP/1.1\r\nContent-Length: 10\r\n\r\n").is_body_left_out);
}

TEST(RequestExtent, refuses_lengths_that_are_no_numbers_or_differ) {
  for (const char* const length : {"", "-1", "+1", "1x", "0x10", "1 2", "99999999999999999999999"}) {
    EXPECT_EQ(extent(std::string("POST / HTTP/1.1\r\nContent-Length: ") + length + "\r\n\r\n").refusal, 400) << length;
  }
  EXPECT_EQ(extent("POST / HTTP/1.1\r\nContent-Length: 1\r\nContent-Length: 2\r\n\r\n").refusal, 400);
}

TEST(RequestExtent, refuses_chunks_and_heads_that_are_too_long) {
  EXPECT_EQ(extent("POST / HTTP/1.1\r\nTransfer-Encoding: chunked\r\n\r\n").refusal, 411);
  const std::string start = "GET / HTTP/1.1\r\nX: ";
  EXPECT_EQ(extent(start + std::string(kHead - start.size() - 1, 'x')).refusal, 0);
  EXPECT_EQ(extent(start + std::string(kHead - start.size(), 'x')).refusal, 431);
  const std::string longest = start + std::string(kHead - start.size() - 4, 'x') + "\r\n\r\n";
  EXPECT_EQ(extent(longest).bytes, kHead);
  EXPECT_EQ(extent(start + std::string(kHead - start.size() - 3, 'x') + "\r\n\r\n").refusal, 431);
}

}  // namespace
}  // namespace cyclorama
