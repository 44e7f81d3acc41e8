// SPDX-License-Identifier: Apache-2.0
/// Tests which USB sticks may change a museum.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "kiosk/provision/owner_key.h"
#include "tests/support/museum_stick.h"

namespace cyclorama::provision {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::Contains;
using testing::Each;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

/// A museum, and its owner, who signs sticks on another computer.
class Museum {
 public:
  [[nodiscard]] ProvisioningReport plug_in(const std::string& confirmed = "") const {
    auto store = SettingsStore::open(stick_.root());
    CHECK(store);
    ProvisionOrder order{stick_.stick(), {}, {}, false, "2026-11-22T16:04:05Z"};
    order.is_stick = true;
    order.confirmed = confirmed;
    auto report = provision(order, &*store);
    CHECK(report);
    return *std::move(report);
  }
  [[nodiscard]] fs::path key(const std::string& name) const { return stick_.root() / (name + ".key"); }
  void sign(const std::string& name = "owner") const { EXPECT_TRUE(sign_stick(stick_.stick(), key(name))); }
  void unsign() const {
    for (const char* const name : {kChecksumsFile, kSignatureFile, kOwnerKeyFile}) stick_.remove(name);
  }
  void change(const std::string& name) const { stick_.write("site.toml", MuseumStick::site(name)); }
  [[nodiscard]] std::string in_use() const { return stick_.in_use("site.toml"); }
  [[nodiscard]] const MuseumStick& stick() const { return stick_; }

