// SPDX-License-Identifier: Apache-2.0
#include "kiosk/provision/certificate_renewal.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/museum_stick.h"

namespace cyclorama::provision {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

/// A museum with two sets of settings, and a folder with the next certificate, which lasts longer.
struct Museum {
  Museum() {
    EXPECT_EQ(stick.install().verdict, ProvisioningVerdict::kInstalled);
    stick.write("site.toml", MuseumStick::site() + "# changed\n");
    report = stick.install();
    EXPECT_EQ(report.verdict, ProvisioningVerdict::kInstalled);
    next = museum_authority().make("museum hall-3 --days 900", "next");
    fs::create_directories(from());
    fs::copy_file(next.certificate, from() / "certificate.crt");
    fs::copy_file(next.key, from() / "key.pem");
  }
  [[nodiscard]] fs::path from() const { return stick.root() / "renewed"; }
  Status renew(const StepHook& hook = {}) {
    auto store = SettingsStore::open(stick.root(), hook);
    CHECK(store);
    return renew_certificate({from(), {}, {}}, &*store, &report);
  }

  MuseumStick stick;
  ProvisioningReport report;
  TlsFiles next;
};

std::string text_of(const fs::path& path) {
  const auto text = read_text_file(path, 1 << 20);
  return text ? *text : "";
}

TEST(CertificateRenewal, exchanges_certificate_and_key_and_nothing_else) {
  Museum museum;
  const std::string until = museum.report.certificate_until;
  const std::string site = museum.stick.in_use("site.toml");
  const std::string pin = museum.stick.in_use("operator-pin");
  const Status done = museum.renew();
  ASSERT_TRUE(done) << done.error().message();
  EXPECT_EQ(museum.stick.in_use("tls/certificate.crt"), text_of(museum.next.certificate));
  EXPECT_EQ(museum.stick.in_use("tls/key.pem"), text_of(museum.next.key));
  EXPECT_EQ(museum.stick.in_use("site.toml"), site);
  EXPECT_EQ(museum.stick.in_use("operator-pin"), pin);
  EXPECT_GT(museum.report.certificate_until, until);
  EXPECT_EQ(museum.report.in_use, "000003");
  auto store = SettingsStore::open(museum.stick.root());
  ASSERT_TRUE(store);
  for (const CopiedFile& file : store->contents()) {
    EXPECT_EQ(*sha256_of(museum.stick.in_use(file.name)), file.sha256) << file.name;
  }
  EXPECT_EQ(fs::status(store->settings() / "tls/key.pem").permissions() & fs::perms::others_all, fs::perms::none);
  // Going back leads to the settings before, and not to the same ones with an older certificate.
  ASSERT_TRUE(store->restore());
  EXPECT_EQ(museum.stick.in_use("site.toml"), MuseumStick::site());
}

TEST(CertificateRenewal, leaves_what_is_in_use_when_the_next_pair_is_bad) {
  Museum museum;
  const std::string certificate = museum.stick.in_use("tls/certificate.crt");
  const auto refused = [&](const std::string& why) {
    const Status done = museum.renew();
    EXPECT_THAT(done ? "" : done.error().message(), HasSubstr(why));
    EXPECT_EQ(museum.stick.in_use("tls/certificate.crt"), certificate);
    EXPECT_EQ(museum.report.in_use, "000002");
    EXPECT_FALSE(fs::exists(museum.stick.root() / "staging"));
  };
  const TlsFiles other = museum_authority().make("museum hall-3 --days 900", "other");
  fs::copy_file(other.key, museum.from() / "key.pem", fs::copy_options::overwrite_existing);
  refused("is not the key of");
  const TlsFiles shorter = museum_authority().make("museum hall-3 --days 30", "shorter");
  fs::copy_file(shorter.key, museum.from() / "key.pem", fs::copy_options::overwrite_existing);
  fs::copy_file(shorter.certificate, museum.from() / "certificate.crt", fs::copy_options::overwrite_existing);
  refused("no later than the one in use");
  fs::remove(museum.from() / "key.pem");
  fs::create_symlink("/etc/shadow", museum.from() / "key.pem");
  refused("key.pem");
}

TEST(CertificateRenewal, has_one_complete_pair_in_use_at_every_step) {
  Museum museum;
  int steps = 0;
  int with_the_next = 0;
  const Status done = museum.renew([&](std::string_view) {
    ++steps;
    const std::string certificate = museum.stick.in_use("tls/certificate.crt");
    const bool is_next = certificate == text_of(museum.next.certificate);
    with_the_next += is_next ? 1 : 0;
    EXPECT_EQ(museum.stick.in_use("tls/key.pem"), text_of(is_next ? museum.next.key : museum_certificates().key));
  });
  ASSERT_TRUE(done) << done.error().message();
  EXPECT_GT(with_the_next, 0);
  EXPECT_LT(with_the_next, steps);
}

}  // namespace
}  // namespace cyclorama::provision
