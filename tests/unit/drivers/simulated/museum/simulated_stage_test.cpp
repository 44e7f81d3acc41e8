// SPDX-License-Identifier: Apache-2.0
#include "drivers/simulated/museum/simulated_stage.h"

#include <gmock/gmock.h>
#include <stdlib.h>

#include <filesystem>
#include <string>

#include "drivers/simulated/museum/presets.h"

namespace cyclorama::simulated {
namespace {

TEST(SimulatedStage, takes_pictures_of_the_projectors_size_and_whole_parts_of_it) {
  std::string name = testing::TempDir() + "/stage.XXXXXX";
  ASSERT_NE(::mkdtemp(name.data()), nullptr);
  const std::filesystem::path folder(name);
  PresetOptions options;
  options.projector_width_px = 321;
  options.projector_height_px = 180;
  options.camera_megapixels = 0.05;
  ASSERT_TRUE(write_preset(*make_preset("cylinder126", 3, options), folder));
  auto stage = SimulatedStage::open(folder / "installation.toml", {.camera_megapixels = 0.05, .wall_cells = 0});
  ASSERT_TRUE(stage) << stage.error().message();
  for (const auto& [width, height] : {std::pair(321, 180), std::pair(160, 90), std::pair(80, 45), std::pair(0, 0)})
    EXPECT_TRUE(stage->show(0, RgbImage(width, height))) << width << "x" << height;
  // A picture of another shape would be shown distorted, and everything that is measured with it would be wrong.
  for (const auto& [width, height] :
       {std::pair(160, 80), std::pair(160, 180), std::pair(80, 90), std::pair(200, 112)}) {
    const auto shown = stage->show(0, RgbImage(width, height));
    ASSERT_FALSE(shown) << width << "x" << height;
    EXPECT_EQ(shown.error().code(), ErrorCode::kInvalidArgument);
    EXPECT_THAT(shown.error().message(), testing::HasSubstr("321x180"));
  }
  EXPECT_FALSE(stage->show(3, RgbImage(321, 180)));
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace cyclorama::simulated