 private:
  MuseumStick stick_;
};

TEST(StickTrust, trusts_the_first_stick_and_then_the_owners) {
  const Museum museum;
  museum.sign();
  EXPECT_EQ(museum.plug_in().verdict, ProvisioningVerdict::kInstalled);
  for (const char* const name : {kChecksumsFile, kSignatureFile, kOwnerKeyFile}) {
    EXPECT_EQ(museum.stick().in_use(name), "") << "it is no setting: " << name;
  }
  EXPECT_EQ(museum.plug_in().verdict, ProvisioningVerdict::kUnchanged);
  museum.change("hall-4");
  museum.sign();
  EXPECT_EQ(museum.plug_in().verdict, ProvisioningVerdict::kInstalled);
  EXPECT_THAT(museum.in_use(), HasSubstr("hall-4"));
}

TEST(StickTrust, parses_nothing_of_an_unconfirmed_stick) {
  const Museum museum;
  museum.sign();
  ASSERT_EQ(museum.plug_in().verdict, ProvisioningVerdict::kInstalled);
  const std::string before = museum.in_use();
  museum.stick().write("site.toml", "[farm\ncoordinators = 7\n");
  const auto refused = [&](const char* why) {
    const ProvisioningReport report = museum.plug_in();
    EXPECT_EQ(report.verdict, ProvisioningVerdict::kUnconfirmed);
    EXPECT_THAT(report.problems, AllOf(testing::SizeIs(1), Each(HasSubstr(why))));
    EXPECT_THAT(report.problems, Each(Not(HasSubstr("site.toml")))) << "no parser has seen it";
    EXPECT_EQ(report.digest.size(), 64u);
    EXPECT_EQ(museum.in_use(), before);
    return report.digest;
  };
  const std::string changed = refused("changed after it was signed");
  museum.unsign();
  EXPECT_NE(refused("not signed"), changed);
  museum.sign("visitor");
  refused("another key than the owner's");
  museum.stick().write("owner.pub", "no key");
  refused("changed after it was signed");
}

TEST(StickTrust, wants_every_file_under_the_signature) {
  const Museum museum;
  museum.sign();
  ASSERT_EQ(museum.plug_in().verdict, ProvisioningVerdict::kInstalled);
  museum.stick().write("wand.toml", "added by a visitor");
  EXPECT_EQ(museum.plug_in().verdict, ProvisioningVerdict::kUnconfirmed);
  museum.stick().remove("wand.toml");
  museum.stick().write("tracker.toml", "[camera]\nkind = \"film\"\n");
  EXPECT_EQ(museum.plug_in().verdict, ProvisioningVerdict::kUnconfirmed);
}

TEST(StickTrust, takes_exactly_the_content_that_was_confirmed) {
  const Museum museum;
  museum.sign();
  ASSERT_EQ(museum.plug_in().verdict, ProvisioningVerdict::kInstalled);
  museum.unsign();
  museum.change("hall-5");
  const std::string digest = museum.plug_in().digest;
  museum.change("hall-6");
  EXPECT_EQ(museum.plug_in(digest).verdict, ProvisioningVerdict::kUnconfirmed) << "the stick was exchanged";
  museum.change("hall-5");
  EXPECT_EQ(museum.plug_in(digest).verdict, ProvisioningVerdict::kInstalled);
  museum.change("hall-7");
  EXPECT_EQ(museum.plug_in().verdict, ProvisioningVerdict::kUnconfirmed) << "the owner's key stays";
  museum.sign();
  EXPECT_EQ(museum.plug_in().verdict, ProvisioningVerdict::kInstalled);
}

TEST(StickTrust, takes_a_new_owner_with_a_confirmed_stick) {
  const Museum museum;
  museum.sign();
  ASSERT_EQ(museum.plug_in().verdict, ProvisioningVerdict::kInstalled);
  museum.change("hall-5");
  museum.sign("successor");
  EXPECT_EQ(museum.plug_in(museum.plug_in().digest).verdict, ProvisioningVerdict::kInstalled);
  museum.change("hall-6");
  museum.sign("successor");
  EXPECT_EQ(museum.plug_in().verdict, ProvisioningVerdict::kInstalled);
  museum.sign();
  EXPECT_EQ(museum.plug_in().verdict, ProvisioningVerdict::kUnconfirmed);
}

TEST(StickTrust, asks_on_the_page_when_the_first_stick_had_no_key) {
  const Museum museum;
  ASSERT_EQ(museum.plug_in().verdict, ProvisioningVerdict::kInstalled);
  museum.change("hall-4");
  const ProvisioningReport report = museum.plug_in();
  EXPECT_EQ(report.verdict, ProvisioningVerdict::kUnconfirmed);
  EXPECT_THAT(report.problems, Contains(HasSubstr("confirm it on the operator page")));
  museum.sign();
  EXPECT_EQ(museum.plug_in().verdict, ProvisioningVerdict::kUnconfirmed) << "anybody can sign";
  EXPECT_EQ(museum.plug_in(museum.plug_in().digest).verdict, ProvisioningVerdict::kInstalled);
  museum.change("hall-5");
  museum.sign();
  EXPECT_EQ(museum.plug_in().verdict, ProvisioningVerdict::kInstalled) << "the confirmed stick named the owner";
}

TEST(StickTrust, warns_when_nobody_could_answer) {
  const Museum museum;
  museum.stick().remove("operator.toml");
  ASSERT_EQ(museum.plug_in().verdict, ProvisioningVerdict::kInstalled);
  museum.change("hall-4");
  const ProvisioningReport report = museum.plug_in();
  EXPECT_EQ(report.verdict, ProvisioningVerdict::kInstalled);
  EXPECT_THAT(report.remarks, Contains(HasSubstr("takes anybody's stick")));
}

TEST(StickTrust, does_not_concern_what_is_no_stick) {
  const Museum museum;
  museum.sign();
  ASSERT_EQ(museum.plug_in().verdict, ProvisioningVerdict::kInstalled);
  museum.unsign();
  museum.change("hall-4");
  EXPECT_EQ(museum.stick().install().verdict, ProvisioningVerdict::kInstalled) << "such as the boot partition's folder";
}

TEST(StickTrust, a_refused_first_stick_is_not_the_first) {
  const Museum museum;
  museum.stick().write("site.toml", "[farm\n");
  EXPECT_EQ(museum.plug_in().verdict, ProvisioningVerdict::kRefused);
  museum.change("hall-3");
  museum.sign();
  EXPECT_EQ(museum.plug_in().verdict, ProvisioningVerdict::kInstalled);
}

TEST(OwnerKey, is_made_once_and_kept_private) {
  const Museum museum;
  museum.sign();
  struct stat info {};
  ASSERT_EQ(::stat(museum.key("owner").c_str(), &info), 0);
  EXPECT_EQ(info.st_mode & 0777, 0600u);
  const auto before = read_text_file(museum.key("owner"), 1000);
  museum.sign();
  EXPECT_EQ(*before, *read_text_file(museum.key("owner"), 1000));
  ASSERT_TRUE(write_file_atomically(museum.key("broken"), std::string_view("no key")));
  const Status signed_with = sign_stick(museum.stick().stick(), museum.key("broken"));
  ASSERT_FALSE(signed_with);
  EXPECT_EQ(signed_with.error().code(), ErrorCode::kBadData);
  EXPECT_THAT(signed_with.error().message(), HasSubstr("name another file"));
  EXPECT_FALSE(sign_stick(museum.stick().root() / "nowhere", museum.key("owner")));
}

TEST(OwnerKey, accepts_no_signature_that_is_damaged) {
  const Museum museum;
  museum.sign();
  const auto file = [&](const char* name) { return *read_text_file(museum.stick().stick() / name, 1 << 20); };
  const std::string sums = file(kChecksumsFile), signature = file(kSignatureFile), key = file(kOwnerKeyFile);
  EXPECT_TRUE(is_signed_by(sums, signature, key));
  EXPECT_TRUE(is_signed_by(sums, signature.substr(0, 88) + "\r\n", key)) << "as other computers end lines";
  EXPECT_FALSE(is_signed_by(sums + "\n", signature, key));
  for (std::size_t i = 0; i < 85; ++i) {  // The next letter has four bits of padding.
    std::string other = signature;
    other[i] = other[i] == 'A' ? 'B' : 'A';
    EXPECT_FALSE(is_signed_by(sums, other, key)) << i;
  }
  for (const std::string& bad : {std::string(), std::string("="), signature.substr(0, 87), signature + signature,
                                 std::string(88, '='), std::string(88, '\0')}) {
    EXPECT_FALSE(is_signed_by(sums, bad, key));
  }
  EXPECT_FALSE(is_signed_by(sums, signature, ""));
  EXPECT_FALSE(is_signed_by(sums, signature, "-----BEGIN PUBLIC KEY-----\n"));
}

}  // namespace
}  // namespace cyclorama::provision
