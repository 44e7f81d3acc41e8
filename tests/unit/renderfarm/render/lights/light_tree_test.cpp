// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/render/lights/light_tree.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "renderfarm/render/lights/light_list.h"

namespace cyclorama::render {
namespace {

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  float unit() { return static_cast<float>(engine_() >> 8) * 0x1p-24f; }
  float between(float low, float high) { return low + (high - low) * unit(); }
  Vec3 direction() { return uniform_cap({unit(), unit()}, 2.0f); }
  Vec3 inside(float half) { return {between(-half, half), between(-half, half), between(-half, half)}; }

 private:
  std::mt19937 engine_;
};

LightBounds point(const Vec3& at, float candela) {
  LightBounds light;
  light.low = at;
  light.high = at;
  light.normals = {Vec3::UnitY(), -1.0f};
  light.power = candela;
  light.cos_emission = 0.0f;
  return light;
}

LightBounds surface(const Vec3& at, const Vec3& normal, float candela) {
  LightBounds light = point(at, candela);
  light.normals = {normal, 1.0f};
  return light;
}

/// Returns the irradiance of a light without size.
float irradiance(const LightBounds& light, const Vec3& p, const Vec3& n) {
  const Vec3 offset = light.low - p;
  const Vec3 to = offset.normalized();
  const float emitted = light.normals.cosine < 0.0f ? 1.0f : std::max(0.0f, -light.normals.axis.dot(to));
  const float received = n.isZero() ? 1.0f : std::max(0.0f, n.dot(to));
  return light.power * emitted * received / offset.squaredNorm();
}

std::vector<LightBounds> mixed_lights(int count, Random* random) {
  std::vector<LightBounds> lights;
  for (int i = 0; i < count; ++i) {
    const Vec3 at = random->inside(20.0f);
    const float candela = std::pow(10.0f, random->between(-2.0f, 2.0f));
    lights.push_back(i % 3 == 0 ? point(at, candela) : surface(at, random->direction(), candela));
  }
  return lights;
}

double sum_of_probabilities(const LightTree& tree, std::size_t count, const Vec3& p, const Vec3& n) {
  double sum = 0.0;
  for (std::size_t i = 0; i < count; ++i) sum += static_cast<double>(tree.probability(p, n, static_cast<int>(i)));
  return sum;
}

TEST(LightTree, probabilities_and_their_loss_add_up_to_one_and_each_relevant_light_has_one) {
  Random random(3);
  double total_lost = 0.0;
  int places = 0;
  for (const int count : {1, 2, 3, 33, 1000, 3000}) {
    const std::vector<LightBounds> lights = mixed_lights(count, &random);
    const LightTree tree(lights);
    for (int place = 0; place < 12; ++place) {
      const Vec3 p = random.inside(25.0f);
      const Vec3 n = place % 4 == 0 ? Vec3(Vec3::Zero()) : random.direction();
      const double sum = sum_of_probabilities(tree, lights.size(), p, n);
      // If bounds are too wide, a choice may end at a group in which no light can shine; that probability is lost, not
      // misplaced.
      constexpr int kChoices = 4096;
      int lost = 0;
      for (int i = 0; i < kChoices; ++i) {
        Choice choice((i + 0.5) / kChoices);
        float probability = 0.0f;
        lost += tree.choose(p, n, &choice, &probability) < 0 ? 1 : 0;
      }
      EXPECT_NEAR(sum + static_cast<double>(lost) / kChoices, 1.0, 0.01) << count;
      total_lost += static_cast<double>(lost) / kChoices;
      ++places;
      for (std::size_t i = 0; i < lights.size(); ++i) {
        if (irradiance(lights[i], p, n) > 0.0f) {
          ASSERT_GT(tree.probability(p, n, static_cast<int>(i)), 0.0f) << count << " " << i;
        }
      }
    }
  }
  EXPECT_LT(total_lost / places, 0.35);
}

TEST(LightTree, chooses_with_its_stated_probability) {
  Random random(4);
  const std::vector<LightBounds> lights = mixed_lights(100, &random);
  const LightTree tree(lights);
  const Vec3 p(1, 2, 3);
  const Vec3 n = Vec3(1, 1, 0).normalized();
  constexpr int kChoices = 200'000;
  std::vector<int> chosen(lights.size(), 0);
  for (int i = 0; i < kChoices; ++i) {
    Choice choice((i + 0.5) / kChoices);
    float probability = 0.0f;
    const int light = tree.choose(p, n, &choice, &probability);
    if (light < 0) continue;
    ++chosen[static_cast<std::size_t>(light)];
    EXPECT_NEAR(probability / tree.probability(p, n, light), 1.0f, 1e-4f);
    EXPECT_GE(choice.number(), 0.0);
    EXPECT_LT(choice.number(), 1.0);
  }
  for (std::size_t i = 0; i < lights.size(); ++i) {
    EXPECT_NEAR(chosen[i], static_cast<double>(tree.probability(p, n, static_cast<int>(i))) * kChoices, 2.5) << i;
  }
}

TEST(LightTree, chooses_in_proportion_to_power_at_equal_distances) {
  std::vector<LightBounds> lights;
  for (int i = 0; i < 64; ++i) {
    const double angle = 0.1 * i;
    lights.push_back(
        point({static_cast<float>(1000.0 + 0.01 * std::cos(angle)), static_cast<float>(0.01 * std::sin(angle)), 0},
              static_cast<float>(i + 1)));
  }
  const LightTree tree(lights);
  for (int i = 0; i < 64; ++i) {
    EXPECT_NEAR(tree.probability(Vec3::Zero(), Vec3::UnitX(), i), static_cast<float>(i + 1) / 2080.0f, 1e-5f);
  }
}

TEST(LightTree, never_chooses_lights_behind_the_surface_or_facing_away) {
  std::vector<LightBounds> lights = {point({0, -1, 0}, 1e6f), surface({0, 2, 0}, Vec3::UnitY(), 1e6f),
                                     point({0, 3, 0}, 1.0f)};
  const LightTree tree(lights);
  EXPECT_EQ(tree.probability(Vec3::Zero(), Vec3::UnitY(), 0), 0.0f);
  EXPECT_EQ(tree.probability(Vec3::Zero(), Vec3::UnitY(), 1), 0.0f);
  EXPECT_GT(tree.probability(Vec3::Zero(), Vec3::Zero(), 0), 0.0f) << "both sides are lit";
}

TEST(LightTree, never_chooses_lights_beyond_their_range) {
  std::vector<LightBounds> lights = {point({10, 0, 0}, 1e6f), point({0, 3, 0}, 1.0f)};
  lights[0].inverse_range = 1.0f / 9.0f;
  const LightTree tree(lights);
  EXPECT_EQ(tree.probability(Vec3::Zero(), Vec3::Zero(), 0), 0.0f);
  EXPECT_EQ(tree.probability(Vec3::Zero(), Vec3::Zero(), 1), 1.0f);
}

TEST(LightTree, is_finite_for_extreme_lights) {
  std::vector<LightBounds> lights = {point({0, 0, 0}, 1e10f), point({0, 0, 0}, 1e-3f), point({1e8f, 0, 0}, 1.0f),
                                     point({1e-8f, 0, 0}, 1e-20f), point({1, 1, 1}, 0.0f)};
  for (int i = 0; i < 100; ++i) lights.push_back(point({std::pow(2.0f, static_cast<float>(i) - 50.0f), 0, 0}, 1.0f));
  for (int i = 0; i < 100; ++i) lights.push_back(point({5, 5, 5}, 1.0f));
  const LightTree tree(lights);
  EXPECT_EQ(tree.probability(Vec3::Zero(), Vec3::UnitY(), 4), 0.0f);
  for (const Vec3& p : {Vec3(0, 0, 0), Vec3(5, 5, 5), Vec3(1e8f, 0, 0), Vec3(-1, 0, 0), Vec3(1e-30f, 0, 0)}) {
    const double sum = sum_of_probabilities(tree, lights.size(), p, Vec3::Zero());
    EXPECT_NEAR(sum, 1.0, 1e-3) << p.transpose();
    for (int i = 0; i < 64; ++i) {
      Choice choice(i / 64.0);
      float probability = 0.0f;
      const int light = tree.choose(p, Vec3::Zero(), &choice, &probability);
      EXPECT_TRUE(light >= 0 && probability > 0.0f && probability <= 1.0f) << p.transpose();
    }
  }
  EXPECT_TRUE(LightTree(std::vector<LightBounds>(3)).empty());
}

/// Returns the variance of irradiance / probability, relative to the squared irradiance: 0 for a perfect choice.
template <typename Probability>
double relative_variance(const std::vector<LightBounds>& lights, const Vec3& p, const Vec3& n,
                         const Probability& probability) {
  double second = 0.0;
  double first = 0.0;
  for (std::size_t i = 0; i < lights.size(); ++i) {
    const auto e = static_cast<double>(irradiance(lights[i], p, n));
    if (!(e > 0.0)) continue;
    first += e;
    second += e * e / probability(i);
  }
  return second / (first * first) - 1.0;
}

TEST(LightTree, chooses_better_than_by_power_or_uniformly_among_ten_thousand) {
  Random random(5);
  const std::vector<LightBounds> lights = mixed_lights(10'000, &random);
  const LightTree tree(lights);
  double power = 0.0;
  for (const LightBounds& light : lights) power += static_cast<double>(light.power);
  std::vector<double> by_tree;
  std::vector<double> by_power;
  std::vector<double> by_chance;
  for (int place = 0; place < 41; ++place) {
    const Vec3 p = random.inside(20.0f);
    const Vec3 n = random.direction();
    by_tree.push_back(relative_variance(
        lights, p, n, [&](std::size_t i) { return static_cast<double>(tree.probability(p, n, static_cast<int>(i))); }));
    by_power.push_back(
        relative_variance(lights, p, n, [&](std::size_t i) { return static_cast<double>(lights[i].power) / power; }));
    by_chance.push_back(relative_variance(lights, p, n, [&](std::size_t) { return 1e-4; }));
  }
  const auto median = [](std::vector<double> values) {
    std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
    return values[values.size() / 2];
  };
  std::printf("relative variance, median: tree %.2f, power %.2f, chance %.2f\n", median(by_tree), median(by_power),
              median(by_chance));
  EXPECT_LT(median(by_tree), 0.25 * median(by_power));
  EXPECT_LT(median(by_tree), 0.05 * median(by_chance));
}

TEST(LightTree, a_short_list_chooses_with_its_stated_probability) {
  Random random(6);
  const std::vector<LightBounds> lights = mixed_lights(30, &random);
  LightList list;
  for (const LightBounds& light : lights) list.add(light);
  for (int place = 0; place < 20; ++place) {
    const Vec3 p = random.inside(20.0f);
    const Vec3 n = place % 4 == 0 ? Vec3(Vec3::Zero()) : random.direction();
    LightList::Estimates estimates;
    list.estimate(p, n, &estimates);
    for (std::size_t i = 0; i < lights.size(); ++i) {
      const float expected = irradiance(lights[i], p, n);
      EXPECT_NEAR(estimates.each[i], expected, 1e-4f * expected + 1e-9f) << i;
    }
    const auto probability = [&](std::size_t i) { return static_cast<double>(estimates.each[i] / estimates.sum); };
    EXPECT_LT(relative_variance(lights, p, n, probability), 1e-3);
    for (int i = 0; i < 100; ++i) {
      float chance = 0.0f;
      const int light = list.choose(estimates, Choice(i / 100.0), &chance);
      ASSERT_GE(light, 0);
      EXPECT_EQ(chance, estimates.each[static_cast<std::size_t>(light)] / estimates.sum);
    }
  }
}

TEST(DirectionCone, contains_the_directions_that_it_was_made_of) {
  Random random(8);
  for (int i = 0; i < 2000; ++i) {
    DirectionCone cone;
    std::vector<DirectionCone> parts;
    for (int k = 0; k < 6; ++k) {
      const Vec3 axis = (Vec3::UnitY() + random.unit() * random.direction()).normalized();
      parts.push_back({axis, std::cos(random.unit() * (i % 2 == 0 ? 1e-3f : 1.0f))});
      cone.extend(parts.back());
    }
    EXPECT_NEAR(cone.axis.norm(), 1.0f, 1e-5f);
    for (const DirectionCone& part : parts) {
      const double between = std::acos(std::clamp(static_cast<double>(cone.axis.dot(part.axis)), -1.0, 1.0));
      const double reach = std::acos(std::clamp(static_cast<double>(cone.cosine), -1.0, 1.0));
      EXPECT_GE(reach + 1e-3, between + std::acos(std::min(1.0, static_cast<double>(part.cosine))));
    }
  }
}

}  // namespace
}  // namespace cyclorama::render
