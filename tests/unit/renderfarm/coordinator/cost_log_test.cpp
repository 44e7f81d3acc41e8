// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/coordinator/cost_log.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <stdlib.h>

#include <fstream>

namespace cyclorama::coordinator {
namespace {

/// Deletes its folder after each test.
class CostLogTest : public testing::Test {
 protected:
  CostLogTest() { folder = mkdtemp(name.data()); }
  ~CostLogTest() override { std::filesystem::remove_all(folder); }

  static FrameReport frame(std::uint64_t session, float cost) {
    FrameReport report;
    report.session = SessionId{session};
    report.complete = true;
    report.view.set_samples(4);
    report.view.set_heading_rad(0.5);
    report.view.mutable_panorama()->set_width_px(64);
    report.view.mutable_panorama()->set_height_px(32);
    report.view.mutable_panorama()->set_azimuth_span_rad(2.0);
    report.costs = {{{0, 0, 32, 32}, 4.0 * cost, std::vector<float>(4, cost), 1.0},
                    {{32, 0, 32, 32}, 8.0 * cost, std::vector<float>(4, 2 * cost), 1.0}};
    return report;
  }
  [[nodiscard]] std::vector<std::filesystem::path> files() const {
    std::vector<std::filesystem::path> out;
    for (const auto& entry : std::filesystem::directory_iterator(folder / "costs")) out.push_back(entry.path());
    return out;
  }

  std::string name = "/tmp/cyclorama-costs-XXXXXX";
  std::filesystem::path folder;
  std::vector<std::string> notices;
};

TEST_F(CostLogTest, writes_one_record_per_session_of_whole_moving_frames) {
  {
    const auto log = CostLog::open(folder / "costs", [&](const std::string& s) { notices.push_back(s); });
    ASSERT_TRUE(log);
    for (int i = 0; i < 3; ++i) (*log)->add(frame(1, 0.25f));
    (*log)->add(frame(2, 1.0f));
    FrameReport at_rest = frame(2, 1.0f);
    at_rest.refined = true;
    (*log)->add(at_rest);
    FrameReport given_up = frame(2, 1.0f);
    given_up.complete = false;
    (*log)->add(given_up);
  }
  EXPECT_THAT(notices, testing::IsEmpty());
  std::vector<std::size_t> counts;
  for (const auto& file : files()) {
    const auto frames = balance::read_cost_record(file);
    ASSERT_TRUE(frames) << frames.error().message();
    counts.push_back(frames->size());
    EXPECT_DOUBLE_EQ(frames->front().heading_rad, 0.5);
    EXPECT_DOUBLE_EQ(frames->front().effort, 4.0);
  }
  EXPECT_THAT(counts, testing::UnorderedElementsAre(3u, 1u));
}

TEST_F(CostLogTest, reports_that_it_cannot_write) {
  std::ofstream(folder / "costs") << "a file";
  const auto log = CostLog::open(folder / "costs", [](const std::string&) {});
  ASSERT_FALSE(log);
  EXPECT_THAT(log.error().message(), testing::HasSubstr("costs"));
}

}  // namespace
}  // namespace cyclorama::coordinator
