// SPDX-License-Identifier: Apache-2.0
/// Tests of the operator page of a museum: HTTPS, a PIN, and its requests.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <httplib.h>
#include <sys/stat.h>
#include <zip.h>

#include <ctime>
#include <nlohmann/json.hpp>

#include "kiosk/operator/page_certificate.h"
#include "kiosk/operator/page_server.h"
#include "tests/doubles/fake_calibrator.h"
#include "tests/doubles/fake_process.h"
#include "tests/support/museum_stick.h"

namespace cyclorama::operations {
namespace {

using namespace std::chrono_literals;
namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using Json = nlohmann::json;

/// Returns the names and contents of an archive.
std::map<std::string, std::string> unzipped(const std::string& bytes) {
  std::map<std::string, std::string> members;
  zip_source_t* const source = zip_source_buffer_create(bytes.data(), bytes.size(), 0, nullptr);
  zip_t* const archive = zip_open_from_source(source, ZIP_RDONLY, nullptr);
  if (archive == nullptr) return members;
  for (zip_int64_t i = 0; i < zip_get_num_entries(archive, 0); ++i) {
    zip_stat_t info;
    zip_stat_index(archive, static_cast<zip_uint64_t>(i), 0, &info);
    std::string text(info.size, '\0');
    zip_file_t* const file = zip_fopen_index(archive, static_cast<zip_uint64_t>(i), 0);
    zip_fread(file, text.data(), text.size());
    zip_fclose(file);
    members[info.name] = text;
  }
  zip_discard(archive);
  return members;
}

struct Page {
  MuseumStick stick;
  FakeProcess tour{"tour"};
  FakeCalibrator calibrator;
  SteadyClock clock;
  fs::path keep;
  std::optional<PageCertificate> certificate;
  HttpTls tls;
  std::unique_ptr<Sessions> sessions;
  std::unique_ptr<CalibrationController> controller;
  std::unique_ptr<Watch> watch;
  MuseumServices museum;
  std::unique_ptr<PageServer> server;
  std::optional<httplib::SSLClient> client;
  httplib::Headers cookie;

