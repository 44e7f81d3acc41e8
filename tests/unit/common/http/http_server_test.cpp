// SPDX-License-Identifier: Apache-2.0
#include "common/http/http_server.h"

#include <gtest/gtest.h>
#include <httplib.h>

namespace cyclorama {
namespace {

TEST(HttpServer, maps_error_codes_to_http_status) {
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
