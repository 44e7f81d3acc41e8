// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <cmath>
#include <set>

#include "appliance/structured_light/pattern_drawing.h"
#include "appliance/structured_light/pattern_set.h"

namespace cyclorama::structured_light {
namespace {

PatternSet set_of(const PatternChoice& choice) {
  auto set = structured_light(choice);
  CHECK(set.has_value());
  return *std::move(set);
}

/// Returns the code that the pictures of one axis show at a position, highest bit first.
std::vector<int> word_at(const PatternSet& set, PatternAxis axis, int position) {
  std::vector<int> word;
  for (const PatternPicture& picture : set.pictures) {
    if (picture.kind != PatternKind::kBit || picture.axis != axis || picture.is_inverse) continue;
    const bool is_columns = axis == PatternAxis::kColumns;
    word.push_back(level_at(set, picture, is_columns ? position : 0, is_columns ? 0 : position) > 0.5 ? 1 : 0);
  }
  return word;
}

TEST(Patterns, have_as_many_bits_as_the_pixels_require) {
  EXPECT_EQ(bits_for(1), 1);
  EXPECT_EQ(bits_for(2), 1);
  EXPECT_EQ(bits_for(1024), 10);
  EXPECT_EQ(bits_for(1025), 11);
  EXPECT_EQ(bits_for(16384), 14);
}

TEST(Patterns, gray_codes_are_unique_and_neighbours_differ_in_one_bit) {
  const PatternSet set = set_of({.width_px = 100, .height_px = 37});
  for (const auto& [axis, extent] : {std::pair{PatternAxis::kColumns, 100}, std::pair{PatternAxis::kRows, 37}}) {
    std::set<std::vector<int>> words;
    std::vector<int> before;
    for (int position = 0; position < extent; ++position) {
      const auto word = word_at(set, axis, position);
      if (!before.empty()) {
        int differing = 0;
        for (std::size_t i = 0; i < word.size(); ++i) differing += word[i] != before[i] ? 1 : 0;
        EXPECT_EQ(differing, 1) << position;
      }
      words.insert(word);
      before = word;
    }
    EXPECT_EQ(words.size(), static_cast<std::size_t>(extent));
  }
}

TEST(Patterns, pictures_and_their_inverses_add_up_to_white) {
  const PatternSet set = set_of({.width_px = 64, .height_px = 48, .base_bit = 1});
  for (std::size_t i = 2; i < set.pictures.size(); i += 2) {
    ASSERT_FALSE(set.pictures[i].is_inverse);
    ASSERT_TRUE(set.pictures[i + 1].is_inverse);
    for (int x = 0; x < 64; ++x)
      EXPECT_EQ(level_at(set, set.pictures[i], x, x / 2) + level_at(set, set.pictures[i + 1], x, x / 2), 1.0);
  }
}

TEST(Patterns, xor_codes_have_no_stripe_wider_than_their_base) {
  for (const int base : {0, 1, 2}) {
    const PatternSet set = set_of({.width_px = 256, .height_px = 128, .base_bit = base});
    for (const PatternPicture& picture : set.pictures) {
      if (picture.kind != PatternKind::kBit) continue;
      const bool is_columns = picture.axis == PatternAxis::kColumns;
      int run = 0;
      double before = -1.0;
      for (int position = 0; position < (is_columns ? 256 : 128); ++position) {
        const double level = level_at(set, picture, is_columns ? position : 0, is_columns ? 0 : position);
        run = level == before ? run + 1 : 1;
        before = level;
        EXPECT_LE(run, 2 << base) << name_of(picture);
      }
    }
  }
}

TEST(Patterns, phase_patterns_are_sines_shifted_by_equal_steps) {
  const PatternSet set = set_of({.width_px = 64, .height_px = 64, .phase_period_px = 16.0, .phase_steps = 4});
  for (int x = 0; x < 64; ++x) {
    double sum = 0.0;
    for (const PatternPicture& picture : set.pictures) {
      if (picture.kind == PatternKind::kPhase && picture.axis == PatternAxis::kColumns)
        sum += level_at(set, picture, x, 0);
    }
    EXPECT_NEAR(sum, 2.0, 1e-12);
  }
  EXPECT_NEAR(level_at(set, {.kind = PatternKind::kPhase, .step = 0}, 0, 0),
              0.5 + 0.5 * std::cos(2.0 * M_PI * 0.5 / 16.0), 1e-12);
}

TEST(Patterns, refuses_sets_that_cannot_be_decoded_and_names_the_allowed_ones) {
  EXPECT_FALSE(structured_light({.width_px = 0}).has_value());
  EXPECT_FALSE(structured_light({.width_px = 20000}).has_value());
  EXPECT_FALSE(structured_light({.finest_bit = 11}).has_value());
  EXPECT_FALSE(structured_light({.finest_bit = 2, .base_bit = 1}).has_value());
  EXPECT_FALSE(structured_light({.phase_period_px = 16.0, .phase_steps = 2}).has_value());
  EXPECT_FALSE(structured_light({.finest_bit = 3, .phase_period_px = 16.0, .phase_steps = 4}).has_value());
  EXPECT_FALSE(structured_light({.phase_period_px = std::nan(""), .phase_steps = 4}).has_value());
  EXPECT_FALSE(ramps(100, 100, 1, {PatternLight::kAll}).has_value());
}

TEST(Patterns, are_drawn_as_described) {
  const PatternSet set = set_of({.width_px = 40, .height_px = 30, .phase_period_px = 8.0, .phase_steps = 3});
  for (const PatternPicture& picture : set.pictures) {
    const RgbImage image = drawn(set, picture);
    for (const auto& [x, y] : {std::pair{0, 0}, std::pair{39, 0}, std::pair{0, 29}, std::pair{13, 17}}) {
      for (int c = 0; c < 3; ++c)
        EXPECT_EQ(image.at(x, y)[c], std::lround(255.0 * level_at(set, picture, x, y))) << name_of(picture);
    }
  }
}

TEST(Patterns, ramps_light_one_primary_at_a_time) {
  const auto set = ramps(8, 4, 5, {PatternLight::kRed, PatternLight::kBlue});
  ASSERT_TRUE(set.has_value());
  ASSERT_EQ(set->pictures.size(), 10U);
  const RgbImage red = drawn(*set, set->pictures[4]);
  EXPECT_THAT(std::vector<int>(red.at(3, 2), red.at(3, 2) + 3), testing::ElementsAre(255, 0, 0));
  const RgbImage blue = drawn(*set, set->pictures[6]);
  EXPECT_THAT(std::vector<int>(blue.at(3, 2), blue.at(3, 2) + 3), testing::ElementsAre(0, 0, 64));
}

TEST(Patterns, survive_a_round_trip_through_text) {
  const PatternSet set = set_of(
      {.width_px = 1920, .height_px = 1080, .finest_bit = 1, .base_bit = 1, .phase_period_px = 16.5, .phase_steps = 5});
  const auto back = read_pattern_set(to_text(set));
  ASSERT_TRUE(back.has_value());
  EXPECT_EQ(*back, set);
}

TEST(Patterns, names_the_line_of_bad_text) {
  for (const std::string text : {"", "patterns 2 4 4 base -1 phase 0 0\n", "patterns 1 0 4 base -1 phase 0 0\n",
                                 "patterns 1 4 4 base -1 phase nan 0\n"}) {
    const auto set = read_pattern_set(text);
    ASSERT_FALSE(set.has_value()) << text;
    EXPECT_EQ(set.error().code(), ErrorCode::kBadData);
  }
  const auto set = read_pattern_set(
      "patterns 1 4 4 base -1 phase 0 0\nwhite column 0 pattern 0 1 all\nphase row 0 pattern 0 1 all\n");
  ASSERT_FALSE(set.has_value());
  EXPECT_THAT(set.error().message(), testing::HasSubstr("line 3"));
}

}  // namespace
}  // namespace cyclorama::structured_light