  Page() {
    CHECK(stick.install().verdict == provision::ProvisioningVerdict::kInstalled);
    EXPECT_TRUE(write_file_atomically(stick.root() / "provisioning.json", provision::report_json(stick.install())));
    keep = stick.root() / "keep";
    fs::create_directories(keep / "requests");
    auto made = page_certificate(keep, std::time(nullptr));
    CHECK(made);
    certificate = *std::move(made);
    tls = {certificate->certificate_pem, certificate->key_pem};
    sessions = std::make_unique<Sessions>(clock, MuseumState{stick.root()}.pin_file());
    controller = *CalibrationController::make(calibrator.address());
    watch = std::make_unique<Watch>(*make_links({{"tour", tour.address()}}));
    museum.watch = watch.get();
    museum.calibration = controller.get();
    museum.support.museum.root = stick.root();
    museum.support.journal = {"sh", "-c", "cat '" + (stick.root() / "journal").string() + "'"};
    museum.requests = keep / "requests";
    museum.recovery_key = keep / "recovery-key";
    museum.fingerprint = certificate->fingerprint;
    auto started = PageServer::start("[::1]:0", watch.get(), {&museum, sessions.get(), &tls});
    CHECK(started);
    server = *std::move(started);
    client.emplace("::1", server->port());
    client->enable_server_certificate_verification(false);
  }
  void enter() {
    const auto answer = client->Post("/login", R"({"pin": "401773"})", "application/json");
    ASSERT_TRUE(answer) << httplib::to_string(answer.error());
    ASSERT_EQ(answer->status, 204) << answer->body;
    const std::string set = answer->get_header_value("Set-Cookie");
    EXPECT_THAT(set,
                AllOf(HasSubstr("Secure"), HasSubstr("HttpOnly"), HasSubstr("SameSite=Strict"), HasSubstr("Path=/")));
    cookie = {{"Cookie", set.substr(0, set.find(';'))}};
  }
  int get(const char* path) { return client->Get(path, cookie)->status; }
  int post(const char* path, const char* body) { return client->Post(path, cookie, body, "application/json")->status; }
};

TEST(MuseumPage, shows_nothing_without_the_pin) {
  Page page;
  for (const char* const path : {"/status", "/museum", "/metrics", "/page.js", "/care.js", "/picture/tour/x.jpg",
                                 "/support-bundle.zip", "/calibration.jpg", "/door/", "/nothing"}) {
    const auto answer = page.client->Get(path);
    ASSERT_TRUE(answer) << httplib::to_string(answer.error());
    EXPECT_EQ(answer->status, 401) << path;
  }
  EXPECT_EQ(page.client->Get("/")->status, 303);
  EXPECT_EQ(page.client->Get("/")->get_header_value("Location"), "/login.html");
  for (const char* const path : {"/login.html", "/login.js", "/login.css"}) EXPECT_EQ(page.get(path), 200) << path;
  for (const char* const path : {"/steer", "/calibration", "/network-test", "/request", "/logout"})
    EXPECT_EQ(page.client->Post(path, "{}", "application/json")->status, 401) << path;
  EXPECT_TRUE(page.tour.steered().empty());
}

TEST(MuseumPage, shows_at_the_login_why_there_is_no_pin_until_there_is_one) {
  Page page;
  const auto door = [&] {
    const auto answer = page.client->Get("/door");
    CHECK(answer && answer->status == 200);
    return answer->body;
  };
  EXPECT_EQ(Json::parse(door())["checks"].size(), 0u) << "a PIN is in use: the page without a PIN shows no findings";
  EXPECT_EQ(page.client->Post("/door", "{}", "application/json")->status, 401);
  fs::remove_all(page.stick.root() / "settings");
  fs::remove_all(page.stick.root() / "generations");
  fs::remove(page.stick.root() / "provisioning.json");
  EXPECT_THAT(door(), HasSubstr("No stick with settings was ever plugged in"));
  page.stick.write("site.toml", "[farm]\nhead = [\"[::1]:1\"]\n");
  page.stick.write("operator.toml", "pin = 401773\n");
  const auto plug_in = [&] {
    EXPECT_TRUE(
        write_file_atomically(page.stick.root() / "provisioning.json", provision::report_json(page.stick.install())));
  };
  plug_in();
  for (const std::string& told :
       {door(), page.client->Post("/login", R"({"pin": "401773"})", "application/json")->body}) {
    EXPECT_THAT(told, AllOf(HasSubstr("was refused"), HasSubstr("site.toml:2"), HasSubstr("operator.toml:1"),
                            HasSubstr("plug it in again"), Not(HasSubstr("401773"))));
  }
  EXPECT_EQ(page.get("/museum"), 401) << "but in comes nobody";
  page.stick.write("site.toml", MuseumStick::site());
  page.stick.write("operator.toml", "pin = \"401773\"\n");
  plug_in();
  EXPECT_EQ(Json::parse(door())["checks"].size(), 0u);
  page.stick.write("site.toml", "[farm]\nhead = 1\n");
  plug_in();
  EXPECT_EQ(Json::parse(door())["checks"].size(), 0u) << "a later stick is nobody's business at the door";
  page.enter();
}

TEST(MuseumPage, opens_with_the_pin_and_closes_on_logout) {
  Page page;
  page.enter();
  for (const char* const path : {"/", "/status", "/museum", "/metrics"}) EXPECT_EQ(page.get(path), 200) << path;
  EXPECT_EQ(page.post("/steer", R"({"forward": 1})"), 204);
  EXPECT_EQ(page.post("/logout", "{}"), 204);
  EXPECT_EQ(page.get("/status"), 401);
}

TEST(MuseumPage, delays_guesses) {
  Page page;
  for (int i = 0; i < 3; ++i) EXPECT_EQ(page.post("/login", R"({"pin": "000001"})"), 403);
  const auto answer = page.client->Post("/login", R"({"pin": "401773"})", "application/json");
  EXPECT_EQ(answer->status, 429);
  EXPECT_THAT(answer->body, HasSubstr("try again in"));
  for (const char* const bad : {"", "{}", "[]", R"({"pin": 401773})"}) EXPECT_EQ(page.post("/login", bad), 400) << bad;
}

TEST(MuseumPage, refuses_requests_of_other_pages) {
  Page page;
  page.enter();
  const std::string host = "[::1]:" + std::to_string(page.server->port());
  const auto from = [&](const char* name, const std::string& value) {
    httplib::Headers headers = page.cookie;
    headers.emplace("Host", host);
    headers.emplace(name, value);
    return page.client->Post("/steer", headers, R"({"forward": 1})", "application/json")->status;
  };
  EXPECT_EQ(from("Origin", "https://" + host), 204);
  EXPECT_EQ(from("Origin", "https://evil.example"), 403);
  EXPECT_EQ(from("Origin", "null"), 403);
  EXPECT_EQ(from("Sec-Fetch-Site", "cross-site"), 403);
  EXPECT_EQ(from("Sec-Fetch-Site", "same-origin"), 204);
  EXPECT_EQ(page.client->Post("/steer", page.cookie, R"({"forward": 1})", "text/plain")->status, 415);
}

TEST(MuseumPage, requires_tls_for_a_pin_and_loopback_without_one) {
  Page page;
  const auto bare = PageServer::start("[::1]:0", page.watch.get(), {&page.museum, page.sessions.get(), nullptr});
  ASSERT_FALSE(bare);
  EXPECT_EQ(bare.error().code(), ErrorCode::kInvalidArgument);
  const auto open = PageServer::start("[::]:0", page.watch.get(), {});
  ASSERT_FALSE(open);
  EXPECT_EQ(open.error().code(), ErrorCode::kInvalidArgument);
  const auto local = PageServer::start("[::1]:0", page.watch.get(), {});
  ASSERT_TRUE(local);
  httplib::Client client("::1", (*local)->port());
  EXPECT_EQ(client.Get("/status")->status, 200);
  EXPECT_EQ(client.Get("/status", {{"Host", "evil.example"}})->status, 421) << "a name that was made to lead here";
}

TEST(MuseumPage, reports_the_museums_state) {
  Page page;
  page.enter();
  const Json museum = Json::parse(page.client->Get("/museum", page.cookie)->body);
  EXPECT_EQ(museum["schedule"]["lines"][0], "Tue-Sun 10:00-18:00");
  EXPECT_EQ(museum["provisioning"]["museum"], "hall-3");
  EXPECT_EQ(museum["calibration"]["state"], "idle");
  EXPECT_EQ(museum["page"]["fingerprint"], page.certificate->fingerprint);
  EXPECT_TRUE(museum["update"].is_null());
  EXPECT_TRUE(write_file_atomically(page.stick.root() / "update.json",
                                    std::string_view(R"({"state": "rolled-back", "version": "1", "available": "2"})")));
  const Json later = Json::parse(page.client->Get("/museum", page.cookie)->body);
  EXPECT_EQ(later["update"]["state"], "rolled-back");
  EXPECT_THAT(later["checks"].dump(), HasSubstr("Version 2 did not start well"));
}

TEST(MuseumPage, answers_in_the_language_that_the_reader_prefers) {
  Page page;
  const httplib::Headers german{{"Accept-Language", "de-CH,de;q=0.9"}};
  const Json texts = Json::parse(page.client->Get("/texts", german)->body);
  EXPECT_EQ(texts["language"], "de") << "it needs no PIN";
  EXPECT_EQ(texts["languages"]["zh"], "中文");
  EXPECT_EQ(Json::parse(page.client->Get("/texts?language=fr", german)->body)["language"], "fr");
  EXPECT_EQ(Json::parse(page.client->Get("/texts?language=../x")->body)["language"], "en");
  EXPECT_THAT(page.client->Post("/login", german, R"({"pin": "000000"})", "application/json")->body,
              HasSubstr("das ist nicht die PIN"));
  EXPECT_THAT(page.client->Get("/status", german)->body, HasSubstr("geben Sie die PIN ein"));
  page.enter();
  httplib::Headers both = page.cookie;
  both.emplace("Accept-Language", "de");
  EXPECT_THAT(Json::parse(page.client->Get("/museum", both)->body)["checks"].dump(), HasSubstr("Einstellungen"));
  EXPECT_THAT(page.client->Get("/status", both)->body, HasSubstr("All is well with tour.")) << "nobody translated it";
  EXPECT_THAT(Json::parse(page.client->Get("/museum", page.cookie)->body)["checks"].dump(), HasSubstr("Settings"));
}

TEST(MuseumPage, takes_the_museums_language_where_nobody_chose_another) {
  Page page;
  EXPECT_TRUE(write_file_atomically(MuseumState{page.stick.root()}.care(), std::string_view("language = \"es\"\n")));
  EXPECT_EQ(Json::parse(page.client->Get("/texts", {{"Accept-Language", "de"}})->body)["language"], "es");
  EXPECT_EQ(Json::parse(page.client->Get("/texts?language=de")->body)["language"], "de");
}

TEST(MuseumPage, gives_metrics_for_a_token_without_the_pin) {
  Page page;
  const MuseumState museum{page.stick.root()};
  const auto status = [&](const std::string& authorization, const char* path = "/metrics") {
    return page.client->Get(path, {{"Authorization", authorization}})->status;
  };
  EXPECT_EQ(status("Bearer 0123456789abcdef"), 401) << "no token is set";
  EXPECT_TRUE(write_file_atomically(museum.care(), std::string_view("[metrics]\ntoken_file = \"token\"\n")));
  EXPECT_EQ(status("Bearer "), 401) << "the file is missing";
  EXPECT_TRUE(write_file_atomically(museum.settings() / "token", std::string_view("0123456789abcdef\n")));
  EXPECT_EQ(status("Bearer 0123456789abcdef"), 200);
  EXPECT_EQ(status("Bearer 0123456789abcdeF"), 401);
  EXPECT_EQ(status("Bearer 0123456789abcdef0"), 401);
  EXPECT_EQ(status("0123456789abcdef"), 401);
  EXPECT_EQ(status("Bearer 0123456789abcdef", "/status"), 401) << "it opens nothing else";
  EXPECT_TRUE(write_file_atomically(museum.settings() / "token", std::string_view("short\n")));
  EXPECT_EQ(status("Bearer short"), 401);
}

TEST(MuseumPage, records_faults_and_visits_and_shows_them) {
  Page page;
  CareLog log({page.museum.support.museum, page.keep, page.watch.get(), [] {
                 return std::vector<Check>{{"disk", "Disk", CheckLevel::kFault, "It is full.", "Empty it."}};
               }});
  page.museum.log = &log;
  page.enter();
  const TimePoint deadline = SteadyClock().now() + 20s;
  while (log.report().today.empty() && SteadyClock().now() < deadline) std::this_thread::sleep_for(20ms);
  const Json museum = Json::parse(page.client->Get("/museum", page.cookie)->body);
  EXPECT_TRUE(museum["history"].is_array());
  EXPECT_EQ(museum["visits"]["is_visited"], false);
  EXPECT_EQ(museum["visits"]["today"].get<std::string>().size(), std::string_view("2026-11-25").size());
  const std::string metrics = page.client->Get("/metrics", page.cookie)->body;
  EXPECT_THAT(metrics, HasSubstr("cyclorama_visits_total{} 0\n"));
  EXPECT_THAT(metrics, HasSubstr("cyclorama_checks{level=\"fault\"}"));
}

TEST(MuseumPage, starts_calibrations_tests_the_network_and_passes_requests_on) {
  Page page;
  page.enter();
  EXPECT_EQ(page.post("/calibration", R"({"do": "start"})"), 204);
  const TimePoint deadline = SteadyClock().now() + 20s;
  const auto state = [&] {
    return Json::parse(page.client->Get("/museum", page.cookie)->body)["calibration"]["state"];
  };
  while (state() == "running" && SteadyClock().now() < deadline) std::this_thread::yield();
  EXPECT_EQ(state(), "done");
  EXPECT_EQ(page.post("/calibration", R"({"do": "restore"})"), 200);
  EXPECT_EQ(page.post("/calibration", R"({"do": "place-cameras"})"), 204);
  while (state() == "running" && SteadyClock().now() < deadline) std::this_thread::yield();
  EXPECT_EQ(state(), "done");
  EXPECT_EQ(page.post("/calibration", R"({"do": "dance"})"), 400);
  page.stick.write("site.toml", "[farm]\ncoordinators = [\"[::1]:1\", \"" + page.tour.address() + "\"]\n");
  ASSERT_EQ(page.stick.install().verdict, provision::ProvisioningVerdict::kInstalled);
  const Json network = Json::parse(page.client->Post("/network-test", page.cookie, "{}", "application/json")->body);
  const std::string text = network.dump();
  EXPECT_THAT(text, HasSubstr("its program does not run"));
  EXPECT_THAT(text, HasSubstr("It answers over IPv6"));
  EXPECT_EQ(page.post("/request", R"({"request": "update"})"), 204);
  EXPECT_TRUE(fs::exists(page.keep / "requests" / "update"));
  EXPECT_EQ(page.post("/request", R"({"request": "../update"})"), 400);
  const std::string digest(64, 'a');
  const std::string confirm = R"({"request": "confirm-stick", "digest": ")";
  EXPECT_EQ(page.post("/request", R"({"request": "confirm-stick"})"), 400);
  EXPECT_EQ(page.post("/request", (confirm + "../etc\"}").c_str()), 400);
  EXPECT_EQ(page.post("/request", (R"({"request": "update", "digest": ")" + digest + "\"}").c_str()), 400);
  EXPECT_EQ(page.post("/request", (confirm + digest + "\"}").c_str()), 204);
  EXPECT_EQ(*read_text_file(page.keep / "requests" / "confirm-stick", 100), digest + "\n");
}

