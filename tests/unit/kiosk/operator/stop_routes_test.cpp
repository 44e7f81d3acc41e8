// SPDX-License-Identifier: Apache-2.0
#include "kiosk/operator/stop_routes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <httplib.h>

#include <nlohmann/json.hpp>

#include "kiosk/operator/page_server.h"
#include "tests/doubles/fake_process.h"

namespace cyclorama::operations {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using Json = nlohmann::json;

TEST(StopRoutes, list_the_stops_and_lead_to_them) {
  FakeProcess tour("tour");
  auto links = make_links({{"tour", tour.address()}});
  ASSERT_TRUE(links);
  Watch watch(*std::move(links));
  PageExtras extras;
  extras.tour = tour.address();
  const auto page = PageServer::start("[::1]:0", &watch, extras);
  ASSERT_TRUE(page) << page.error().message();
  httplib::Client client("::1", (*page)->port());
  const auto post = [&](const char* body) {
    auto answer = client.Post("/stops", body, "application/json");
    CHECK(answer);
    return *answer;
  };

  const Json list = Json::parse(client.Get("/stops")->body);
  EXPECT_EQ(list["title"], "A tour");
  EXPECT_EQ(list["at"], 0);
  EXPECT_EQ(list["stops"][0]["title"], "Brunnen") << "in the tour's first language";
  EXPECT_EQ(Json::parse(post("{\"do\": \"next\"}").body)["name"], "well");
  post("{\"do\": \"previous\"}");
  post("{\"do\": \"go\", \"name\": \"well\"}");
  EXPECT_EQ(post("{\"do\": \"undo\"}").status, 204);
  const auto refused = post("{\"do\": \"go\", \"name\": \"cellar\"}");
  EXPECT_EQ(refused.status, 404);
  EXPECT_THAT(refused.body, HasSubstr("no stop has this name"));
  EXPECT_THAT(tour.gone_to(), ElementsAre("+1", "-1", "well", "cellar"));
}

TEST(StopRoutes, refuse_other_bodies) {
  for (const char* const body :
       {"", "{}", "[]", "{\"do\": 1}", "{\"do\": \"jump\"}", "{\"do\": \"go\"}", "{\"do\": \"go\", \"name\": 3}",
        "{\"do\": \"captions\"}", "{\"do\": \"captions\", \"languages\": [1]}"}) {
    EXPECT_FALSE(parse_stop_order(body)) << body;
  }
  const auto added = parse_stop_order("{\"do\": \"stop-here\"}");
  ASSERT_TRUE(added);
  EXPECT_EQ(added->kind, StopOrder::Kind::kAdd);
  const auto captions = parse_stop_order("{\"do\": \"captions\", \"languages\": [\"de\", \"zh-Hant\"]}");
  ASSERT_TRUE(captions);
  EXPECT_EQ(captions->kind, StopOrder::Kind::kCaptions);
  EXPECT_THAT(captions->captions.languages(), ElementsAre("de", "zh-Hant"));
}

}  // namespace
}  // namespace cyclorama::operations
