// SPDX-License-Identifier: Apache-2.0
/// Tests the check of a stick's settings by another process, which may be in an attacker's hands.
#include "kiosk/provision/sandboxed_check.h"

#include <gmock/gmock.h>
#include <grp.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fstream>

#include "tests/support/museum_stick.h"

namespace cyclorama::provision {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::SizeIs;

SettingsVerdict a_verdict() {
  SettingsVerdict verdict;
  verdict.museum = "hall-3";
  verdict.farm = {"[2001:db8::1]:7401"};
  verdict.projectors = 3;
  verdict.certificate_until = "2029-02-24";
  verdict.pin = kStickPin;
  verdict.secrets = {{"tls/key.pem", "cyclorama-tour"}};
  verdict.remarks = {"tracker.toml is missing"};
  return verdict;
}

/// Museum whose settings a shell script checks.
class Museum {
 public:
  explicit Museum(const std::string& script, std::string group = "") : group_(std::move(group)) {
    command_ = {"sh", "-c", script, "check", file().string()};
    std::ofstream(good()) << verdict_json(a_verdict());
  }
  [[nodiscard]] fs::path file() const { return stick_.root() / "verdict.json"; }
  [[nodiscard]] fs::path good() const { return stick_.root() / "good.json"; }
  [[nodiscard]] Result<ProvisioningReport> plug_in() const {
    auto store = SettingsStore::open(stick_.root());
    CHECK(store);
    ProvisionOrder order{stick_.stick(), {}, {}, false, "2026-11-22T16:04:05Z"};
    order.sandbox = SandboxedCheck{command_, file(), group_};
    return provision(order, &*store);
  }
  [[nodiscard]] const MuseumStick& stick() const { return stick_; }

 private:
  MuseumStick stick_;
  std::vector<std::string> command_;
  std::string group_;
};

TEST(SandboxedCheck, takes_the_verdict_of_another_process) {
  const Museum museum("cp \"$(dirname \"$1\")/good.json\" \"$1\"");
  const auto report = museum.plug_in();
  ASSERT_TRUE(report);
  EXPECT_EQ(report->verdict, ProvisioningVerdict::kInstalled);
  EXPECT_EQ(report->museum, "hall-3");
  EXPECT_TRUE(report->has_pin);
  EXPECT_THAT(report->remarks, ElementsAre("tracker.toml is missing"));
  EXPECT_FALSE(fs::exists(museum.file())) << "it had the PIN";
  EXPECT_THAT(museum.stick().in_use("operator-pin"), HasSubstr("scrypt:"));
}

TEST(SandboxedCheck, parses_nothing_itself) {
  const Museum museum("cp \"$(dirname \"$1\")/good.json\" \"$1\"");
  museum.stick().write("site.toml", "[farm\n");
  EXPECT_EQ(museum.plug_in()->verdict, ProvisioningVerdict::kInstalled) << "only the other process could have seen it";
}

TEST(SandboxedCheck, refuses_what_the_other_process_refuses) {
  const Museum museum("cp \"$(dirname \"$1\")/good.json\" \"$1\"");
  SettingsVerdict verdict = a_verdict();
  verdict.problems = {"site.toml:2: 'musuem' is not known here"};
  std::ofstream(museum.good()) << verdict_json(verdict);
  const auto report = museum.plug_in();
  EXPECT_EQ(report->verdict, ProvisioningVerdict::kRefused);
  EXPECT_THAT(report->problems, ElementsAre("site.toml:2: 'musuem' is not known here"));
}

TEST(SandboxedCheck, takes_nothing_without_a_verdict) {
  for (const char* const script : {"exit 1", "exit 0", "echo out of memory; exit 1", "echo '{}' >\"$1\"",
                                   "echo >\"$1\"; kill -9 $$", "cp \"$(dirname \"$1\")/good.json\" \"$1\"; exit 1"}) {
    const Museum museum(script);
    std::ofstream(museum.file()) << verdict_json(a_verdict());  // An earlier stick's.
    EXPECT_FALSE(museum.plug_in()) << script;
    EXPECT_EQ(museum.stick().in_use("site.toml"), "") << script;
    EXPECT_FALSE(fs::exists(museum.file())) << script;
  }
}

TEST(SandboxedCheck, lets_the_other_user_read_the_copy) {
  const ::group* const own = ::getgrgid(::getgid());
  ASSERT_NE(own, nullptr);
  const Museum museum(
      "cd \"$(dirname \"$1\")/staging\" && stat -c '%a %n' . site.toml tls tls/key.pem >../modes && cp ../good.json "
      "\"$1\"",
      own->gr_name);
  ASSERT_TRUE(museum.plug_in());
  EXPECT_EQ(*read_text_file(museum.stick().root() / "modes", 1000), "750 .\n640 site.toml\n750 tls\n640 tls/key.pem\n");
  struct stat info {};
  ASSERT_EQ(::stat((museum.stick().root() / "settings/tls/key.pem").c_str(), &info), 0);
  EXPECT_EQ(info.st_mode & 0077 & ~0040u, 0u) << "a secret is one again";
  const auto away = Museum("exit 0", "no-such-group").plug_in();
  ASSERT_FALSE(away);
  EXPECT_EQ(away.error().code(), ErrorCode::kNotFound);
}

TEST(Verdict, survives_a_round_trip) {
  const auto again = parse_verdict(verdict_json(a_verdict()));
  ASSERT_TRUE(again);
  EXPECT_EQ(verdict_json(*again), verdict_json(a_verdict()));
  SettingsVerdict many;
  many.problems.assign(5000, std::string(5000, 'x') + "\n");
  EXPECT_THAT(parse_verdict(verdict_json(many))->problems, SizeIs(100));
}

TEST(Verdict, gives_files_to_our_services_alone) {
  const auto with = [](const fs::path& name, const std::string& group) {
    SettingsVerdict verdict = a_verdict();
    verdict.secrets = {{name, group}};
    return static_cast<bool>(parse_verdict(verdict_json(verdict)));
  };
  EXPECT_TRUE(with("password", "cyclorama-projectors"));
  for (const char* const group : {"root", "shadow", "", "cyclorama", "cyclorama-x/../y"})
    EXPECT_FALSE(with("a", group));
  for (const char* const name : {"/etc/shadow", "../x", "a/b/c", "", ".x", "a/../b"})
    EXPECT_FALSE(with(name, "cyclorama-tour")) << name;
}

TEST(Verdict, is_refused_in_any_other_form) {
  const std::string good = verdict_json(a_verdict());
  for (std::size_t cut = 0; cut + 3 < good.size(); cut += 7) EXPECT_FALSE(parse_verdict(good.substr(0, cut))) << cut;
  for (const char* const bad : {"", "[]", "null", "7", "{\"pin\": 7}"}) EXPECT_FALSE(parse_verdict(bad)) << bad;
  SettingsVerdict guessed = a_verdict();
  guessed.pin = "1";
  EXPECT_FALSE(parse_verdict(verdict_json(guessed))) << "no PIN that check_pin() refuses";
}

}  // namespace
}  // namespace cyclorama::provision
