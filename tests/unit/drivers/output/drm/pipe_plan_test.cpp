// SPDX-License-Identifier: Apache-2.0
#include "drivers/output/drm/pipe_plan.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

namespace cyclorama::output {
namespace {

using Crtcs = std::vector<std::optional<std::size_t>>;
using ::testing::ElementsAre;

TEST(PipePlan, reassigns_crtcs_so_that_every_connector_gets_one) {
  const std::vector<std::uint32_t> possible{0b11, 0b01};
  EXPECT_THAT(assign_crtcs(possible), ElementsAre(1, 0));
}

TEST(PipePlan, leaves_the_last_connectors_dark_if_there_are_too_few) {
  const std::vector<std::uint32_t> possible{0b11, 0b11, 0b11};
  const Crtcs assigned = assign_crtcs(possible);
  EXPECT_TRUE(assigned[0] && assigned[1] && *assigned[0] != *assigned[1]);
  EXPECT_FALSE(assigned[2]);
  EXPECT_THAT(assign_crtcs(std::vector<std::uint32_t>{0, 1U << 31}), ElementsAre(std::nullopt, 31));
}

TEST(PipePlan, keeps_assignments_unless_another_connector_would_go_dark) {
  const std::vector<std::uint32_t> possible{0b111, 0b111};
  EXPECT_THAT(assign_crtcs(possible, Crtcs{2, 1}), ElementsAre(2, 1));
  EXPECT_THAT(assign_crtcs(std::vector<std::uint32_t>{0b111, 0b111, 0b111}, Crtcs{0, std::nullopt, 1}),
              ElementsAre(0, 2, 1));
  const std::vector<std::uint32_t> narrow{0b111, 0b100};
  const Crtcs moved = assign_crtcs(narrow, Crtcs{2, std::nullopt});
  EXPECT_EQ(moved[1], 2U);
  EXPECT_TRUE(moved[0] && *moved[0] != 2);
}

TEST(PipePlan, ignores_impossible_previous_assignments) {
  const std::vector<std::uint32_t> possible{0b01, 0b01};
  EXPECT_THAT(assign_crtcs(possible, Crtcs{77, 1}), ElementsAre(0, std::nullopt));
}

/// Tests all possibilities of three connectors with three CRTCs.
TEST(PipePlan, lights_as_many_as_possible) {
  for (std::uint32_t all = 0; all < 512; ++all) {
    const std::vector<std::uint32_t> possible{all & 7, all >> 3 & 7, all >> 6 & 7};
    std::size_t max = 0;
    for (int a = -1; a < 3; ++a) {
      for (int b = -1; b < 3; ++b) {
        for (int c = -1; c < 3; ++c) {
          std::multiset<int> used;
          bool can = true;
          int i = 0;
          for (const int crtc : {a, b, c}) {
            if (crtc >= 0) used.insert(crtc);
            can = can && (crtc < 0 || (possible[static_cast<std::size_t>(i)] >> crtc & 1U) != 0);
            ++i;
          }
          if (can && std::set<int>(used.begin(), used.end()).size() == used.size()) max = std::max(max, used.size());
        }
      }
    }
    std::set<std::size_t> given;
    const Crtcs assigned = assign_crtcs(possible);
    for (std::size_t i = 0; i < 3; ++i) {
      if (!assigned[i]) continue;
      EXPECT_NE(possible[i] >> *assigned[i] & 1U, 0U);
      EXPECT_TRUE(given.insert(*assigned[i]).second);
    }
    EXPECT_EQ(given.size(), max) << all;
  }
}

}  // namespace
}  // namespace cyclorama::output
