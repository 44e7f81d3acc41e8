// SPDX-License-Identifier: Apache-2.0
#include "common/base/file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cstdlib>

namespace cyclorama {
namespace {

using ::testing::HasSubstr;

class FileTest : public ::testing::Test {
 protected:
  FileTest() {
    std::string pattern = (std::filesystem::temp_directory_path() / "file_test.XXXXXX").string();
    folder_ = ::mkdtemp(pattern.data());
  }
  ~FileTest() override { std::filesystem::remove_all(folder_); }
  std::filesystem::path folder_;
};

TEST_F(FileTest, reads_what_was_written) {
  const auto path = folder_ / "a";
  ASSERT_TRUE(write_file_atomically(path, std::string_view("wall\0paper", 10)).has_value());
  const auto text = read_text_file(path, 10);
  ASSERT_TRUE(text.has_value());
  EXPECT_EQ(*text, std::string("wall\0paper", 10));
  const auto mapped = MappedFile::open(path);
  ASSERT_TRUE(mapped.has_value());
  EXPECT_EQ(mapped->bytes().size(), 10u);
}

TEST_F(FileTest, reads_and_maps_an_empty_file) {
  ASSERT_TRUE(write_file_atomically(folder_ / "empty", std::string_view()).has_value());
  EXPECT_EQ(*read_text_file(folder_ / "empty", 0), "");
  EXPECT_TRUE(MappedFile::open(folder_ / "empty")->bytes().empty());
}

TEST_F(FileTest, refuses_oversized_missing_and_special_files_by_name) {
  ASSERT_TRUE(write_file_atomically(folder_ / "large", std::string_view("12345")).has_value());
  const auto large = read_text_file(folder_ / "large", 4);
  ASSERT_FALSE(large.has_value());
  EXPECT_EQ(large.error().code(), ErrorCode::kBadData);
  EXPECT_THAT(large.error().message(), HasSubstr("large"));

  EXPECT_EQ(read_file(folder_ / "missing", 1).error().code(), ErrorCode::kNotFound);
  EXPECT_EQ(read_file(folder_, 1).error().code(), ErrorCode::kBadData);  // A folder.
  ASSERT_EQ(::mkfifo((folder_ / "pipe").c_str(), 0600), 0);
  EXPECT_EQ(read_file(folder_ / "pipe", 1).error().code(), ErrorCode::kBadData);  // Must not hang.
}

TEST_F(FileTest, a_failed_write_leaves_only_the_old_file) {
  ASSERT_TRUE(write_file_atomically(folder_ / "kept", std::string_view("old")).has_value());
  std::filesystem::create_directory(folder_ / "taken");
  EXPECT_FALSE(write_file_atomically(folder_ / "taken", std::string_view("new")).has_value());
  EXPECT_FALSE(write_file_atomically(folder_ / "nowhere" / "x", std::string_view("new")).has_value());
  EXPECT_EQ(*read_text_file(folder_ / "kept", 99), "old");
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_), {}), 2);
}

}  // namespace
}  // namespace cyclorama