TEST(MuseumPage, shows_the_recovery_key_once_to_who_has_the_pin) {
  Page page;
  const auto waits = [&] {
    return Json::parse(page.client->Get("/museum", page.cookie)->body)["page"]["recovery"].get<bool>();
  };
  const std::string key = "cbdefghi-jklnrtuv";
  ASSERT_TRUE(write_file_atomically(page.keep / "recovery-key", std::string_view("cbdefghi-jklnrtuv\n")));
  EXPECT_EQ(page.post("/recovery-key", "{}"), 401);
  page.enter();
  EXPECT_TRUE(waits());
  EXPECT_THAT(page.client->Get("/museum", page.cookie)->body, Not(HasSubstr(key)));
  EXPECT_THAT(page.client->Get("/support-bundle.zip", page.cookie)->body, Not(HasSubstr(key)));
  const auto shown = page.client->Post("/recovery-key", page.cookie, "{}", "application/json");
  ASSERT_EQ(shown->status, 200) << shown->body;
  EXPECT_EQ(Json::parse(shown->body)["key"], key);
  EXPECT_FALSE(fs::exists(page.keep / "recovery-key"));
  EXPECT_FALSE(waits());
  EXPECT_EQ(page.post("/recovery-key", "{}"), 404);
}

TEST(MuseumPage, overrides_the_opening_hours_once_and_revokes_the_override) {
  Page page;
  page.enter();
  const auto schedule = [&] { return Json::parse(page.client->Get("/museum", page.cookie)->body)["schedule"]; };
  const fs::path file = page.stick.root() / "hours/override";
  EXPECT_TRUE(schedule()["override"].is_null());
  EXPECT_EQ(page.post("/hours", R"({"do": "closed"})"), 204);
  EXPECT_EQ(schedule()["override"]["open"], false);
  EXPECT_EQ(schedule()["open"], false);
  const auto time_in = [](const Json& iso, const absl::TimeZone& zone) {
    absl::Time time;
    EXPECT_TRUE(absl::ParseTime(absl::RFC3339_sec, iso.get<std::string>(), &time, nullptr));
    return absl::FormatTime("%H:%M", time, zone);
  };
  const auto zone = read_opening_hours(MuseumState{page.stick.root()}.site())->zone();
  EXPECT_EQ(time_in(schedule()["override"]["until"], zone), "10:00") << "its next opening";
  const WallTime now = std::chrono::system_clock::now();
  // In an hour, in the museum's time zone.
  const auto hours = read_opening_hours(MuseumState{page.stick.root()}.site());
  ASSERT_TRUE(hours);
  const std::string until = absl::FormatTime("%H:%M", absl::FromChrono(now + std::chrono::hours(1)), hours->zone());
  EXPECT_EQ(page.post("/hours", (R"({"do": "open", "until": ")" + until + "\"}").c_str()), 204);
  EXPECT_EQ(schedule()["open"], true);
  EXPECT_EQ(time_in(schedule()["override"]["until"], zone), until);
  for (const char* const bad : {"", "{}", "[]", R"({"do": "dance"})", R"({"do": "open"})", R"({"do": 1})",
                                R"({"do": "open", "until": "25:00"})", R"({"do": "open", "until": 22})"}) {
    EXPECT_EQ(page.post("/hours", bad), 400) << bad;
  }
  EXPECT_EQ(schedule()["open"], true) << "what is refused changes nothing";
  EXPECT_EQ(page.post("/hours", R"({"do": "settings"})"), 204);
  EXPECT_FALSE(fs::exists(file));
  EXPECT_TRUE(schedule()["override"].is_null());
  EXPECT_EQ(page.post("/hours", R"({"do": "settings"})"), 204) << "twice";
  EXPECT_TRUE(write_file_atomically(file, std::string_view("for ever\n")));
  EXPECT_THAT(schedule()["override_problem"], HasSubstr("damaged"));
  EXPECT_EQ(schedule()["open"], hours->is_open(now));
  EXPECT_EQ(page.client->Post("/hours", R"({"do": "closed"})", "application/json")->status, 401);
}

