// SPDX-License-Identifier: Apache-2.0
#include "kiosk/network/network_trial.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "common/base/file.h"
#include "tests/doubles/fake_clock.h"

namespace cyclorama::network {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

constexpr const char* kFixed =
    "[network]\ninterface = \"eno1\"\nipv4 = \"static\"\nipv4_address = \"192.0.2.7/24\"\ndns = [\"192.0.2.1\"]\n";
constexpr const char* kVlan = "[network]\ninterface = \"eno1\"\nvlan = 42\n";

class NetworkTrial : public testing::Test {
 protected:
  NetworkTrial() {
    std::string pattern = fs::temp_directory_path() / "network_trial_XXXXXX";
    folder_ = ::mkdtemp(pattern.data());
    place_.run = folder_ / "run";
    place_.settings = folder_ / "settings";
    for (const char* const name : {"settings", "offer"}) fs::create_directories(folder_ / name);
    write("settings/site.toml", kFixed);
    write("offer/site.toml", kVlan);
    order_.offer = folder_ / "offer";
    order_.code = "c0de";
    order_.keep = folder_ / "keep";
    order_.install = [this]() -> Status {
      fs::copy_file(order_.offer / "site.toml", place_.settings / "site.toml", fs::copy_options::overwrite_existing);
      return Done{};
    };
  }
  ~NetworkTrial() override { fs::remove_all(folder_); }

  void write(const std::string& name, std::string_view text) {
    ASSERT_TRUE(write_file_atomically(folder_ / name, text));
  }
  [[nodiscard]] bool has(const std::string& name) const { return fs::exists(place_.run / "systemd/network" / name); }
  /// Runs a trial in which `meanwhile` happens once, after the given time.
  Result<TrialEnd> run(Duration after, const std::function<void()>& meanwhile, bool ends = false) {
    const TimePoint at = clock_.now() + after;
    bool has_happened = false;
    return run_trial(place_, order_, clock_, [&, at](TimePoint until) {
      EXPECT_TRUE(has("20-museum-vlan.netdev")) << "the offered network is not there while it is tried";
      clock_.wait_until(until);
      if (has_happened || clock_.now() < at) return false;
      has_happened = true;
      meanwhile();
      return ends;
    });
  }
  void expect_in_use_again() {
    EXPECT_FALSE(has("20-museum-vlan.netdev"));
    EXPECT_TRUE(has("20-museum-cable.network"));
  }

