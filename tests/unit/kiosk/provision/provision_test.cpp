// SPDX-License-Identifier: Apache-2.0
#include "kiosk/provision/provision.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <regex>

#include "kiosk/provision/pin.h"
#include "tests/support/museum_stick.h"

namespace cyclorama::provision {
namespace {

namespace fs = std::filesystem;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

TEST(Provision, applies_a_good_usb_stick_and_reports_its_contents) {
  const MuseumStick museum;
  const ProvisioningReport report = museum.install();
  EXPECT_EQ(report.verdict, ProvisioningVerdict::kInstalled);
  EXPECT_THAT(report.problems, IsEmpty());
  EXPECT_THAT(report.remarks, IsEmpty());
  EXPECT_EQ(report.museum, "hall-3");
  EXPECT_THAT(report.farm, ElementsAre("[2001:db8::1]:7401"));
  EXPECT_EQ(report.projectors, 3);
  EXPECT_EQ(report.in_use, "000001");
  EXPECT_EQ(report.certificate_until.size(), 10u);
  EXPECT_TRUE(report.has_pin);
  EXPECT_EQ(museum.in_use("site.toml"), MuseumStick::site());
  EXPECT_THAT(museum.in_use("tls/key.pem"), HasSubstr("PRIVATE KEY"));
}

TEST(Provision, stores_the_pin_only_as_a_hash_and_the_key_unreadable_for_others) {
  const MuseumStick museum;
  ASSERT_EQ(museum.install().verdict, ProvisioningVerdict::kInstalled);
  EXPECT_FALSE(fs::exists(museum.root() / "settings" / "operator.toml"));
  const auto right = is_pin(kStickPin, museum.in_use("operator-pin"));
  const auto wrong = is_pin("401774", museum.in_use("operator-pin"));
  ASSERT_TRUE(right && wrong);
  EXPECT_TRUE(*right);
  EXPECT_FALSE(*wrong);
  for (const auto& entry : fs::recursive_directory_iterator(museum.root())) {
    if (!entry.is_regular_file()) continue;
    const auto text = read_text_file(entry.path(), 1 << 20);
    ASSERT_TRUE(text);
    EXPECT_THAT(*text, Not(HasSubstr(kStickPin))) << entry.path();
  }
  for (const char* const secret : {"tls/key.pem", "operator-pin"}) {
    struct stat info {};
    ASSERT_EQ(::stat((museum.root() / "settings" / secret).c_str(), &info), 0);
    EXPECT_EQ(info.st_mode & 0007, 0u) << secret << " is for all to read";
  }
}

TEST(Provision, makes_everything_else_readable_for_services_with_any_umask) {
  const MuseumStick museum;
  fs::remove_all(museum.root());
  const mode_t before = ::umask(0077);
  EXPECT_EQ(museum.install().verdict, ProvisioningVerdict::kInstalled);
  ::umask(before);
  for (const char* const folder : {".", "generations", "settings", "settings/tls"}) {
    struct stat info {};
    ASSERT_EQ(::stat((museum.root() / folder).c_str(), &info), 0);
    EXPECT_EQ(info.st_mode & 0777, 0755u) << folder;
  }
  struct stat info {};
  ASSERT_EQ(::stat((museum.root() / "settings/site.toml").c_str(), &info), 0);
  EXPECT_EQ(info.st_mode & 0777, 0644u);
}

TEST(Provision, changes_nothing_when_applied_twice) {
  const MuseumStick museum;
  ASSERT_EQ(museum.install().verdict, ProvisioningVerdict::kInstalled);
  const ProvisioningReport again = museum.install();
  EXPECT_EQ(again.verdict, ProvisioningVerdict::kUnchanged);
  EXPECT_EQ(again.in_use, "000001");
  museum.write("operator.toml", "pin = \"771340\"\n");
  EXPECT_EQ(museum.install().verdict, ProvisioningVerdict::kInstalled) << "another PIN is another set";
}

TEST(Provision, switches_to_the_previous_settings_and_back) {
  const MuseumStick museum;
  ASSERT_EQ(museum.install().verdict, ProvisioningVerdict::kInstalled);
  museum.write("site.toml", MuseumStick::site("hall-4"));
  ASSERT_EQ(museum.install().verdict, ProvisioningVerdict::kInstalled);
  for (const char* const expected : {"hall-3", "hall-4", "hall-3"}) {
    auto store = SettingsStore::open(museum.root());
    ASSERT_TRUE(store);
    const auto report = restore_settings("2026-11-22T16:04:05Z", &*store);
    ASSERT_TRUE(report) << report.error().message();
    EXPECT_EQ(report->verdict, ProvisioningVerdict::kRestored);
    EXPECT_EQ(report->museum, expected);
    EXPECT_TRUE(report->has_pin);
    EXPECT_THAT(museum.in_use("site.toml"), HasSubstr(expected));
  }
  struct stat info {};
  ASSERT_EQ(::stat((museum.root() / "settings" / "tls/key.pem").c_str(), &info), 0);
  EXPECT_EQ(info.st_mode & 0007, 0u) << "a secret stays one";
}

TEST(Provision, has_nothing_to_restore_after_the_first_usb_stick) {
  const MuseumStick museum;
  ASSERT_EQ(museum.install().verdict, ProvisioningVerdict::kInstalled);
  auto store = SettingsStore::open(museum.root());
  ASSERT_TRUE(store);
  const auto report = restore_settings("", &*store);
  ASSERT_FALSE(report);
  EXPECT_EQ(report.error().code(), ErrorCode::kNotFound);
  EXPECT_EQ(store->in_use(), "000001");
}

/// One way to spoil a USB stick, and what the report must contain.
struct Spoilt {
  const char* name;
  void (*spoil)(const MuseumStick&);
  const char* says;
};
class BadStick : public testing::TestWithParam<Spoilt> {};

TEST_P(BadStick, is_refused_with_a_reason_and_the_previous_settings_stay) {
  const MuseumStick museum;
  ASSERT_EQ(museum.install().verdict, ProvisioningVerdict::kInstalled);
  museum.write("site.toml", MuseumStick::site("hall-4"));
  GetParam().spoil(museum);
  const ProvisioningReport report = museum.install();
  EXPECT_EQ(report.verdict, ProvisioningVerdict::kRefused);
  EXPECT_THAT(report.problems, Contains(HasSubstr(GetParam().says))) << report_json(report);
  EXPECT_THAT(report.problems, Not(Contains(HasSubstr("staging")))) << "where it lay for now is nothing to the reader";
  EXPECT_EQ(report.in_use, "000001");
  EXPECT_EQ(museum.in_use("site.toml"), MuseumStick::site());
  EXPECT_FALSE(fs::exists(museum.root() / "staging"));
}

INSTANTIATE_TEST_SUITE_P(
    Ways, BadStick,
    testing::Values(
        Spoilt{"site_missing", [](const MuseumStick& m) { m.remove("site.toml"); }, "site.toml is missing"},
        Spoilt{"site_misspelt", [](const MuseumStick& m) { m.write("site.toml", "[farm]\nhead = [\"[::1]:1\"]\n"); },
               "site.toml:2"},
        Spoilt{"site_cut", [](const MuseumStick& m) { m.write("site.toml", "[farm]\ncoordinators = [\"[20"); },
               "site.toml:2"},
        Spoilt{"hours_wrong", [](const MuseumStick& m) { m.write("site.toml", "[hours]\nopen = [\"Sum 25:00\"]\n"); },
               "site.toml:2"},
        Spoilt{"address_wrong",
               [](const MuseumStick& m) { m.write("site.toml", "[farm]\ncoordinators = [\"farm\"]\n"); },
               "coordinators"},
        Spoilt{"installation_missing", [](const MuseumStick& m) { m.remove("installation.toml"); },
               "installation.toml is missing"},
        Spoilt{"installation_cut",
               [](const MuseumStick& m) {
                 fs::resize_file(m.stick() / "installation.toml", fs::file_size(m.stick() / "installation.toml") / 2);
               },
               "installation.toml:"},
        Spoilt{"connector_left_out",
               [](const MuseumStick& m) {
                 const auto room = read_text_file(m.stick() / "installation.toml", 1 << 20);
                 m.write("installation.toml", std::regex_replace(*room, std::regex("connector = \"HDMI-A-2\"\n"), ""));
               },
               "projector 'middle' has neither 'connector' nor 'serial'"},
        Spoilt{"connected_named",
               [](const MuseumStick& m) {
                 const auto room = read_text_file(m.stick() / "installation.toml", 1 << 20);
                 m.write("installation.toml", std::regex_replace(*room, std::regex("connector = .*\n"), ""));
               },
               "Connected to this computer now: "},
        Spoilt{"edid_missing",
               [](const MuseumStick& m) {
                 const auto room = read_text_file(m.stick() / "installation.toml", 1 << 20);
                 m.write("installation.toml",
                         std::regex_replace(*room, std::regex("connector = "), "edid = \"x.edid\"\nconnector = "));
               },
               "'x.edid', which is not there"},
        Spoilt{"edid_wrong",
               [](const MuseumStick& m) {
                 const auto room = read_text_file(m.stick() / "installation.toml", 1 << 20);
                 m.write("x.edid", "not an EDID");
                 m.write("installation.toml",
                         std::regex_replace(*room, std::regex("connector = "), "edid = \"x.edid\"\nconnector = "));
               },
               "x.edid: an EDID of 11 bytes; it has at least 128"},
        Spoilt{"key_missing", [](const MuseumStick& m) { m.remove("tls/key.pem"); },
               "'tls/key.pem', which is not there"},
        Spoilt{"key_of_another",
               [](const MuseumStick& m) {
                 output_of("openssl genpkey -algorithm EC -pkeyopt ec_paramgen_curve:P-256 -out '" +
                           (m.stick() / "tls/key.pem").string() + "'");
               },
               "'tls/key.pem' is not the key of 'tls/certificate.crt'"},
        Spoilt{"certificate_cut", [](const MuseumStick& m) { fs::resize_file(m.stick() / "tls/certificate.crt", 200); },
               "'tls/certificate.crt' is not a certificate"},
        Spoilt{"certificate_elsewhere",
               [](const MuseumStick& m) {
                 m.write("site.toml",
                         "[farm]\nauthority = \"/etc/passwd\"\ncertificate = \"../x\"\nkey = \"tls/key.pem\"\n");
               },
               "which is not in the folder"},
        Spoilt{"tour_missing",
               [](const MuseumStick& m) { m.write("site.toml", MuseumStick::site() + "[tour]\nfolder = \"tour\"\n"); },
               "'tour/tour.toml', which is not there"},
        Spoilt{"tour_wrong",
               [](const MuseumStick& m) {
                 m.write("site.toml", MuseumStick::site() + "[tour]\nfolder = \"tour\"\n");
                 fs::create_directories(m.stick() / "tour");
                 m.write("tour/tour.toml", "version = 1\nlanguages = [\"en\"]\n[[stop]]\nname = \"a\"\n");
               },
               "tour.toml:3: stop[0].heading_deg"},
        Spoilt{"picture_missing", [](const MuseumStick& m) { m.remove("evening.png"); },
               "'evening.png', which is not there"},
        Spoilt{"picture_cut", [](const MuseumStick& m) { fs::resize_file(m.stick() / "evening.png", 50); },
               "evening.png"},
        Spoilt{"wand_wrong", [](const MuseumStick& m) { m.write("wand.toml", "name = \"x\"\n"); }, "wand.toml"},
        Spoilt{"wand_missing",
               [](const MuseumStick& m) { m.write("tracker.toml", "[wand]\nfiles = [\"mine.toml\"]\n"); },
               "'mine.toml'"},
        Spoilt{"calibrator_cut", [](const MuseumStick& m) { m.write("calibrator.toml", "[camera]\nkind = \"v4"); },
               "calibrator.toml:2"},
        Spoilt{"lens_missing",
               [](const MuseumStick& m) { m.write("calibrator.toml", "[camera]\nlens = \"camera.json\"\n"); },
               "calibrator.toml [camera] lens names 'camera.json', which is not there"},
        Spoilt{"lens_elsewhere",
               [](const MuseumStick& m) { m.write("calibrator.toml", "[camera]\nlens = \"/etc/passwd\"\n"); },
               "which is not in the folder"},
        Spoilt{"pin_short", [](const MuseumStick& m) { m.write("operator.toml", "pin = \"1234\"\n"); },
               "operator.toml:1"},
        Spoilt{"pin_first_tried", [](const MuseumStick& m) { m.write("operator.toml", "pin = \"123456\"\n"); },
               "anybody tries first"},
        Spoilt{"a_link", [](const MuseumStick& m) { fs::create_symlink("/etc/shadow", m.stick() / "secret.toml"); },
               "is a link"},
        Spoilt{"a_link_to_a_folder", [](const MuseumStick& m) { fs::create_directory_symlink("/", m.stick() / "all"); },
               "is a link"},
        Spoilt{"a_pipe", [](const MuseumStick& m) { ::mkfifo((m.stick() / "pipe").c_str(), 0600); },
               "neither a file nor a folder"},
        Spoilt{"a_strange_name", [](const MuseumStick& m) { m.write("my settings.toml", "x"); }, "not plain"},
        Spoilt{"a_deep_folder",
               [](const MuseumStick& m) { fs::create_directories(m.stick() / "tls" / "more" / "deep"); },
               "one level is enough"},
        Spoilt{"checksum_differs",
               [](const MuseumStick& m) { m.write("SHA256SUMS", std::string(64, '0') + "  evening.png\n"); },
               "'evening.png' is not the file"},
        Spoilt{"checksum_of_nothing",
               [](const MuseumStick& m) { m.write("SHA256SUMS", std::string(64, '0') + "  other.png\n"); },
               "'other.png', which is not there"},
        Spoilt{"a_hash_of_ones_own", [](const MuseumStick& m) { m.write("operator-pin", "scrypt:1:1:1:00:00"); },
               "this computer's own"}),
    [](const auto& test) { return test.param.name; });

TEST(Provision, reports_every_mistake_at_once) {
  const MuseumStick museum;
  museum.remove("tls/key.pem");
  museum.write("wand.toml", "nonsense");
  museum.write("operator.toml", "pin = 7\n");
  const ProvisioningReport report = museum.install();
  EXPECT_EQ(report.problems.size(), 3u) << report_json(report);
  EXPECT_EQ(report.in_use, "");
}

/// The operator page's login shows problems to everybody while no PIN is in use.
TEST(Provision, never_quotes_a_secret) {
  constexpr const char* kSecret = "739914";
  const MuseumStick museum;
  const auto good_room = read_text_file(museum.stick() / "installation.toml", 1 << 20);
  ASSERT_TRUE(good_room);
  const auto refusal = [&] {
    const ProvisioningReport report = museum.install();
    EXPECT_EQ(report.verdict, ProvisioningVerdict::kRefused);
    EXPECT_FALSE(report.problems.empty());
    return report_json(report);
  };
  for (const char* const written :
       {"739914", "739914 = 1", "pin 739914", "pin = 739914", "pin = t739914", "pin = 99999999999999739914",
        "pin = 0739914", "[739914]", "\"pin: 739914\" = 1", "pin = \"7\"\n739914 = 2", "pin = \"739914\"\npin = 739914",
        "pin = '739914", "pin.739914 = 1", "pin = [739914", "pin = 2026-13-739914"}) {
    museum.write("operator.toml", std::string(written) + "\n");
    const std::string told = refusal();
    EXPECT_THAT(told, Not(HasSubstr(kSecret))) << written;
    EXPECT_THAT(told, HasSubstr("operator.toml:")) << written;
  }
  museum.write("operator.toml", "pin = \"401773\"\n");
  constexpr std::string_view kProjector = "[[projector]]\n";
  std::string room = *good_room;
  room.insert(room.find(kProjector) + kProjector.size(),
              "pjlink = \"192.0.2.11\"\npjlink_password_file = \"open-739914\"\n");
  museum.write("installation.toml", room);
  const std::string told = refusal();
  EXPECT_THAT(told, Not(HasSubstr(kSecret)));
  EXPECT_THAT(told, HasSubstr("password_file names a file, which is not there"));
  museum.write("installation.toml", *good_room);
  const auto key = read_text_file(museum.stick() / "tls/key.pem", 1 << 20);
  ASSERT_TRUE(key);
  museum.write("site.toml",
               "[farm]\nauthority = \"tls/authority.crt\"\ncertificate = \"tls/certificate.crt\"\n"
               "key = \"\"\"" +
                   *key + "\"\"\"\n");
  EXPECT_THAT(refusal(), Not(HasSubstr(key->substr(key->find('\n') + 1, 20))));
}

TEST(Provision, refuses_files_over_the_limits) {
  const MuseumStick museum;
  museum.write("large.obj", std::string(5000, 'x'));
  EXPECT_THAT(museum.install({}, {200, 4000, 100'000}).problems, Contains(HasSubstr("large.obj")));
  EXPECT_THAT(museum.install({}, {200, 10'000, 6000}).problems, Contains(HasSubstr("too much")));
  EXPECT_THAT(museum.install({}, {3, 1 << 20, 1 << 20}).problems, Contains(HasSubstr("one file too many")));
}

TEST(Provision, ignores_and_reports_files_that_computers_put_on_usb_sticks) {
  const MuseumStick museum;
  museum.write("._site.toml", "junk");
  museum.write("desktop.ini", "junk");
  const ProvisioningReport report = museum.install();
  EXPECT_EQ(report.verdict, ProvisioningVerdict::kInstalled);
  EXPECT_THAT(report.remarks, ElementsAre("'._site.toml' was left out", "'desktop.ini' was left out"));
  EXPECT_EQ(museum.in_use("desktop.ini"), "");
}

TEST(Provision, warns_of_likely_mistakes) {
  const MuseumStick museum;
  museum.write("site.toml", "[farm]\ncoordinators = [\"[2001:db8::1]:7401\"]\n");
  museum.remove("tracker.toml");
  museum.remove("operator.toml");
  const ProvisioningReport report = museum.install();
  EXPECT_EQ(report.verdict, ProvisioningVerdict::kInstalled);
  EXPECT_THAT(report.remarks,
              ElementsAre(HasSubstr("not encrypted"), HasSubstr("no camera follows"), HasSubstr("no PIN")));
}

TEST(Provision, takes_the_calibrators_cameras_and_their_lenses) {
  const MuseumStick museum;
  museum.write("calibrator.toml",
               "[[watch.camera]]\nname = \"left\"\nkind = \"v4l2\"\nport = \"usb-1\"\n[[watch.camera]]\nname = "
               "\"right\"\nkind = \"v4l2\"\nport = \"usb-2\"\n");
  fs::create_directories(museum.stick() / "cameras");
  museum.write("cameras/left.json", "{\"of\": \"left\"}");
  museum.write("cameras/rigth.json", "{}");
  const ProvisioningReport report = museum.install();
  EXPECT_EQ(report.verdict, ProvisioningVerdict::kInstalled);
  EXPECT_THAT(report.remarks,
              ElementsAre(HasSubstr("cameras/right.json is missing"), HasSubstr("cameras/rigth.json is there, but")));
  EXPECT_THAT(museum.in_use("calibrator.toml"), HasSubstr("left"));
  EXPECT_EQ(museum.in_use("cameras/left.json"), "{\"of\": \"left\"}");
}

TEST(Provision, takes_a_curators_tour) {
  const MuseumStick museum;
  museum.write("site.toml", MuseumStick::site() + "[tour]\nfolder = \"tour\"\n");
  fs::create_directories(museum.stick() / "tour");
  museum.write("tour/tour.toml",
               "version = 1\nlanguages = [\"en\"]\n[[stop]]\nname = \"a\"\nposition_m = [0, 0]\nheading_deg = 0\n");
  EXPECT_EQ(museum.install().verdict, ProvisioningVerdict::kInstalled);
  EXPECT_THAT(museum.in_use("tour/tour.toml"), HasSubstr("name = \"a\""));
}

TEST(Provision, checks_settings_by_the_programs_themselves) {
  const MuseumStick museum;
  const fs::path programs = museum.root() / "bin";
  fs::create_directories(programs);
  const auto program = [&](const char* name, const char* script) {
    EXPECT_TRUE(write_file_atomically(programs / name, std::string_view(script)));
    fs::permissions(programs / name, fs::perms::owner_all);
  };
  program("cyclorama-display", "#!/bin/sh\n[ \"$1\" = --check ] && grep -q hall-3 \"$3\"\n");
  program("cyclorama-tracker",
          "#!/bin/sh\necho '<4>a warning'\necho \"<3>cyclorama-tracker: $3:2: no such camera\"; exit 1\n");
  museum.write("calibrator.toml", "turntable = \"manual\"\n");
  program("cyclorama-calibrator",
          "#!/bin/sh\ngrep -q projector \"$5\" && echo \"<3>cyclorama-calibrator: $3:1: no such turntable\"; exit 1\n");
  auto store = SettingsStore::open(museum.root());
  ASSERT_TRUE(store);
  const auto report = provision({museum.stick(), {programs}, {}, false, ""}, &*store);
  ASSERT_TRUE(report);
  EXPECT_THAT(report->problems,
              ElementsAre("cyclorama-tracker refuses them: cyclorama-tracker: tracker.toml:2: no such camera"));
}

TEST(Provision, only_checks_if_requested) {
  const MuseumStick museum;
  auto store = SettingsStore::open(museum.root());
  ASSERT_TRUE(store);
  const auto report = provision({museum.stick(), {}, {}, true, ""}, &*store);
  ASSERT_TRUE(report);
  EXPECT_EQ(report->verdict, ProvisioningVerdict::kInstalled);
  EXPECT_EQ(report->in_use, "");
  EXPECT_EQ(store->in_use(), "");
}

TEST(ProvisioningReport, survives_a_round_trip_through_json_and_refuses_all_else) {
  const MuseumStick museum;
  museum.write("wand.toml", "x = \"\xff\"\n");
  const ProvisioningReport report = museum.install();
  const auto back = parse_report(report_json(report));
  ASSERT_TRUE(back);
  EXPECT_EQ(*back, report);
  for (const char* const bad : {"", "{}", "[]", "{\"verdict\": \"installed\"}"}) EXPECT_FALSE(parse_report(bad)) << bad;
}

TEST(Pin, is_refused_if_it_is_easy_to_guess) {
  for (const char* const pin : {"", "12345", "111111", "123456", "987654", "ab\ncdef", "\xc3\xa4\xc3\xa4\xc3\xa4"})
    EXPECT_FALSE(check_pin(pin)) << pin;
  for (const char* const pin : {"401773", "112233", "correct horse"}) EXPECT_TRUE(check_pin(pin)) << pin;
}

TEST(Pin, has_a_different_hash_each_time) {
  const auto one = hashed_pin(kStickPin);
  const auto two = hashed_pin(kStickPin);
  ASSERT_TRUE(one && two);
  EXPECT_NE(*one, *two);
  for (const char* const bad :
       {"", "scrypt", "scrypt:40:8:1:00112233445566778899:00", "scrypt:15:8:1::", "x:1:1:1:00:00"})
    EXPECT_FALSE(is_pin(kStickPin, bad)) << bad;
}

}  // namespace
}  // namespace cyclorama::provision
