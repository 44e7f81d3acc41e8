// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "common/base/result.h"
#include "common/room/pinhole.h"
#include "common/wand/folded_card.h"
#include "drivers/simulated/camera/hand_path.h"

namespace cyclorama::simulated {

/// Background behind the hand.
enum class Backdrop { kPlain, kGradient, kClutter };

/// All parameters of a simulated camera's pictures: the same simulation gives the same pictures. The camera is a
/// machine-vision camera: grey is proportional to light.
struct Simulation {
  Pinhole lens = Pinhole::from_field_of_view(640, 480, 1.0471975511965976);  ///< 60° wide.
  double frames_per_second = 30.0;
  double exposure_s = 0.004;
  int exposure_steps = 4;   ///< Number of averaged moments of the exposure (motion blur): 1, 2, 4 or 8.
  double noise_grey = 1.5;  ///< Standard deviation, in grey levels of 255.
  double brightness = 1.0;  ///< Gain of the light, not of the noise; highlights clip.
  std::uint32_t seed = 1;   ///< Seed of noise and clutter.
  Backdrop backdrop = Backdrop::kClutter;
  double backdrop_grey = 90.0;
  Wand wand = standard_wand(0);
  HandPath path = HandPath::demo();

  /// Reads TOML with the keys in docs/reference/settings.md; an absent key keeps the default above.
  /// Errors: kBadData with file, line and remedy; others are those of read_file().
  static Result<Simulation> read(const std::filesystem::path& path);
  static Result<Simulation> parse(std::string_view text, std::string name);
};

}  // namespace cyclorama::simulated
