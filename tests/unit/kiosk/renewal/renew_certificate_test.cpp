// SPDX-License-Identifier: Apache-2.0
// Tests of a museum that renews its certificate at a real coordinator, over TLS on [::1].
#include "kiosk/renewal/renew_certificate.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/base/file.h"
#include "common/wire/certificate_request.h"
#include "renderfarm/client/certificate_client.h"
#include "renderfarm/coordinator/coordinator.h"
#include "tests/support/test_authority.h"

namespace cyclorama::renewal {
namespace {

namespace fs = std::filesystem;
using std::chrono::days;
using std::chrono::system_clock;
using testing::HasSubstr;
using Kind = RenewalOutcome::Kind;

std::string text_of(const fs::path& path) {
  const auto text = read_text_file(path, 1 << 20);
  return text ? *text : "";
}

/// A farm with an authority, and a museum whose certificate lasts as long as a test requires.
class Farm {
 public:
  explicit Farm(const std::string& museum_days, bool renews = true) {
    museum_ = authority_.make("museum hall-3 --days " + museum_days, "hall-3");
    fs::create_directories(folder());
    coordinator::CoordinatorOptions options;
    options.scenes.push_back({.name = "grotto", .path = "/srv/grotto"});
    options.museums = options.nodes = "[::1]:0";
    options.trust.tls = authority_.coordinator();
    if (renews) options.renewals = renewals();
    auto started =
        coordinator::Coordinator::start(std::move(options), [](const std::string&, const coordinator::NoticeAbout&) {});
    CHECK(started);
    coordinator_ = *std::move(started);
  }
  ~Farm() { coordinator_->stop(); }
  Farm(const Farm&) = delete;
  Farm& operator=(const Farm&) = delete;

  [[nodiscard]] fs::path folder() const { return authority_.folder() / "museum"; }
  [[nodiscard]] fs::path renewals() const { return authority_.folder() / "renewals"; }
  [[nodiscard]] const TlsFiles& museum() const { return museum_; }
  [[nodiscard]] TestAuthority& authority() { return authority_; }
  std::string sign(const std::string& words = "") { return authority_.run("renewals " + renewals().string() + words); }

  [[nodiscard]] Result<std::string> ask(const std::string& request) const {
    return client::renew_at_farm({"[::1]:" + std::to_string(coordinator_->museum_port())}, museum_, request);
  }
  [[nodiscard]] Result<RenewalOutcome> renew(system_clock::time_point now = system_clock::now()) const {
    return renew_certificate({museum_, folder(), now, [this](const std::string& request) { return ask(request); }});
  }
  /// Puts the next pair in place of the present one, as `cyclorama-provision renew` does.
  void take() const {
    fs::copy_file(folder() / "renewed/certificate.crt", museum_.certificate, fs::copy_options::overwrite_existing);
    fs::copy_file(folder() / "renewed/key.pem", museum_.key, fs::copy_options::overwrite_existing);
  }

