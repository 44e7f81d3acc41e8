// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/balance/cost_record.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <limits>

#include "common/base/file.h"

namespace cyclorama::balance {
namespace {

using testing::HasSubstr;

class CostRecord : public testing::Test {
 protected:
  CostRecord() { std::filesystem::create_directories(folder_); }
  ~CostRecord() override { std::filesystem::remove_all(folder_); }

  static RecordedFrame frame(PictureSize size, float work) {
    return {WorkGrid(size, work), 0.5, 1.2, {1.0, 1.6, -3.0}, 2.0};
  }
  std::vector<std::byte> written(const std::vector<RecordedFrame>& frames) {
    auto recorder = CostRecorder::create(path_);
    EXPECT_TRUE(recorder);
    for (const RecordedFrame& f : frames) EXPECT_TRUE(recorder->add(f));
    auto bytes = read_file(path_, kMaxRecordBytes);
    std::filesystem::remove(path_);
    return *bytes;
  }

  std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("cost_record." + std::to_string(::getpid()));
  std::filesystem::path path_ = folder_ / "one.costs";
};

TEST_F(CostRecord, survives_a_round_trip) {
  auto recorder = CostRecorder::create(path_);
  ASSERT_TRUE(recorder);
  RecordedFrame first = frame({100, 40}, 0.25f);
  first.work.at(6, 2) = 3.0f;
  ASSERT_TRUE(recorder->add(first));
  ASSERT_TRUE(recorder->add(frame({17, 16}, 0.0f)));
  const auto frames = read_cost_record(path_);
  ASSERT_TRUE(frames);
  ASSERT_EQ(frames->size(), 2u);
  const RecordedFrame& back = frames->front();
  EXPECT_EQ(back.work.size(), (PictureSize{100, 40}));
  EXPECT_TRUE(std::ranges::equal(back.work.cells(), first.work.cells()));
  EXPECT_EQ(back.heading_rad, 0.5);
  EXPECT_EQ(back.azimuth_span_rad, 1.2);
  EXPECT_EQ(back.eye_m, first.eye_m);
  EXPECT_EQ(back.effort, 2.0);
  EXPECT_EQ((*frames)[1].work.columns(), 2);
}

TEST_F(CostRecord, contains_what_nodes_measured) {
  auto recorder = CostRecorder::create(path_);
  ASSERT_TRUE(recorder);
  // The second node is twice as fast; the third quarter was not reported.
  const std::vector<MeasuredBlock> blocks{{{0, 0, 16, 32}, 3.0, {1.0f, 2.0f}, 1.0},
                                          {{16, 0, 16, 16}, 4.0, {4.0f}, 2.0}};
  ASSERT_TRUE(recorder->add(frame({}, 0.0f), {32, 32}, blocks));
  const auto frames = read_cost_record(path_);
  ASSERT_TRUE(frames);
  EXPECT_THAT(frames->front().work.cells(), testing::ElementsAre(1.0f, 8.0f, 2.0f, 0.0f));
}

TEST_F(CostRecord, is_read_up_to_its_last_complete_frame_wherever_it_was_cut) {
  const auto one = written({frame({48, 32}, 1.0f)});
  const auto two = written({frame({48, 32}, 1.0f), frame({48, 32}, 2.0f)});
  for (std::size_t length = 8; length <= two.size(); ++length) {
    const auto frames = parse_cost_record(std::span(two).first(length), "cut");
    ASSERT_TRUE(frames) << length;
    EXPECT_EQ(frames->size(), length < one.size() ? 0u : length < two.size() ? 1u : 2u) << length;
  }
  for (std::size_t length = 0; length < 8; ++length) {
    EXPECT_FALSE(parse_cost_record(std::span(two).first(length), "cut")) << length;
  }
}

TEST_F(CostRecord, refuses_invalid_files_in_one_sentence) {
  const auto good = written({frame({48, 32}, 1.0f)});
  const auto with = [&](std::size_t at, auto value) {
    auto bytes = good;
    std::memcpy(bytes.data() + at, &value, sizeof value);
    const auto frames = parse_cost_record(bytes, "visit.costs");
    return frames ? std::string("accepted") : frames.error().message();
  };
  EXPECT_THAT(with(0, 'X'), HasSubstr("not a record of costs"));
  EXPECT_THAT(with(8, std::uint32_t{10}), HasSubstr("'visit.costs', frame 0 at byte 8: it is too short"));
  EXPECT_THAT(with(12, std::uint32_t{0}), HasSubstr("1 to 16384"));
  EXPECT_THAT(with(12, std::uint32_t{4000000000}), HasSubstr("1 to 16384"));
  EXPECT_THAT(with(12, std::uint32_t{16384}), HasSubstr("does not fit"));
  EXPECT_THAT(with(20, std::numeric_limits<double>::quiet_NaN()), HasSubstr("heading"));
  EXPECT_THAT(with(28, -0.5), HasSubstr("span"));
  EXPECT_THAT(with(36, std::numeric_limits<double>::infinity()), HasSubstr("eye"));
  EXPECT_THAT(with(60, -1.0), HasSubstr("effort"));
  EXPECT_THAT(with(68, -1.0f), HasSubstr("work"));
  EXPECT_THAT(with(68, std::numeric_limits<float>::quiet_NaN()), HasSubstr("work"));
}

TEST_F(CostRecord, is_never_overwritten) {
  ASSERT_TRUE(CostRecorder::create(path_));
  const auto again = CostRecorder::create(path_);
  ASSERT_FALSE(again);
  EXPECT_EQ(again.error().code(), ErrorCode::kBusy);
  EXPECT_EQ(CostRecorder::create(folder_ / "no" / "such.costs").error().code(), ErrorCode::kNotFound);
}

TEST_F(CostRecord, refuses_a_frame_that_could_not_be_read_again) {
  auto recorder = CostRecorder::create(path_);
  ASSERT_TRUE(recorder);
  EXPECT_EQ(recorder->add(frame({0, 32}, 1.0f)).error().code(), ErrorCode::kInvalidArgument);
  EXPECT_FALSE(recorder->add(frame({32, 32}, std::numeric_limits<float>::infinity())));
  EXPECT_FALSE(recorder->add(frame({32, 32}, -1.0f)));
  ASSERT_TRUE(recorder->add(frame({32, 32}, 1.0f)));
  EXPECT_EQ(read_cost_record(path_)->size(), 1u);
}

}  // namespace
}  // namespace cyclorama::balance