TEST(MuseumPage, offers_a_support_bundle_without_secrets) {
  Page page;
  page.stick.write("beamer-password", "open-sesame-9\n");
  page.stick.write("calibrator.toml", "# open-sesame-9\nturntable = \"manual\"\n");
  fs::create_directories(page.stick.stick() / "cameras");
  page.stick.write("cameras/left.json", "{\"camera\": \"open-sesame-9\"}");
  // Files into which people may write secrets by mistake.
  const auto key = read_text_file(museum_certificates().key, 1 << 20);
  ASSERT_TRUE(key);
  const std::string inner_line = key->substr(key->find('\n') + 1, 40);
  page.stick.write("notes.toml", "# " + inner_line + "\npin = \"401773\"\npjlink_password = 'open-sesame-9'\n" + *key);
  ASSERT_EQ(page.stick.install().verdict, provision::ProvisioningVerdict::kInstalled);
  const std::string hash = page.stick.in_use("operator-pin");
  EXPECT_TRUE(write_file_atomically(
      page.stick.root() / "journal",
      "Nov 22 12:00:00 museum cyclorama-tour[1]: reading " + *key + "\nNov 22 tour: said open-sesame-9 to it\n" + hash +
          "\n" + std::string(5'000'000, 'x') + "\nNov 22 museum: the last line " + inner_line + "\n"));
  page.enter();
  const auto answer = page.client->Get("/support-bundle.zip", page.cookie);
  ASSERT_EQ(answer->status, 200);
  const auto members = unzipped(answer->body);
  for (const char* const name :
       {"status.json", "checks.json", "versions.txt", "journal.txt", "settings/site.toml", "settings/installation.toml",
        "settings/calibrator.toml", "settings/cameras/left.json", "state/provisioning.json"}) {
    EXPECT_EQ(members.count(name), 1u) << name;
  }
  EXPECT_THAT(members.at("settings/site.toml"), HasSubstr("key = \"tls/key.pem\"")) << "where it is, is no secret";
  EXPECT_THAT(members.at("journal.txt"), HasSubstr("the last line"));
  EXPECT_LT(members.at("journal.txt").size(), 4'300'000u);
  EXPECT_TRUE(Json::accept(members.at("checks.json"))) << members.at("checks.json").substr(0, 400);
  std::vector<std::string> secrets{"401773", "open-sesame-9", hash.substr(0, hash.size() - 1), inner_line};
  for (std::size_t at = key->find('\n') + 1; at + 16 < key->find("-----END"); at += 16)
    secrets.push_back(key->substr(at, 16));
  for (const auto& [name, text] : members) {
    EXPECT_THAT(name, Not(HasSubstr("key"))) << name;
    EXPECT_THAT(text, Not(HasSubstr("PRIVATE KEY"))) << name;
    for (const std::string& secret : secrets)
      EXPECT_EQ(text.find(secret), std::string::npos) << name << " tells " << secret;
  }
}

