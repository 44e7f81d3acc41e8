// SPDX-License-Identifier: Apache-2.0
#include "common/http/http_server.h"

#include <gtest/gtest.h>
#include <httplib.h>

namespace cyclorama {
namespace {

TEST(HttpAddress, is_a_host_and_a_port) {
  const auto address = parse_http_address("[::1]:7404");
  ASSERT_TRUE(address);
  EXPECT_EQ(address->host, "::1");
  EXPECT_EQ(address->port, 7404);
  for (const char* const wrong : {"", "7404", "::1:7404", "[::1]", "[::1]:99999", "[::1]:x", ":80"}) {
    EXPECT_FALSE(parse_http_address(wrong)) << wrong;
  }
}

TEST(HttpAddress, knows_which_hosts_only_this_machine_reaches) {
  for (const char* const host : {"::1", "127.0.0.1", "127.9.8.7", "localhost"}) EXPECT_TRUE(is_loopback(host)) << host;
  for (const char* const host : {"::", "0.0.0.0", "127.example.org", "10.0.0.1", "", "::1%eth0", "farm"}) {
    EXPECT_FALSE(is_loopback(host)) << host;
  }
}

TEST(HttpServer, answers_errors_with_the_status_of_their_code) {
  const auto server = HttpServer::start("[::1]:0", {}, [](httplib::Server& routes) {
    routes.Get("/busy", [](const httplib::Request&, httplib::Response& response) {
      answer_error(Error(ErrorCode::kBusy, "four \xff watch"), response);
    });
  });
  ASSERT_TRUE(server);
  httplib::Client client("::1", (*server)->port());
  const auto busy = client.Get("/busy");
  ASSERT_TRUE(busy);
  EXPECT_EQ(busy->status, 429);
  EXPECT_NE(busy->body.find("four \uFFFD watch"), std::string::npos) << "always UTF-8: " << busy->body;
  EXPECT_EQ(client.Get("/nothing")->status, 404);
  EXPECT_EQ(client.Post("/busy", std::string(100'000, 'x'), "text/plain")->status, 413);
}

}  // namespace
}  // namespace cyclorama