 private:
  TestAuthority authority_;
  TlsFiles museum_;
  std::unique_ptr<coordinator::Coordinator> coordinator_;
};

TEST(RenewCertificate, gets_the_next_certificate_with_a_key_that_never_leaves_the_museum) {
  Farm farm("20");
  const auto waiting = farm.renew();
  ASSERT_TRUE(waiting) << waiting.error().message();
  EXPECT_EQ(waiting->kind, Kind::kWaiting);
  const std::string key = text_of(farm.folder() / "next.key");
  EXPECT_THAT(farm.sign(), HasSubstr("renewed: hall-3"));
  EXPECT_FALSE(fs::exists(farm.renewals() / "requests/hall-3.pem"));
  const auto ready = farm.renew();
  ASSERT_TRUE(ready) << ready.error().message();
  EXPECT_EQ(ready->kind, Kind::kReady);
  EXPECT_EQ(text_of(farm.folder() / "renewed/key.pem"), key) << "an authority that takes days costs nothing";
  EXPECT_EQ(fs::status(farm.folder() / "renewed/key.pem").permissions(),
            fs::perms::owner_read | fs::perms::owner_write);
  EXPECT_EQ(output_of("grep -rl 'PRIVATE KEY' '" + farm.renewals().string() + "'"), "");
  farm.take();
  const auto owner = check(farm.museum());
  ASSERT_TRUE(owner) << owner.error().message();
  EXPECT_EQ(owner->name, "hall-3");
  EXPECT_EQ(owner->role, Role::kMuseum);
  const auto after = farm.renew();
  ASSERT_TRUE(after) << after.error().message();
  EXPECT_EQ(after->kind, Kind::kNotDue);
  EXPECT_FALSE(fs::exists(farm.folder() / "next.key"));
  EXPECT_FALSE(fs::exists(farm.folder() / "renewed"));
}

TEST(RenewCertificate, requests_nothing_more_than_thirty_days_before_the_end) {
  Farm farm("40");
  EXPECT_EQ(farm.renew()->kind, Kind::kNotDue);
  EXPECT_FALSE(fs::exists(farm.renewals()));
  EXPECT_EQ(farm.renew(system_clock::now() + days(11))->kind, Kind::kWaiting);
  EXPECT_TRUE(fs::exists(farm.renewals() / "requests/hall-3.pem"));
}

TEST(RenewCertificate, keeps_a_museum_at_its_farm_for_years_although_the_authority_takes_three_days) {
  Farm farm("825");
  constexpr int kYears = 9;
  int renewed = 0;
  for (int day = 0; day < kYears * 365; ++day) {
    const system_clock::time_point now = system_clock::now() + days(day);
    const auto end = end_of_certificate(text_of(farm.museum().certificate));
    ASSERT_TRUE(end);
    ASSERT_GT(*end, now + days(26)) << "day " << day;
    if (!is_due(*end, now)) continue;  // Asking each day would take minutes.
    const auto outcome = farm.renew(now);
    ASSERT_TRUE(outcome) << outcome.error().message();
    if (outcome->kind == Kind::kReady) {
      farm.take();
      ++renewed;
      // What the authority has signed is older than a day by now.
      output_of("touch -d '3 days ago' '" + (farm.renewals() / "issued/hall-3.crt").string() + "'");
    } else if (now + days(28) > *end) {
      // A certificate that is made on that day.
      farm.sign(" --days " + std::to_string(day + 825));
    }
  }
  EXPECT_EQ(renewed, 4);
}

TEST(RenewCertificate, is_refused_for_another_museum_and_for_one_that_was_revoked) {
  Farm farm("20");
  const auto key = new_private_key();
  ASSERT_TRUE(key);
  const auto request = certificate_request(*key, {.role = Role::kMuseum, .name = "hall-4"});
  ASSERT_TRUE(request);
  const auto refused = farm.ask(*request);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code(), ErrorCode::kInvalidArgument);
  EXPECT_THAT(refused.error().message(), HasSubstr("'hall-3' requests a certificate for the museum 'hall-4'"));
  EXPECT_FALSE(farm.ask("no request"));
  ASSERT_EQ(farm.renew()->kind, Kind::kWaiting);
  farm.authority().run("revoke hall-3");
  EXPECT_THAT(farm.sign(), HasSubstr("refused: no certificate of that name is valid"));
  EXPECT_FALSE(fs::exists(farm.renewals() / "issued/hall-3.crt"));
}

TEST(RenewCertificate, says_what_to_do_where_the_farm_renews_nothing) {
  const Farm farm("20", false);
  const auto outcome = farm.renew();
  ASSERT_FALSE(outcome);
  EXPECT_EQ(outcome.error().code(), ErrorCode::kNotFound);
  EXPECT_THAT(outcome.error().message(), HasSubstr("ask its operator for the next bundle"));
}

TEST(RenewCertificate, does_not_use_an_answer_that_is_not_its_own_certificate) {
  Farm farm("20");
  TestAuthority foreign;
  const auto asked = [&](const std::string& certificate) {
    return renew_certificate({farm.museum(), farm.folder(), system_clock::now(),
                              [&](const std::string&) -> Result<std::string> { return certificate; }});
  };
  for (const std::string& answer :
       {std::string("not a certificate"), text_of(farm.museum().certificate),
        text_of(farm.authority().museum("hall-4").certificate), text_of(foreign.museum("hall-3").certificate)}) {
    const auto outcome = asked(answer);
    ASSERT_FALSE(outcome);
    EXPECT_EQ(outcome.error().code(), ErrorCode::kBadData);
    EXPECT_FALSE(fs::exists(farm.folder() / "renewed"));
  }
  EXPECT_TRUE(check(farm.museum())) << "the present one stays in use";
}

}  // namespace
}  // namespace cyclorama::renewal
