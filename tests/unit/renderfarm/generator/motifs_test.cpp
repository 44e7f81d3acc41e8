// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/generator/motifs.h"

#include <gtest/gtest.h>

#include <functional>
#include <random>

namespace cyclorama::generator {
namespace {

using Motif = std::function<Vec3(const Vec2&, float)>;

struct Named {
  const char* name;
  Motif paint;
};

std::vector<Named> motifs() {
  return {{"thousand_buddhas", [](const Vec2& p, float s) { return thousand_buddhas(p, s); }},
          {"scroll_band",
           [](const Vec2& p, float s) {
             return scroll_band({p.x(), std::abs(p.y())}, 0.3f, s);
           }},
          {"petal_band",
           [](const Vec2& p, float s) {
             return petal_band({p.x(), std::abs(p.y())}, 0.25f, s);
           }},
          {"valance",
           [](const Vec2& p, float s) {
             return valance({p.x(), std::abs(p.y())}, 0.5f, s);
           }},
          {"lotus", [](const Vec2& p, float s) { return lotus(p, 1.0f, 8, Vec3::Zero(), s); }},
          {"lantern", [](const Vec2& p, float s) { return lantern(p, 1.3f, s); }},
          {"apsaras", [](const Vec2& p, float s) { return flying_apsaras(p, 1.2f, s); }},
          {"nimbus", [](const Vec2& p, float s) { return nimbus(p.norm(), p.x(), 1.0f, 1, s); }},
          {"brocade", [](const Vec2& p, float s) { return brocade(p, Vec3::Ones(), Vec3::Zero(), s); }},
          {"floor_tile", [](const Vec2& p, float s) {
             float relief = 0.0f;
             const Vec3 colour = floor_tile(p, s, &relief);
             EXPECT_TRUE(relief >= 0.0f && relief <= 1.0f);
             return colour;
           }}};
}

TEST(Motifs, have_colours_everywhere_at_any_resolution) {
  std::mt19937 random{3};
  std::uniform_real_distribution<float> place{-12.0f, 12.0f};
  for (const Named& motif : motifs()) {
    SCOPED_TRACE(motif.name);
    for (const float spacing : {1e-4f, 0.01f, 0.05f, 0.5f, 5.0f}) {
      for (int i = 0; i < 1'000; ++i) {
        const Vec3 colour = motif.paint({place(random), place(random)}, spacing);
        ASSERT_TRUE((colour.array() >= 0.0f).all() && (colour.array() <= 1.0f).all()) << colour.transpose();
      }
      ASSERT_TRUE(motif.paint(Vec2::Zero(), spacing).allFinite());
    }
  }
}

/// Mean difference in colour between neighbouring vertices.
float roughness(const Motif& paint, float spacing) {
  float sum = 0.0f;
  constexpr int kSteps = 400;
  for (int i = 0; i < kSteps; ++i) {
    const Vec2 p{0.053f * static_cast<float>(i % 20), 0.0025f * static_cast<float>(i)};
    sum += (paint(p, spacing) - paint(p + Vec2(0.005f, 0.0f), spacing)).norm();
  }
  return sum / kSteps;
}

TEST(Motifs, blur_on_coarse_grids_instead_of_aliasing) {
  for (const Named& motif : motifs()) {
    EXPECT_LT(roughness(motif.paint, 0.4f), 0.7f * roughness(motif.paint, 0.002f) + 1e-4f) << motif.name;
  }
}

TEST(ThousandBuddhas, change_colour_from_cell_to_cell_and_repeat_after_eight) {
  const auto robe = [](int column) {
    return thousand_buddhas({(static_cast<float>(column) + 0.5f) * kCellWidth + 0.04f, 0.5f * kCellHeight - 0.02f},
                            0.001f);
  };
  for (int column = -9; column < 9; ++column) {
    EXPECT_EQ(robe(column), robe(column + 8));
    EXPECT_NE(robe(column), robe(column + 1));
  }
}

TEST(Age, grows_with_loss) {
  std::mt19937 random{5};
  std::uniform_real_distribution<float> place{-9.0f, 9.0f};
  int bare_young = 0;
  int bare_old = 0;
  for (int i = 0; i < 3'000; ++i) {
    const Vec3 p{place(random), place(random), place(random)};
    const Age young = age_of(p, 0.0f, 1u);
    const Age old = age_of(p, 1.0f, 1u);
    EXPECT_LE(young.plaster_lost, old.plaster_lost);
    bare_young += young.plaster_lost > 0.5f ? 1 : 0;
    bare_old += old.plaster_lost > 0.5f ? 1 : 0;
    EXPECT_TRUE(aged(Vec3::Constant(0.5f), old, p, 1.0f, 1u).allFinite());
  }
  EXPECT_LT(bare_young, 150);
  EXPECT_GT(bare_old, 1'500);
}

}  // namespace
}  // namespace cyclorama::generator
