// SPDX-License-Identifier: Apache-2.0
#include "drivers/output/shared_picture.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <fstream>
#include <thread>

namespace cyclorama::output {
namespace {

class SharedPicture : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string folder = ::testing::TempDir() + "/shared_picture.XXXXXX";
    ASSERT_NE(::mkdtemp(folder.data()), nullptr);
    folder_ = folder;
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  std::filesystem::path folder_;
};

/// All pixels of picture n are equal, so that a torn picture is detected.
RgbImage plain(int width, int height, std::uint64_t n) {
  return RgbImage(width, height, static_cast<std::uint8_t>(n % 251));
}

TEST_F(SharedPicture, returns_what_was_published) {
  const auto path = shared_picture_path(folder_, "left");
  EXPECT_EQ(path.filename(), "head-left.picture");
  auto writer = SharedPictureWriter::create(path, 5, 3);  // 45 bytes: the last word is only partly used.
  ASSERT_TRUE(writer) << writer.error().message();
  RgbImage picture(5, 3);
  for (std::size_t i = 0; i < picture.data().size(); ++i) picture.data()[i] = static_cast<std::uint8_t>(i * 5 + 1);
  auto reader = SharedPictureReader::open(path);
  ASSERT_TRUE(reader) << reader.error().message();
  EXPECT_EQ(reader->width(), 5);
  EXPECT_EQ(reader->height(), 3);

  RgbImage seen;
  const auto nothing_yet = reader->read_newest(&seen);
  ASSERT_FALSE(nothing_yet);
  EXPECT_EQ(nothing_yet.error().code(), ErrorCode::kUnavailable);

  for (std::uint64_t n = 1; n <= 3; ++n) {
    *picture.at(0, 0) = static_cast<std::uint8_t>(n);
    writer->publish(picture, {0, 40 + n, from_nanoseconds(1234567890123)});
    const auto info = reader->read_newest(&seen);
    ASSERT_TRUE(info) << info.error().message();
    EXPECT_EQ(seen, picture);
    EXPECT_EQ(info->picture, n);
    EXPECT_EQ(info->refresh, 40 + n);
    EXPECT_EQ(to_nanoseconds(info->presented_at), 1234567890123);
  }
}

TEST_F(SharedPicture, reports_that_its_writer_is_gone_or_was_replaced) {
  const auto path = shared_picture_path(folder_, "left");
  auto reader = [&] {
    auto writer = SharedPictureWriter::create(path, 4, 4);
    EXPECT_TRUE(writer);
    writer->publish(plain(4, 4, 7), {});
    auto opened = SharedPictureReader::open(path);
    RgbImage seen;
    EXPECT_TRUE(opened->read_newest(&seen));
    return opened;
  }();
  RgbImage seen;
  ASSERT_FALSE(reader->read_newest(&seen));
  EXPECT_EQ(reader->read_newest(&seen).error().code(), ErrorCode::kUnavailable);

  auto second = SharedPictureWriter::create(path, 8, 2);
  ASSERT_TRUE(second);
  second->publish(plain(8, 2, 9), {});
  EXPECT_EQ(reader->read_newest(&seen).error().code(), ErrorCode::kUnavailable);
  auto again = SharedPictureReader::open(path);
  ASSERT_TRUE(again);
  ASSERT_TRUE(again->read_newest(&seen));
  EXPECT_EQ(seen, plain(8, 2, 9));
}

TEST_F(SharedPicture, is_never_seen_torn) {
  constexpr int kWidth = 97;
  constexpr int kHeight = 61;
  const auto path = shared_picture_path(folder_, "middle");
  auto writer = SharedPictureWriter::create(path, kWidth, kHeight);
  ASSERT_TRUE(writer);
  writer->publish(plain(kWidth, kHeight, 1), {0, 1, {}});
  std::atomic<bool> enough{false};
  std::jthread publishing([&] {
    for (std::uint64_t n = 2; !enough; ++n)
      writer->publish(plain(kWidth, kHeight, n), {0, n, from_nanoseconds(static_cast<std::int64_t>(n))});
  });
  auto reader = SharedPictureReader::open(path);
  ASSERT_TRUE(reader);
  RgbImage seen;
  std::uint64_t newest = 0;
  int whole = 0;
  for (int i = 0; i < 3000; ++i) {
    const auto info = reader->read_newest(&seen);
    if (!info) {
      // A writer without pauses may overtake the reader, which must then return kBusy.
      ASSERT_EQ(info.error().code(), ErrorCode::kBusy);
      continue;
    }
    ++whole;
    ASSERT_GE(info->picture, newest);
    newest = info->picture;
    ASSERT_EQ(info->refresh, info->picture);
    ASSERT_EQ(*seen.at(0, 0), static_cast<std::uint8_t>(newest % 251));
    ASSERT_TRUE(std::ranges::all_of(seen.data(), [&](std::uint8_t v) { return v == *seen.at(0, 0); }));
  }
  enough = true;
  EXPECT_GT(whole, 100);
  EXPECT_GT(newest, 1U);
}

TEST_F(SharedPicture, refuses_other_files) {
  EXPECT_EQ(SharedPictureReader::open(folder_ / "absent").error().code(), ErrorCode::kNotFound);
  EXPECT_EQ(SharedPictureReader::open(folder_).error().code(), ErrorCode::kBadData);
  std::ofstream(folder_ / "empty");
  EXPECT_EQ(SharedPictureReader::open(folder_ / "empty").error().code(), ErrorCode::kBadData);
  std::ofstream(folder_ / "text") << std::string(1000, 'x');
  EXPECT_EQ(SharedPictureReader::open(folder_ / "text").error().code(), ErrorCode::kBadData);

  const auto path = shared_picture_path(folder_, "cut");
  { ASSERT_TRUE(SharedPictureWriter::create(path, 64, 64)); }
  std::filesystem::resize_file(path, 4096);
  EXPECT_EQ(SharedPictureReader::open(path).error().code(), ErrorCode::kBadData);
}

TEST_F(SharedPicture, refuses_invalid_sizes_and_folders) {
  for (const auto& [width, height] : {std::pair{0, 4}, {4, -1}, {16385, 1}}) {
    EXPECT_EQ(SharedPictureWriter::create(folder_ / "x", width, height).error().code(), ErrorCode::kInvalidArgument);
  }
  EXPECT_EQ(SharedPictureWriter::create(folder_ / "no" / "x", 4, 4).error().code(), ErrorCode::kNotFound);
  EXPECT_TRUE(std::filesystem::is_empty(folder_));
}

TEST_F(SharedPicture, keeps_unusual_head_names_distinct_and_inside_the_folder) {
  EXPECT_EQ(shared_picture_path(folder_, "a/../b").parent_path(), folder_);
  EXPECT_NE(shared_picture_path(folder_, "a b"), shared_picture_path(folder_, "a_b"));
}

}  // namespace
}  // namespace cyclorama::output
