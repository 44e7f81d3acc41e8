// SPDX-License-Identifier: Apache-2.0
/// Tests of the page over real HTTP, with processes that only report their state.
#include "kiosk/operator/page_server.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <httplib.h>

#include <functional>
#include <nlohmann/json.hpp>
#include <optional>

#include "kiosk/operator/page_files.h"
#include "tests/doubles/fake_process.h"

namespace cyclorama::operations {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using testing::Not;
using Json = nlohmann::json;

struct Operator {
  FakeProcess tour{"tour"};
  std::optional<FakeProcess> display{std::in_place, "display"};
  std::unique_ptr<Watch> watch;
  std::unique_ptr<PageServer> page;
  std::optional<httplib::Client> client;

  Operator() {
    const std::string display_address = display->address();
    auto links = make_links({{"tour", tour.address()}, {"display", display_address}});
    CHECK(links);
    watch = std::make_unique<Watch>(*std::move(links));
    auto started = PageServer::start("[::1]:0", watch.get());
    CHECK(started);
    page = *std::move(started);
    client.emplace("::1", page->port());
  }
  Json status() { return Json::parse(client->Get("/status")->body); }
  bool eventually(const std::function<bool()>& condition) {
    const TimePoint end = SteadyClock().now() + 20s;
    while (!condition()) {
      if (SteadyClock().now() > end) return false;
    }
    return true;
  }
};

TEST(PageServer, serves_the_page_and_everything_to_which_it_refers) {
  Operator op;
  EXPECT_EQ(page_files().size(), 17u);
  for (const PageFile& file : page_files()) {
    const auto answer = op.client->Get(std::string(file.path).c_str());
    ASSERT_TRUE(answer);
    EXPECT_EQ(answer->status, 200);
    EXPECT_EQ(answer->body, file.content);
    EXPECT_EQ(answer->get_header_value("Content-Type"), file.type);
    EXPECT_THAT(answer->get_header_value("Content-Security-Policy"), HasSubstr("default-src 'none'"));
  }
  const std::string page(page_files().front().content);
  EXPECT_THAT(page, HasSubstr("href=\"page.css\""));
  EXPECT_THAT(page, Not(HasSubstr("http://")));
  EXPECT_THAT(page, Not(HasSubstr("https://"))) << "no resource from elsewhere";
}

TEST(PageServer, reports_the_state_of_every_part) {
  Operator op;
  op.tour.inspection.set_gauge("frames_per_second", 20.5);
  op.tour.inspection.set_fact("title", "A plain room");
  op.tour.inspection.add_stage_time("draw", 4ms);
  op.tour.inspection.add_stage_time("capture", 12ms);
  ASSERT_TRUE(op.eventually([&] { return op.status()["flow"].size() == 2 && op.status()["well"] == true; }));
  const Json status = op.status();
  EXPECT_EQ(status["flow"][0]["name"], "capture") << "in the order of a frame's way";
  EXPECT_EQ(status["processes"][0]["gauges"]["frames_per_second"], 20.5);
  EXPECT_EQ(status["processes"][0]["facts"]["title"], "A plain room");
  EXPECT_EQ(status["processes"][1]["state"], "All is well with display.");
}

TEST(PageServer, survives_a_process_that_goes_away_and_comes_back) {
  Operator op;
  op.display->inspection.set_gauge("heads", 3);
  ASSERT_TRUE(op.eventually([&] { return op.status()["processes"][1]["gauges"].contains("heads"); }));
  const int port = op.display->port();
  op.display.reset();
  ASSERT_TRUE(op.eventually([&] { return op.status()["processes"][1]["away"] == true; }));
  const Json away = op.status();
  EXPECT_THAT(away["processes"][1]["state"].get<std::string>(), HasSubstr("systemctl status cyclorama-display"));
  EXPECT_EQ(away["well"], false);
  EXPECT_EQ(op.client->Get("/picture/display/panorama.jpg")->status, 502);
  op.display.emplace("display", port);
  EXPECT_TRUE(op.eventually([&] { return op.status()["well"] == true; }));
}

TEST(PageServer, serves_pictures_whose_names_contain_a_slash) {
  Operator op;
  EXPECT_EQ(op.client->Get("/picture/display/projector%2Fleft.jpg")->status, 404);
  op.display->inspection.set_picture("projector/left", ramp_picture(0));
  for (const char* const path : {"/picture/display/projector%2Fleft.jpg", "/picture/display/projector/left.jpg"}) {
    const auto answer = op.client->Get(path);
    ASSERT_TRUE(answer);
    EXPECT_EQ(answer->status, 200) << path;
    EXPECT_EQ(answer->get_header_value("Content-Type"), "image/jpeg");
    EXPECT_EQ(answer->body.substr(0, 2), "\xff\xd8");
  }
  EXPECT_EQ(op.client->Get("/picture/nobody/wall.jpg")->status, 404);
  EXPECT_EQ(op.client->Get("/picture/display/%00%ff.jpg")->status / 100, 4);
}

TEST(PageServer, steers_the_tour) {
  Operator op;
  const auto answer = op.client->Post("/steer", R"({"forward": 0.5, "turn": -1})", "application/json");
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->status, 204);
  ASSERT_EQ(op.tour.steered().size(), 1u);
  EXPECT_EQ(op.tour.steered()[0].forward(), 0.5);
  EXPECT_EQ(op.tour.steered()[0].turn(), -1.0);
}

TEST(PageServer, refuses_to_steer_for_a_foreign_page_or_out_of_range) {
  Operator op;
  EXPECT_EQ(op.client->Post("/steer", R"({"forward": 1})", "text/plain")->status, 415);
  EXPECT_EQ(op.client->Post("/steer", R"({"forward": 1.5})", "application/json")->status, 400);
  EXPECT_EQ(op.client->Post("/steer", std::string(100'000, '['), "application/json")->status, 413);
  EXPECT_EQ(op.client->Get("/steer")->status, 404);
  EXPECT_TRUE(op.tour.steered().empty());
}

TEST(PageServer, offers_metrics) {
  Operator op;
  ASSERT_TRUE(op.eventually([&] { return op.status()["well"] == true; }));
  const auto answer = op.client->Get("/metrics");
  ASSERT_TRUE(answer);
  EXPECT_THAT(answer->body, HasSubstr("cyclorama_up{process=\"tour\"} 1\n"));
}

TEST(PageServer, reports_a_missing_page_in_plain_words) {
  Operator op;
  const auto answer = op.client->Get("/nothing");
  EXPECT_EQ(answer->status, 404);
  EXPECT_EQ(Json::parse(answer->body)["error"], "there is no page '/nothing'");
}

TEST(PageServer, refuses_an_invalid_or_used_address) {
  Operator op;
  for (const char* const address : {"", "8080", "::1:8080", "[::1]", "[::1]:99999", "[::1]:x", ":80"}) {
    const auto page = PageServer::start(address, op.watch.get());
    ASSERT_FALSE(page) << address;
    EXPECT_EQ(page.error().code(), ErrorCode::kInvalidArgument) << address;
  }
  FakeProcess other("other");
  const auto taken = PageServer::start(other.address(), op.watch.get());
  ASSERT_FALSE(taken);
  EXPECT_EQ(taken.error().code(), ErrorCode::kBusy);
}

TEST(PageServer, refuses_a_port_where_another_operator_listens) {
  Operator op;
  const auto second = PageServer::start(fmt::format("[::1]:{}", op.page->port()), op.watch.get());
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().code(), ErrorCode::kBusy);
}

}  // namespace
}  // namespace cyclorama::operations
