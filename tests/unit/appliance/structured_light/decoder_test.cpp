// SPDX-License-Identifier: Apache-2.0
#include "appliance/structured_light/decoder.h"

#include <gmock/gmock.h>

#include <limits>

#include "appliance/structured_light/decode_quality.h"
#include "tests/data_sets/lit_wall.h"

namespace cyclorama::structured_light {
namespace {

PatternSet set_of(const PatternChoice& choice) {
  auto set = structured_light(choice);
  CHECK(set.has_value());
  return *std::move(set);
}

const PatternSet& small_set() {
  static const PatternSet set = set_of({.width_px = 128, .height_px = 96});
  return set;
}

Decoded decoded_of(const LitWall& wall, const PatternSet& set, const DecodeSettings& settings = {}) {
  auto decoded = wall.decoder(set, settings).finish();
  CHECK(decoded.has_value());
  return *std::move(decoded);
}

int count_of(const Decoded& decoded, PixelFate fate) {
  return static_cast<int>(std::count(decoded.fate.data().begin(), decoded.fate.data().end(), fate));
}

TEST(Decoder, decodes_every_pixel_of_a_plain_wall_to_some_hundredths) {
  const LitWall wall;
  const Decoded decoded = decoded_of(wall, small_set());
  const WallErrors errors = errors_of(wall, decoded);
  EXPECT_GT(errors.decoded, 0.99 * 160 * 120);
  EXPECT_EQ(errors.gross, 0);
  EXPECT_LT(errors.median_px, 0.03);
  EXPECT_LT(errors.worst_px, 0.6);  // Beyond the last edge of the border only the stripe's middle is known.
  // The sigmas are neither too small nor too large.
  EXPECT_GT(errors.mean_square_of_sigmas, 0.1);
  EXPECT_LT(errors.mean_square_of_sigmas, 2.0);
  EXPECT_NEAR(decoded.noise, wall.noise, 0.3 * wall.noise);
}

TEST(Decoder, decodes_stripes_for_any_rotation_of_the_camera) {
  for (const double angle : {0.4, 0.785398, 1.5707963, 2.5, 3.1415926, 4.5}) {
    LitWall wall;
    wall.projector_pixel_at = [angle](double u, double v) {
      const Eigen::Vector2d off(0.45 * (u - 80.0), 0.45 * (v - 60.0));
      return Eigen::Vector2d(64.0 + std::cos(angle) * off.x() - std::sin(angle) * off.y(),
                             48.0 + std::sin(angle) * off.x() + std::cos(angle) * off.y());
    };
    const Decoded decoded = decoded_of(wall, small_set());
    const WallErrors errors = errors_of(wall, decoded);
    EXPECT_GT(errors.decoded, 0.9 * (160 * 120 - count_of(decoded, PixelFate::kDark))) << angle;
    EXPECT_EQ(errors.gross, 0) << angle;
    EXPECT_LT(errors.median_px, 0.05) << angle;
  }
}

TEST(Decoder, is_finer_with_phases_than_with_stripes_alone) {
  LitWall wall;
  wall.noise = 0.001;
  wall.codes = 4095;
  const PatternSet set = set_of({.width_px = 128, .height_px = 96, .phase_period_px = 8.0, .phase_steps = 5});
  const WallErrors stripes = errors_of(wall, decoded_of(wall, small_set()));
  const WallErrors phases = errors_of(wall, decoded_of(wall, set));
  EXPECT_LT(phases.median_px, 0.7 * stripes.median_px);
  EXPECT_EQ(phases.gross, 0);
}

TEST(Decoder, has_right_sigmas_where_the_camera_resolves_less_than_the_projector) {
  for (const double pixels : {2.0, 3.0, 4.0}) {
    LitWall wall;
    wall.projector_pixel_at = [pixels](double u, double v) { return Eigen::Vector2d(pixels * u, pixels * v); };
    wall.blur_px = 0.5 * pixels;  // Size of the camera's own pixels.
    const PatternSet set = set_of({.width_px = 512, .height_px = 384});
    const Decoded decoded = decoded_of(wall, set, {.max_sigma_px = 4.0});
    const WallErrors errors = errors_of(wall, decoded);
    const int on_projector =
        std::min(160, static_cast<int>(512 / pixels)) * std::min(120, static_cast<int>(384 / pixels));
    EXPECT_GT(errors.decoded, 0.8 * on_projector) << pixels;
    EXPECT_LT(errors.gross, 0.01 * errors.decoded) << pixels;
    EXPECT_LT(errors.median_px, 0.3 * pixels) << pixels;
    EXPECT_LT(errors.mean_square_of_sigmas, 4.0) << pixels;
  }
}

TEST(Decoder, distinguishes_the_reasons_for_undecoded_pixels) {
  LitWall wall;
  wall.direct = [](int u, int v) {
    if (v < 30) return 0.0;            // Shadow.
    if (v < 60 && u < 80) return 1.5;  // Too bright.
    return 0.5;
  };
  wall.disturbance = [](int u, int v, std::size_t i, double light) {
    // Somebody is in the way for four pairs.
    return v >= 90 && u >= 80 && i >= 6 && i < 14 ? 0.03 + 0.02 * light : light;
  };
  const Decoded decoded = decoded_of(wall, small_set());
  const auto fate_at = [&](int u, int v) { return *decoded.fate.at(u, v); };
  EXPECT_EQ(fate_at(40, 15), PixelFate::kDark);
  EXPECT_EQ(fate_at(40, 45), PixelFate::kSaturated);
  EXPECT_EQ(fate_at(120, 45), PixelFate::kDecoded);
  EXPECT_EQ(fate_at(40, 105), PixelFate::kDecoded);
  EXPECT_NE(fate_at(120, 105), PixelFate::kDecoded);
  EXPECT_GT(count_of(decoded, PixelFate::kDisturbed), 1500);
  EXPECT_EQ(errors_of(wall, decoded).gross, 0);
}

TEST(Decoder, loses_only_what_a_passer_by_covers) {
  LitWall wall;
  // A person moves one step to the right with every picture and is as bright as a stripe's edge.
  wall.disturbance = [](int u, int, std::size_t i, double light) {
    const int person = static_cast<int>(4 * i) - 20;
    return u >= person && u < person + 12 ? 0.25 + 0.02 * light : light;
  };
  const Decoded decoded = decoded_of(wall, small_set());
  const WallErrors errors = errors_of(wall, decoded);
  EXPECT_LE(errors.gross, 0.001 * errors.decoded);
  EXPECT_GT(errors.decoded, 160 * 120 / 10);
}

TEST(Decoder, is_robust_against_interreflection_with_xor_codes) {
  LitWall wall;
  wall.direct = [](int u, int) { return u % 80 < 30 ? 0.1 : 0.4; };
  wall.global = [](int u, int) { return u % 80 < 30 ? 0.35 : 0.05; };
  DecodeSettings for_xor;
  for_xor.min_direct_share = 0.1;
  for_xor.undecided.contrast = 0.02;
  const WallErrors plain = errors_of(wall, decoded_of(wall, small_set(), for_xor));
  const Decoded decoded = decoded_of(wall, set_of({.width_px = 128, .height_px = 96, .base_bit = 1}), for_xor);
  const WallErrors xored = errors_of(wall, decoded);
  EXPECT_GT(xored.decoded, 0.9 * 160 * 120);
  EXPECT_LE(xored.gross, 0.001 * xored.decoded);
  EXPECT_GT(160 * 120 - plain.decoded + plain.gross, 160 * 120 / 5)
      << "the wall is no test: plain Gray code sees through it as well";
}

TEST(Decoder, separates_direct_from_global_light) {
  LitWall wall;
  wall.noise = 0.001;
  wall.global = [](int u, int) { return u < 80 ? 0.2 : 0.0; };
  const PatternSet set = set_of({.width_px = 256, .height_px = 192});
  wall.projector_pixel_at = [](double u, double v) { return Eigen::Vector2d(1.5 * u, 1.5 * v); };
  const Decoded decoded = decoded_of(wall, set);
  EXPECT_NEAR(*decoded.direct_light.at(40, 60), 0.6, 0.03);
  EXPECT_NEAR(*decoded.direct_light.at(120, 60), 0.6, 0.03);
  EXPECT_NEAR(*decoded.global_light.at(40, 60), 0.2, 0.03);
  EXPECT_NEAR(*decoded.global_light.at(120, 60), 0.0, 0.03);
}

TEST(Decoder, reports_a_dark_projector) {
  LitWall wall;
  wall.direct = [](int, int) { return 0.0; };
  const auto decoded = wall.decoder(small_set()).finish();
  ASSERT_FALSE(decoded.has_value());
  EXPECT_EQ(decoded.error().code(), ErrorCode::kBadData);
  EXPECT_THAT(decoded.error().message(), testing::HasSubstr("projector"));
}

TEST(Decoder, decodes_nothing_in_an_overexposed_picture_and_reports_it) {
  LitWall wall;
  wall.direct = [](int, int) { return 3.0; };
  const Decoded decoded = decoded_of(wall, small_set());
  EXPECT_EQ(count_of(decoded, PixelFate::kDecoded), 0);
  EXPECT_GT(count_of(decoded, PixelFate::kSaturated), 160 * 120 * 9 / 10);
}

TEST(Decoder, loses_pixels_as_noise_rises_but_has_no_wrong_ones) {
  int before = 1 << 30;
  for (const double noise : {0.005, 0.02, 0.05, 0.1, 0.2}) {
    LitWall wall;
    wall.noise = noise;
    const auto decoder = wall.decoder(small_set());
    const auto decoded = decoder.finish();
    if (!decoded) continue;  // The light is lost in noise, which finish() reported.
    const WallErrors errors = errors_of(wall, *decoded);
    EXPECT_LE(errors.decoded, before + 200) << noise;
    EXPECT_LE(errors.gross, 0.01 * errors.decoded + 2) << noise;
    before = errors.decoded;
  }
}

TEST(Decoder, accepts_cameras_of_any_size) {
  for (const auto& [width, height] : {std::pair{1, 1}, std::pair{1, 200}, std::pair{200, 1}, std::pair{640, 480}}) {
    LitWall wall;
    wall.camera_width_px = width;
    wall.camera_height_px = height;
    wall.projector_pixel_at = [width = width, height = height](double u, double v) {
      return Eigen::Vector2d(16.0 * u / width, 12.0 * v / height);
    };
    DecodeSettings settings;
    settings.min_patch_px = 1;
    const PatternSet set = set_of({.width_px = 16, .height_px = 12});
    const WallErrors errors = errors_of(wall, decoded_of(wall, set, settings));
    EXPECT_EQ(errors.gross, 0);
  }
}

TEST(Decoder, refuses_invalid_sets_and_photographs) {
  PatternSet set = small_set();
  EXPECT_FALSE(Decoder::from(set, {}, 0, 10).has_value());
  std::swap(set.pictures[2], set.pictures[3]);
  EXPECT_FALSE(Decoder::from(set, {}, 10, 10).has_value());
  set = small_set();
  set.pictures.erase(set.pictures.begin() + 4, set.pictures.begin() + 6);
  EXPECT_FALSE(Decoder::from(set, {}, 10, 10).has_value());
  set = small_set();
  set.pictures.erase(set.pictures.begin());
  EXPECT_FALSE(Decoder::from(set, {}, 10, 10).has_value());

  auto decoder = Decoder::from(small_set(), {}, 10, 10);
  ASSERT_TRUE(decoder.has_value());
  EXPECT_FALSE(decoder->finish().has_value());
  EXPECT_FALSE(decoder->add(Photo(11, 10)).has_value());
  EXPECT_FALSE(decoder->add(Photo(10, 10, std::numeric_limits<float>::quiet_NaN())).has_value());
  for (std::size_t i = 0; i < small_set().pictures.size(); ++i)
    ASSERT_TRUE(decoder->add(Photo(10, 10, 0.5f)).has_value());
  EXPECT_FALSE(decoder->add(Photo(10, 10)).has_value());
}

TEST(DecodeQuality, counts_outliers_on_a_smooth_wall) {
  const LitWall wall;
  Decoded decoded = decoded_of(wall, small_set());
  const DecodeQuality good = quality_of(decoded, 0.1);
  EXPECT_GT(good.coverage, 0.99);
  EXPECT_EQ(good.gross, 0.0);
  EXPECT_LT(good.residual_median_px, 0.05);
  int spoilt = 0;
  for (int y = 5; y < 120; y += 10) {
    for (int x = 5; x < 160; x += 10) {
      if (*decoded.fate.at(x, y) != PixelFate::kDecoded) continue;
      decoded.position_px.at(x, y)[0] += 30.0f;
      ++spoilt;
    }
  }
  const DecodeQuality bad = quality_of(decoded, 0.1);
  EXPECT_NEAR(bad.gross, static_cast<double>(spoilt) / bad.judged, 1e-9);
}

}  // namespace
}  // namespace cyclorama::structured_light
