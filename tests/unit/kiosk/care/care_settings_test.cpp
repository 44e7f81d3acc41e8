// SPDX-License-Identifier: Apache-2.0
#include "kiosk/care/care_settings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "common/base/file.h"

namespace cyclorama::care {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

class Folder {
 public:
  Folder() : path_(fs::path(::testing::TempDir()) / "care_settings_test") {
    fs::remove_all(path_);
    fs::create_directories(path_);
  }
  Result<CareSettings> read(const std::string& text) const {
    EXPECT_TRUE(write_file_atomically(path_ / kCareFile, std::string_view(text)));
    return read_care_settings(path_ / kCareFile);
  }
  [[nodiscard]] const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

constexpr const char* kMail =
    "[alarms.mail]\nserver = \"smtp.example.org:587\"\nfrom = \"wall@example.org\"\nto = [\"a@example.org\"]\n";

TEST(CareSettings, has_defaults_without_a_file) {
  const auto settings = read_care_settings(Folder().path() / "none.toml");
  ASSERT_TRUE(settings);
  EXPECT_EQ(settings->language, "");
  EXPECT_FALSE(settings->alarms.has_receiver());
}

TEST(CareSettings, reads_language_alarms_and_quiet_hours) {
  const Folder folder;
  std::string text = "language = \"fr\"\n[alarms]\nafter_s = 30\nquiet = \"22:00-07:30\"\n";
  text += kMail;
  text += "user = \"wall\"\npassword_file = \"mail-password\"\n";
  const auto settings = folder.read(text);
  ASSERT_TRUE(settings) << settings.error().message();
  EXPECT_EQ(settings->language, "fr");
  EXPECT_EQ(settings->alarms.after, std::chrono::seconds(30));
  ASSERT_TRUE(settings->alarms.mail);
  EXPECT_EQ(settings->alarms.mail->security, MailSecurity::kStartTls);
  EXPECT_EQ(settings->alarms.mail->password_file, folder.path() / "mail-password");
  ASSERT_TRUE(settings->alarms.quiet);
  EXPECT_TRUE(settings->alarms.quiet->contains(22 * 60));
  EXPECT_TRUE(settings->alarms.quiet->contains(0));
  EXPECT_TRUE(settings->alarms.quiet->contains(7 * 60 + 29));
  EXPECT_FALSE(settings->alarms.quiet->contains(7 * 60 + 30));
  EXPECT_FALSE(settings->alarms.quiet->contains(12 * 60));
}

TEST(CareSettings, refuses_bad_values_with_file_line_and_remedy) {
  const Folder folder;
  const std::string alarms = "[alarms]\n";
  const std::pair<std::string, std::string> kBad[] = {
      {"language = \"tlh\"\n", "care.toml:1"},
      {"langauge = \"de\"\n", "langauge"},
      {alarms + "quiet = \"22:00\"\n", "\"22:00-07:00\""},
      {alarms + "quiet = \"22:00-22:00\"\n", "two different times"},
      {alarms + "quiet = \"25:00-07:00\"\n", "two different times"},
      {alarms + "after_s = 1\n", "after_s"},
      {alarms + "level = \"all\"\n", "level"},
      {alarms + "[alarms.mail]\nserver = \"smtp.example.org\"\nfrom = \"w@e.org\"\nto = [\"a@e.org\"]\n", "HOST:PORT"},
      {alarms + kMail + "security = \"none\"\n", "only for a server on this computer"},
      {alarms + kMail + "user = \"wall\"\n", "belong together"},
      {alarms + "[alarms.mail]\nserver = \"[::1]:25\"\nfrom = \"w@e.org\\r\\nBcc: x@y\"\nto = [\"a@e.org\"]\n",
       "mail address"},
      {alarms + "[alarms.mail]\nserver = \"[::1]:25\"\nfrom = \"w@e.org\"\nto = []\n", "1 to 20"},
      {alarms + "[alarms.mail]\nserver = \"[::1]:25\"\nfrom = \"w@e.org\"\nto = [\"nobody\"]\n", "mail addresses"},
      {alarms + "[alarms.webhook]\nurl = \"ftp://example.org/\"\n", "https://"},
      {alarms + "[alarms.webhook]\nurl = \"http://example.org/\"\n", "must begin with https://"},
      {alarms + "[alarms.webhook]\nurl = \"https://user:secret@example.org/\"\n", "must be an address"},
      {alarms + "[alarms.webhook]\n", "url"},
  };
  for (const auto& [text, words] : kBad) {
    const auto settings = folder.read(text);
    ASSERT_FALSE(settings) << text;
    EXPECT_THAT(settings.error().message(), HasSubstr(words)) << text;
    EXPECT_THAT(settings.error().message(), HasSubstr("care.toml")) << text;
  }
}

TEST(CareSettings, takes_plain_http_and_no_encryption_on_this_computer_alone) {
  const Folder folder;
  EXPECT_TRUE(folder.read("[alarms.webhook]\nurl = \"http://[::1]:9000/x\"\n"));
  EXPECT_TRUE(folder.read("[alarms.webhook]\nurl = \"http://localhost/x\"\n"));
  EXPECT_TRUE(folder.read(
      "[alarms.mail]\nserver = \"[::1]:25\"\nsecurity = \"none\"\nfrom = \"w@e.org\"\nto = [\"a@e.org\"]\n"));
}

TEST(ReadSecret, takes_the_first_line_and_refuses_an_empty_one) {
  const Folder folder;
  const fs::path file = folder.path() / "secret";
  ASSERT_TRUE(write_file_atomically(file, std::string_view("s3cret word\r\nnotes\n")));
  EXPECT_EQ(*read_secret(file), "s3cret word");
  ASSERT_TRUE(write_file_atomically(file, std::string_view("\n")));
  ASSERT_FALSE(read_secret(file));
  EXPECT_THAT(read_secret(file).error().message(), HasSubstr("'secret'"));
  ASSERT_TRUE(write_file_atomically(file, std::string_view("a\tb\n")));
  EXPECT_FALSE(read_secret(file));
}

}  // namespace
}  // namespace cyclorama::care
