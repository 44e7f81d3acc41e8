// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/trust/audit_log.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <nlohmann/json.hpp>
#include <sstream>

#include "common/base/file.h"
#include "tests/data_sets/scene_folder.h"

namespace cyclorama::trust {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr Duration kTimeout = std::chrono::seconds(20);

class AuditLogTest : public testing::Test {
 protected:
  void open(std::uint64_t max_bytes = AuditLog::kMaxBytes) {
    auto opened = AuditLog::open(path, max_bytes);
    ASSERT_TRUE(opened) << opened.error().message();
    log = *std::move(opened);
  }
  Status write(const std::string& reason) { return log->write({.event = "session refused", .reason = reason}); }
  /// Returns the reasons of a file's lines, each of which must be complete.
  static std::vector<std::string> reasons(const std::filesystem::path& file) {
    const auto text = read_text_file(file, 1 << 20);
    EXPECT_TRUE(text);
    std::vector<std::string> found;
    std::istringstream lines(text ? *text : "");
    for (std::string line; std::getline(lines, line);) {
      const auto json = nlohmann::json::parse(line, nullptr, false);
      EXPECT_FALSE(json.is_discarded()) << line;
      found.push_back(json.value("reason", ""));
    }
    return found;
  }

  TemporaryFolder temporary;
  const std::filesystem::path path = temporary.path() / "audit.jsonl";
  const std::filesystem::path previous = temporary.path() / "audit.jsonl.1";
  std::unique_ptr<AuditLog> log;
};

TEST_F(AuditLogTest, appends_to_an_existing_file_and_starts_a_new_one_after_a_rename) {
  open();
  EXPECT_TRUE(write("a"));
  log.reset();
  open();
  EXPECT_TRUE(write("b"));
  std::filesystem::rename(path, previous);
  EXPECT_TRUE(write("c"));
  EXPECT_THAT(reasons(previous), ElementsAre("a", "b"));
  EXPECT_THAT(reasons(path), ElementsAre("c"));
}

TEST_F(AuditLogTest, keeps_one_previous_file_and_never_exceeds_its_limit) {
  open(300);  // About three lines.
  for (int i = 10; i < 30; ++i) {
    EXPECT_TRUE(write(std::to_string(i)));
    EXPECT_LE(std::filesystem::file_size(path), 300u);
  }
  std::vector<std::string> last = reasons(previous);
  EXPECT_THAT(last, testing::SizeIs(testing::Ge(2u)));
  for (const std::string& reason : reasons(path)) last.push_back(reason);
  for (std::size_t i = 0; i < last.size(); ++i) EXPECT_EQ(last[i], std::to_string(30 - last.size() + i));
  const auto files = std::distance(std::filesystem::directory_iterator(temporary.path()), {});
  EXPECT_EQ(files, 2);
  EXPECT_TRUE(log->wait_for_disk(kTimeout)) << "files that were left are kept too";
}

TEST_F(AuditLogTest, grows_with_a_report_if_it_cannot_be_renamed) {
  open(100);  // One line.
  EXPECT_TRUE(write("a"));
  std::filesystem::create_directory(previous);
  EXPECT_TRUE(write_file_atomically(previous / "in the way", std::string("x")));
  EXPECT_FALSE(write("b"));
  EXPECT_THAT(write("c").error().message(), HasSubstr("moving the full audit log"));
  EXPECT_THAT(reasons(path), ElementsAre("a", "b", "c"));
}

TEST_F(AuditLogTest, writes_its_lines_to_disk_soon) {
  open();
  for (const char* const reason : {"a", "b"}) {
    EXPECT_TRUE(write(reason));
    EXPECT_TRUE(log->wait_for_disk(kTimeout));
  }
  EXPECT_TRUE(write("c"));
  log.reset();
  EXPECT_THAT(reasons(path), ElementsAre("a", "b", "c"));
}

TEST_F(AuditLogTest, leaves_no_partial_line_when_the_disk_is_full) {
  open();
  EXPECT_TRUE(write("a"));
  const auto size = std::filesystem::file_size(path);
  struct ::rlimit before {};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  struct ::rlimit full = before;
  full.rlim_cur = size + 20;
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &full), 0);
  const Status refused = write("b");
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &before), 0);
  std::signal(SIGXFSZ, handler);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message(), HasSubstr("audit.jsonl' is full"));
  EXPECT_EQ(std::filesystem::file_size(path), size);
  EXPECT_TRUE(write("c"));
  EXPECT_THAT(reasons(path), ElementsAre("a", "c"));
}

TEST(AuditDevice, refuses_each_line_when_full_and_is_never_renamed) {
  const auto log = AuditLog::open("/dev/full", 1);
  ASSERT_TRUE(log);
  for (int i = 0; i < 3; ++i)
    EXPECT_THAT((*log)->write({.event = "node came"}).error().message(), HasSubstr("/dev/full"));
  EXPECT_TRUE(std::filesystem::is_character_file("/dev/full"));
}

}  // namespace
}  // namespace cyclorama::trust