TEST(PageCertificate, is_created_once_kept_private_and_renewed_in_time) {
  const MuseumStick disk;
  const std::time_t now = std::time(nullptr);
  const auto first = page_certificate(disk.root(), now);
  ASSERT_TRUE(first);
  EXPECT_EQ(first->fingerprint.size(), 95u);
  const auto again = page_certificate(disk.root(), now);
  ASSERT_TRUE(again);
  EXPECT_EQ(again->fingerprint, first->fingerprint);
  struct stat info {};
  ASSERT_EQ(::stat((disk.root() / "page.key").c_str(), &info), 0);
  EXPECT_EQ(info.st_mode & 0777, 0600u);
  const auto later = page_certificate(disk.root(), now + 780L * 86400);
  ASSERT_TRUE(later);
  EXPECT_NE(later->fingerprint, first->fingerprint);
  EXPECT_EQ(later->key_pem, first->key_pem);
  fs::resize_file(disk.root() / "page.crt", 100);
  EXPECT_TRUE(page_certificate(disk.root(), now)) << "a damaged one is made anew";
  EXPECT_FALSE(page_certificate(disk.root() / "nowhere", now));
}

TEST(PageCertificate, is_renewed_by_a_page_that_runs_for_years_and_after_the_clock_was_set) {
  const MuseumStick disk;
  std::time_t now = std::time(nullptr);
  auto page = page_certificate(disk.root(), now);
  ASSERT_TRUE(page);
  EXPECT_TRUE(is_to_be_renewed(*page, now - 30L * 86400)) << "the clock was years ahead when the page started";
  constexpr int kDays = 5 * 365;
  int starts = 0;
  for (int day = 0; day < kDays; ++day, now += 86400) {
    if (!is_to_be_renewed(*page, now)) continue;
    ++starts;
    page = page_certificate(disk.root(), now);
    ASSERT_TRUE(page);
    EXPECT_FALSE(is_to_be_renewed(*page, now)) << "a page must not start again for ever";
  }
  EXPECT_EQ(starts, 2);
}

}  // namespace
}  // namespace cyclorama::operations
