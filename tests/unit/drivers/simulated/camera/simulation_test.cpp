// SPDX-License-Identifier: Apache-2.0
#include "drivers/simulated/camera/simulation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace cyclorama::simulated {
namespace {

using testing::HasSubstr;

std::string mistake_in(const std::string& text) {
  const auto simulation = Simulation::parse(text, "hand.toml");
  EXPECT_FALSE(simulation.has_value()) << text;
  return simulation ? "" : simulation.error().message();
}

TEST(Simulation, is_the_demo_by_default) {
  const auto simulation = Simulation::parse("", "hand.toml");
  ASSERT_TRUE(simulation.has_value()) << simulation.error().message();
  EXPECT_EQ(simulation->lens.width_px, 640);
  EXPECT_EQ(simulation->wand.tags.size(), 3U);
  EXPECT_EQ(Simulation::parse("[wand]\nnumber = 5\n", "hand.toml")->wand.id(), 15);
  EXPECT_EQ(simulation->path.duration_s(), HandPath::demo().duration_s());
}

TEST(Simulation, reads_every_key) {
  const auto simulation = Simulation::parse(R"(
    [camera]
    width_px = 320
    height_px = 200
    field_of_view_deg = 90
    frames_per_second = 20
    exposure_ms = 10
    exposure_steps = 2
    noise_grey = 0
    brightness = 0.5
    seed = 7
    [backdrop]
    kind = "plain"
    grey = 40
    [tag]
    id = 3
    size_mm = 80
    [path]
    loop_s = 2
    [[path.key]]
    time_s = 0
    position_m = [0.1, 0.2, 0.9]
    yaw_deg = 10
    pitch_deg = 20
    roll_deg = 30
    [[path.key]]
    time_s = 1
    position_m = [0, 0, 1]
  )",
                                            "hand.toml");
  ASSERT_TRUE(simulation.has_value()) << simulation.error().message();
  EXPECT_NEAR(simulation->lens.focal_px, 160.0, 1e-9);
  EXPECT_EQ(simulation->frames_per_second, 20.0);
  EXPECT_EQ(simulation->exposure_s, 0.01);
  EXPECT_EQ(simulation->exposure_steps, 2);
  EXPECT_EQ(simulation->noise_grey, 0.0);
  EXPECT_EQ(simulation->brightness, 0.5);
  EXPECT_EQ(simulation->seed, 7U);
  EXPECT_EQ(simulation->backdrop, Backdrop::kPlain);
  EXPECT_EQ(simulation->backdrop_grey, 40.0);
  ASSERT_EQ(simulation->wand.tags.size(), 1U);
  EXPECT_EQ(simulation->wand.id(), 3);
  EXPECT_EQ(simulation->wand.tags[0].size_m, 0.08);
  EXPECT_EQ(simulation->path.duration_s(), 2.0);
  EXPECT_TRUE(simulation->path.at(0).translation().isApprox(Eigen::Vector3d(0.1, 0.2, 0.9)));
}

TEST(Simulation, names_the_line_of_a_mistake) {
  EXPECT_THAT(mistake_in("[camera]\nwidth_px = 0\n"), HasSubstr("hand.toml:2:"));
  EXPECT_THAT(mistake_in("[camera]\nwidth_mm = 3\n"), HasSubstr("hand.toml:2:"));
  EXPECT_THAT(mistake_in("[camera]\nexposure_steps = 3\n"), HasSubstr("1, 2, 4 or 8"));
  EXPECT_THAT(mistake_in("[camera]\nexposure_ms = 100\n"), HasSubstr("longer than the time between two frames"));
  EXPECT_THAT(mistake_in("[backdrop]\nkind = \"garden\"\n"), HasSubstr("hand.toml:2:"));
  EXPECT_THAT(mistake_in("[tag]\nid = 587\n"), HasSubstr("hand.toml:2:"));
  EXPECT_THAT(mistake_in("[tag]\nid = 1\n[wand]\nnumber = 1\n"), HasSubstr("remove one"));
  EXPECT_THAT(mistake_in("[path]\nloop_s = 3\n"), HasSubstr("needs key poses"));
  EXPECT_THAT(mistake_in("[[path.key]]\ntime_s = 1\n"), HasSubstr("position_m"));
  EXPECT_THAT(mistake_in("[[path.key]]\ntime_s = 1\nposition_m = [1, 2]\n"), HasSubstr("hand.toml:3:"));
  EXPECT_THAT(mistake_in("[[path.key]]\ntime_s = nan\nposition_m = [0, 0, 1]\n"), HasSubstr("hand.toml:2:"));
  EXPECT_THAT(mistake_in("[[path.key]]\ntime_s = 2\nposition_m = [0, 0, 1]\n[[path.key]]\ntime_s = 1\n"
                         "position_m = [0, 0, 1]\n"),
              HasSubstr("does not come after"));
  EXPECT_THAT(mistake_in("[camera\n"), HasSubstr("hand.toml:1:"));
}

}  // namespace
}  // namespace cyclorama::simulated
