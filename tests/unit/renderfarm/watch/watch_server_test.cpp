// SPDX-License-Identifier: Apache-2.0
/// The farm's page over real HTTP, with a simulated farm.
#include "renderfarm/watch/farm_watch.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <thread>

#include "common/base/file.h"
#include "renderfarm/watch/farm_tables.h"
#include "renderfarm/watch/watch_page.h"
#include "tests/data_sets/jpeg_tiles.h"
#include "tests/doubles/fake_process.h"
#include "tests/support/prometheus_text.h"

#include <httplib.h>  // Last, because it defines the resolver's macro _res, which conflicts with Eigen.

namespace cyclorama::watch {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using testing::Not;

struct Farm {
  std::filesystem::path folder = testing::TempDir() + "cyclorama-watch-" + std::to_string(::getpid());
  InspectionService inspection{"coordinator"};
  FarmWatch watch{inspection};
  std::optional<httplib::Client> client;

  explicit Farm(bool token = false) {
    std::filesystem::create_directories(folder);
    WatchOptions options{"[::1]:0", "", folder / "farm.prom"};
    if (token) {
      options.token_file = folder / "token";
      CHECK(write_file_atomically(options.token_file, std::string_view("aladdin-opens-sesame\n")));
    }
    const Status started = watch.start(options, [](const std::string&) {});
    CHECK(started);
    client.emplace("::1", watch.port());
    client->set_read_timeout(20);
    FarmOverview farm;
    farm.sessions = {{4, "Hall 3", "grotto"}};
    inspection.set_table(sessions_table(farm));
    inspection.set_state("1 sessions on 1 nodes", true);
    wire::SessionReply opened;
    opened.mutable_opened()->set_name("grotto");
    watch.pictures()->taken(4, std::move(opened));
  }
  ~Farm() {
    watch.stop();
    std::filesystem::remove_all(folder);
  }
  void show(int shift) {
    const auto picture = ramp_picture(shift);
    wire::SessionReply begin;
    begin.mutable_begin()->mutable_panorama()->set_width_px(64);
    begin.mutable_begin()->mutable_panorama()->set_height_px(32);
    watch.pictures()->taken(4, std::move(begin));
    for (wire::Tile& tile : tiles_of(1, *picture)) {
      wire::SessionReply reply;
      *reply.mutable_tile() = std::move(tile);
      watch.pictures()->taken(4, std::move(reply));
    }
    wire::SessionReply end;
    *end.mutable_end() = end_of(1, 1);
    watch.pictures()->taken(4, std::move(end));
  }
  /// Returns what is received until there are `count` pictures.
  std::string stream(int count) {
    std::string bytes;
    client->Get("/sessions/4.mjpeg", [&](const char* data, std::size_t length) {
      bytes.append(data, length);
      std::size_t parts = 0;
      for (std::size_t at = 0; (at = bytes.find("Content-Length", at)) != std::string::npos; ++at) ++parts;
      if (parts < static_cast<std::size_t>(count)) show(static_cast<int>(parts));
      return !(parts >= static_cast<std::size_t>(count) && bytes.ends_with("--cyclorama-picture\r\n"));
    });
    return bytes;
  }
};

TEST(WatchServer, serves_the_page_with_everything_to_which_it_refers_and_nothing_from_elsewhere) {
  Farm farm;
  EXPECT_EQ(watch_page_files().size(), 5u);
  for (const PageFile& file : watch_page_files()) {
    const auto answer = farm.client->Get(std::string(file.path).c_str());
    ASSERT_TRUE(answer);
    EXPECT_EQ(answer->status, 200);
    EXPECT_EQ(answer->body, file.content);
    EXPECT_THAT(answer->get_header_value("Content-Security-Policy"), HasSubstr("default-src 'none'"));
    if (file.path != "/icon.svg") {
      EXPECT_THAT(std::string(file.content), Not(testing::ContainsRegex("(src|href)=\"?https?:")));
    }
  }
}

TEST(WatchServer, reports_state_sessions_and_metrics) {
  Farm farm;
  EXPECT_EQ(nlohmann::json::parse(farm.client->Get("/sessions")->body)[0]["museum"], "Hall 3");
  EXPECT_EQ(nlohmann::json::parse(farm.client->Get("/status")->body)["state"], "1 sessions on 1 nodes");
  const auto metrics = farm.client->Get("/metrics");
  EXPECT_THAT(metrics->get_header_value("Content-Type"), HasSubstr("version=0.0.4"));
  EXPECT_TRUE(samples_of(metrics->body).contains("cyclorama_nodes"));
  EXPECT_EQ(farm.client->Get("/health")->status, 200);
  farm.inspection.set_state("no node is connected", false);
  EXPECT_EQ(farm.client->Get("/health")->status, 503);
  EXPECT_EQ(farm.client->Get("/nothing")->status, 404);
  EXPECT_EQ(farm.client->Post("/status", "", "text/plain")->status, 404);
}

TEST(WatchServer, admits_only_the_token) {
  Farm farm(true);
  for (const char* const path :
       {"/", "/status", "/sessions", "/metrics", "/sessions/4.jpg", "/sessions/4.mjpeg", "/nothing"}) {
    const auto refused = farm.client->Get(path);
    ASSERT_TRUE(refused) << path;
    EXPECT_EQ(refused->status, 401) << path;
    EXPECT_THAT(refused->get_header_value("WWW-Authenticate"), HasSubstr("Basic")) << path;
    EXPECT_THAT(refused->body, Not(HasSubstr("Hall 3")));
  }
  EXPECT_EQ(farm.client->Get("/health")->status, 200);
  EXPECT_EQ(farm.client->Get("/status", {{"Authorization", "Bearer aladdin-opens-sesamE"}})->status, 401);
  EXPECT_EQ(farm.client->Get("/status", {{"Authorization", "Bearer aladdin-opens-sesame"}})->status, 200);
  farm.client->set_basic_auth("operator", "aladdin-opens-sesame");
  EXPECT_EQ(farm.client->Get("/")->status, 200);
}

TEST(WatchServer, without_a_token_refuses_requests_by_another_host_name) {
  Farm farm;
  EXPECT_EQ(farm.client->Get("/status", {{"Host", "evil.example"}})->status, 403);
}

TEST(WatchServer, shows_the_newest_picture_of_a_session) {
  Farm farm;
  EXPECT_EQ(farm.client->Get("/sessions/4.jpg")->status, 404) << "none yet";
  farm.show(0);
  const auto whole = farm.client->Get("/sessions/4.jpg");
  const auto half = farm.client->Get("/sessions/4.jpg?half");
  JpegDecoder decoder;
  EXPECT_EQ(decoder.size_of(std::as_bytes(std::span(whole->body)))->width, 64);
  EXPECT_EQ(decoder.size_of(std::as_bytes(std::span(half->body)))->width, 32);
  EXPECT_EQ(farm.client->Get("/sessions/5.jpg")->status, 404);
  EXPECT_EQ(farm.client->Get("/sessions/5.mjpeg")->status, 404);
  EXPECT_EQ(farm.client->Get("/sessions/99999999999999999999.jpg")->status, 404);
}

TEST(WatchServer, streams_a_sessions_pictures_one_after_the_other) {
  Farm farm;
  farm.show(0);
  const std::string bytes = farm.stream(3);
  EXPECT_TRUE(bytes.starts_with("--cyclorama-picture\r\nContent-Type: image/jpeg\r\n"));
  std::vector<RgbImage> pictures;
  for (std::size_t at = bytes.find("\r\n\r\n"); at != std::string::npos; at = bytes.find("\r\n\r\n", at)) {
    const std::size_t begin = at += 4;
    const std::size_t end = bytes.find("\r\n--cyclorama-picture", begin);
    ASSERT_NE(end, std::string::npos);
    const auto picture = JpegDecoder().decode(std::as_bytes(std::span(bytes).subspan(begin, end - begin)), 1 << 20);
    ASSERT_TRUE(picture) << picture.error().message();
    pictures.push_back(*picture);
    at = end;
  }
  ASSERT_EQ(pictures.size(), 3u);
  EXPECT_NE(pictures[0], pictures[1]);
}

TEST(WatchServer, ends_the_stream_with_the_session_and_limits_the_watchers) {
  Farm farm;
  std::vector<std::thread> watchers;
  std::atomic<int> began = 0;
  for (int i = 0; i < WatchServer::kMaxWatchers; ++i) {
    watchers.emplace_back([&] {
      httplib::Client client("::1", farm.watch.port());
      client.set_read_timeout(20);
      bool first = true;
      client.Get("/sessions/4.mjpeg", [&](const char*, std::size_t) {
        began += std::exchange(first, false);
        return true;
      });
    });
  }
  while (began < WatchServer::kMaxWatchers) std::this_thread::yield();
  EXPECT_EQ(farm.client->Get("/sessions/4.mjpeg")->status, 429);
  EXPECT_EQ(farm.client->Get("/status")->status, 200) << "watchers take no one else's place";
  farm.watch.pictures()->session_ended(4);
  for (std::thread& watcher : watchers) watcher.join();
  EXPECT_EQ(farm.client->Get("/sessions/4.mjpeg")->status, 404);
}

TEST(FarmWatch, writes_the_metrics_into_a_file_and_removes_it_at_the_end) {
  std::filesystem::path file;
  {
    Farm farm;
    file = farm.folder / "farm.prom";
    const auto text = read_text_file(file, 1 << 20);
    ASSERT_TRUE(text);
    EXPECT_TRUE(samples_of(*text).contains("cyclorama_nodes"));
    farm.watch.stop();
    EXPECT_FALSE(std::filesystem::exists(file));
  }
}

TEST(MetricsFile, is_written_again_each_period) {
  const std::filesystem::path file = testing::TempDir() + "cyclorama-metrics-" + std::to_string(::getpid());
  FarmMetrics metrics;
  const auto started = MetricsFile::start(
      file, metrics, [](const std::string&) {}, 1ms);
  ASSERT_TRUE(started);
  metrics.node_sent_away();
  const TimePoint end = SteadyClock().now() + 20s;
  const auto told = [&] {
    const auto text = read_text_file(file, 1 << 20);
    return text && samples_of(*text).at("cyclorama_nodes_sent_away_total") == 1.0;
  };
  while (!told() && SteadyClock().now() < end) std::this_thread::yield();
  EXPECT_TRUE(told());
  EXPECT_FALSE(MetricsFile::start("/nowhere/farm.prom", metrics, [](const std::string&) {}));
}

TEST(FarmWatch, without_options_nothing_listens_and_no_picture_is_kept) {
  InspectionService inspection("coordinator");
  FarmWatch watch(inspection);
  ASSERT_TRUE(watch.start({}, [](const std::string&) {}));
  EXPECT_EQ(watch.port(), 0);
  EXPECT_EQ(watch.pictures(), nullptr);
  EXPECT_FALSE(FarmWatch(inspection).start({"[::]:0", "", ""}, [](const std::string&) {}));
}

}  // namespace
}  // namespace cyclorama::watch