  fs::path folder_;
  FakeClock clock_;
  NetworkPlace place_;
  TrialOrder order_;
};

TEST_F(NetworkTrial, is_kept_when_somebody_confirms_it_in_time) {
  const auto end = run(std::chrono::seconds(59), [this] { write("keep", "c0de\n"); });
  ASSERT_TRUE(end) << end.error().message();
  EXPECT_EQ(*end, TrialEnd::kKept);
  EXPECT_TRUE(has("20-museum-vlan.netdev"));
  EXPECT_EQ(read_trial(place_.run).state, "kept");
}

TEST_F(NetworkTrial, is_taken_back_without_a_confirmation) {
  const TimePoint begun = clock_.now();
  const auto end = run(std::chrono::hours(1), [] {});
  ASSERT_TRUE(end);
  EXPECT_EQ(*end, TrialEnd::kTakenBack);
  EXPECT_EQ(clock_.now() - begun, std::chrono::seconds(60));
  expect_in_use_again();
  EXPECT_EQ(read_trial(place_.run).state, "taken-back");
  EXPECT_THAT(read_trial(place_.run).sentence, HasSubstr("within 60 seconds"));
}

TEST_F(NetworkTrial, is_not_confirmed_by_another_code_or_a_link) {
  write("elsewhere", "c0de\n");
  fs::create_symlink(folder_ / "elsewhere", order_.keep);
  EXPECT_EQ(*run(std::chrono::seconds(1), [] {}), TrialEnd::kTakenBack);
  fs::remove(order_.keep);
  EXPECT_EQ(*run(std::chrono::seconds(1), [this] { write("keep", "c0d\n"); }), TrialEnd::kTakenBack);
}

TEST_F(NetworkTrial, is_taken_back_when_the_computer_stops) {
  EXPECT_EQ(*run(
                std::chrono::seconds(1), [] {}, true),
            TrialEnd::kTakenBack);
  expect_in_use_again();
}

TEST_F(NetworkTrial, is_taken_back_when_the_settings_are_refused_as_a_whole) {
  order_.install = [] { return Status(Error(ErrorCode::kBadData, "installation.toml:3 is wrong")); };
  EXPECT_EQ(*run(std::chrono::seconds(1), [this] { write("keep", "c0de\n"); }), TrialEnd::kTakenBack);
  expect_in_use_again();
  EXPECT_EQ(read_trial(place_.run).sentence, "installation.toml:3 is wrong");
  order_.install = [] { return Status(Done{}); };  // Ends well, but the settings in use are others.
  EXPECT_EQ(*run(std::chrono::seconds(1), [this] { write("keep", "c0de\n"); }), TrialEnd::kTakenBack);
}

TEST_F(NetworkTrial, does_not_begin_with_a_mistake) {
  ASSERT_TRUE(apply_in_use(place_));
  write("offer/site.toml", "[network]\nvlan = 4095\n");
  const auto end = run(std::chrono::seconds(1), [] { FAIL() << "it was tried"; });
  ASSERT_FALSE(end);
  EXPECT_THAT(end.error().message(), HasSubstr("site.toml:2"));
  expect_in_use_again();
  EXPECT_THAT(read_trial(place_.run).sentence, HasSubstr("site.toml:2"));
}

TEST_F(NetworkTrial, does_not_outlive_a_restart) {
  const auto killed = run(std::chrono::seconds(1), [this] {
    // A process that is killed writes nothing more; the next start finds an empty /run.
    fs::rename(place_.run, folder_ / "lost");
    ASSERT_TRUE(apply_in_use(place_));
    expect_in_use_again();
    fs::remove_all(place_.run);
    fs::rename(folder_ / "lost", place_.run);
  });
  ASSERT_TRUE(killed);
}

TEST_F(NetworkTrial, is_not_disturbed_by_settings_that_are_applied_meanwhile) {
  const auto end = run(std::chrono::seconds(1), [this] {
    EXPECT_TRUE(apply_in_use(place_));
    EXPECT_TRUE(has("20-museum-vlan.netdev"));
    const auto second = run_trial(place_, order_, clock_, [](TimePoint) { return true; });
    ASSERT_FALSE(second);
    EXPECT_EQ(second.error().code(), ErrorCode::kBusy);
  });
  EXPECT_EQ(*end, TrialEnd::kTakenBack);
}

TEST_F(NetworkTrial, tells_programs_what_changed_and_reports_their_failure) {
  write("reload", "#!/bin/sh\necho \"$@\" >>" + (folder_ / "reloads").string() + "\n");
  fs::permissions(folder_ / "reload", fs::perms::owner_all);
  place_.reload = {(folder_ / "reload").string()};
  ASSERT_TRUE(apply_in_use(place_));
  ASSERT_TRUE(apply_in_use(place_)) << "nothing changed, so nothing is reloaded";
  EXPECT_EQ(*read_text_file(folder_ / "reloads", 1000), "20-museum-cable.network\n");
  EXPECT_EQ(*run(std::chrono::hours(1), [] {}), TrialEnd::kTakenBack);
  EXPECT_THAT(*read_text_file(folder_ / "reloads", 1000), HasSubstr("20-museum-vlan.netdev 20-museum-vlan.network"));
  write("reload", "#!/bin/sh\necho no bus; exit 1\n");
  fs::permissions(folder_ / "reload", fs::perms::owner_all);
  write("settings/site.toml", "");
  const Status failed = apply_in_use(place_);
  ASSERT_FALSE(failed);
  EXPECT_THAT(failed.error().message(), HasSubstr("no bus"));
}

}  // namespace
}  // namespace cyclorama::network
