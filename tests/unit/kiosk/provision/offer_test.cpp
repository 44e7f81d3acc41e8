// SPDX-License-Identifier: Apache-2.0
/// What the operator page offers is laid over the settings in use.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "kiosk/provision/pin.h"
#include "kiosk/provision/provision.h"
#include "tests/support/museum_stick.h"

namespace cyclorama::provision {
namespace {

namespace fs = std::filesystem;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// A museum that was provisioned from a stick, whose folder becomes the next offer.
class Offer : public testing::Test {
 protected:
  ProvisioningReport install() {
    auto store = SettingsStore::open(museum_.root());
    CHECK(store);
    ProvisionOrder order;
    order.from = museum_.stick();
    order.at = "2026-11-25T09:00:00Z";
    order.is_over = true;
    auto report = provision(order, &*store);
    CHECK(report);
    return *std::move(report);
  }
  void only(const std::string& name, const std::string& text) const {
    fs::remove_all(museum_.stick());
    fs::create_directories(museum_.stick());
    museum_.write(name, text);
  }

  MuseumStick museum_;
};

TEST_F(Offer, changes_its_files_and_keeps_all_others) {
  ASSERT_EQ(museum_.install().verdict, ProvisioningVerdict::kInstalled);
  const std::string pin = museum_.in_use("operator-pin");
  const std::string key = museum_.in_use("tls/key.pem");
  only("site.toml", MuseumStick::site("hall-4"));
  const ProvisioningReport report = install();
  EXPECT_THAT(report.problems, IsEmpty());
  EXPECT_THAT(report.remarks, IsEmpty());
  EXPECT_EQ(report.verdict, ProvisioningVerdict::kInstalled);
  EXPECT_EQ(report.museum, "hall-4");
  EXPECT_TRUE(report.has_pin);
  EXPECT_EQ(museum_.in_use("operator-pin"), pin);
  EXPECT_EQ(museum_.in_use("tls/key.pem"), key);
  EXPECT_THAT(museum_.in_use("installation.toml"), HasSubstr("HDMI-A-1"));
  EXPECT_EQ(install().verdict, ProvisioningVerdict::kUnchanged);
}

TEST_F(Offer, is_checked_with_all_that_it_leaves) {
  ASSERT_EQ(museum_.install().verdict, ProvisioningVerdict::kInstalled);
  only("site.toml", MuseumStick::site() + "[network]\nvlan = 4095\n");
  const ProvisioningReport report = install();
  EXPECT_EQ(report.verdict, ProvisioningVerdict::kRefused);
  EXPECT_THAT(report.problems, ElementsAre(HasSubstr("site.toml:12: network.vlan")));
  EXPECT_EQ(museum_.in_use("site.toml"), MuseumStick::site());
}

TEST_F(Offer, may_bring_the_first_pin_as_its_hash) {
  museum_.remove("operator.toml");
  ASSERT_EQ(museum_.install().verdict, ProvisioningVerdict::kInstalled);
  ASSERT_EQ(museum_.in_use("operator-pin"), "");
  const auto hash = hashed_pin("864209");
  ASSERT_TRUE(hash);
  only("operator-pin", *hash + "\n");
  EXPECT_EQ(install().verdict, ProvisioningVerdict::kInstalled);
  EXPECT_TRUE(*is_pin("864209", museum_.in_use("operator-pin")));
  only("operator-pin", "864209");
  EXPECT_THAT(install().problems, Contains(HasSubstr("this computer's own")));
  EXPECT_TRUE(*is_pin("864209", museum_.in_use("operator-pin")));
}

TEST_F(Offer, leaves_projectors_of_the_image_as_they_are_and_demands_connectors_of_its_own) {
  const std::filesystem::path source =
      std::getenv("CYCLORAMA_SOURCE") != nullptr ? std::getenv("CYCLORAMA_SOURCE") : ".";
  const auto demo = read_text_file(source / "demo/installation.toml", 1 << 20);
  ASSERT_TRUE(demo);
  museum_.write("installation.toml", *demo);
  {
    auto store = SettingsStore::open(museum_.root());
    ASSERT_TRUE(store);
    ProvisionOrder image;
    image.from = museum_.stick();
    image.check.for_any_computer = true;
    ASSERT_EQ(provision(image, &*store)->verdict, ProvisioningVerdict::kInstalled);
  }
  only("site.toml", MuseumStick::site("hall-4"));
  EXPECT_EQ(install().verdict, ProvisioningVerdict::kInstalled);
  EXPECT_EQ(museum_.in_use("any-computer"), "");
  EXPECT_FALSE(fs::exists(museum_.root() / "settings/any-computer"));
  only("installation.toml", *demo + "# changed\n");
  museum_.write("any-computer", "");
  EXPECT_THAT(install().problems, Contains(HasSubstr("has neither 'connector' nor 'serial'")));
}

TEST_F(Offer, makes_the_next_stick_one_that_somebody_has_to_answer_for) {
  ASSERT_EQ(museum_.install().verdict, ProvisioningVerdict::kInstalled) << "the image's own settings, for example";
  only("site.toml", MuseumStick::site("hall-4"));
  ASSERT_EQ(install().verdict, ProvisioningVerdict::kInstalled);
  auto store = SettingsStore::open(museum_.root());
  ASSERT_TRUE(store);
  ProvisionOrder stick;
  stick.from = museum_.stick();
  stick.is_stick = true;
  const auto report = provision(stick, &*store);
  ASSERT_TRUE(report);
  EXPECT_EQ(report->verdict, ProvisioningVerdict::kUnconfirmed);
}

}  // namespace
}  // namespace cyclorama::provision
