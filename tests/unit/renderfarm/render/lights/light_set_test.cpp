// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/render/lights/light_set.h"

#include <gtest/gtest.h>

#include "renderfarm/render/lights/light_geometry.h"
#include "renderfarm/render/ray_queue.h"
#include "renderfarm/render/surface.h"
#include "tests/data_sets/simple_scenes.h"
#include "tests/support/light_checks.h"
#include "tests/support/statistics.h"

namespace cyclorama::render {
namespace {

scene::Light rectangle(const Eigen::Vector3d& at, const Eigen::Vector3d& direction, double width, double height,
                       float nits) {
  scene::Light light;
  light.kind = scene::LightKind::kRectangle;
  light.position = at;
  light.direction = direction.normalized();
  light.across = light.direction.unitOrthogonal();
  light.size_m = {width, height};
  light.intensity.setConstant(nits);
  light.visible = true;
  return light;
}

/// The scene's tables without a BVH.
class Glowing {
 public:
  explicit Glowing(scene::Mesh mesh, float radiance, const Eigen::Affine3d& T = Eigen::Affine3d::Identity()) {
    model_.materials.push_back(matte_material(Eigen::Vector3f::Zero()));
    model_.materials[0].emissive.setConstant(radiance);
    model_.meshes.push_back(std::move(mesh));
    materials_.push_back(trace_material(model_, model_.materials[0], &textures_));
    textures_.build(1);
    meshes_.push_back(trace_mesh(model_.meshes[0]));
    meshes_[0].material = materials_.data();
    placements_.push_back(place(meshes_[0], T));
  }
  scene::Material& material() { return model_.materials[0]; }
  const std::vector<Placement>& placements() const { return placements_; }
  LightSet lights(const std::vector<scene::Light>& lamps = {}, const scene::Sky& sky = {}) const {
    return {lamps, Eigen::Vector3d::Zero(), placements_, sky, nullptr};
  }

 private:
  scene::Model model_;
  MipTextures textures_;
  std::vector<SurfaceMaterial> materials_;
  std::vector<SurfaceMesh> meshes_;
  std::vector<Placement> placements_;
};

LightSet set_of(const std::vector<scene::Light>& lamps, const scene::Sky& sky = {}) {
  return {lamps, Eigen::Vector3d::Zero(), {}, sky, nullptr};
}

double irradiance(const LightSet& lights, const Vec3& p, const Vec3& n, int samples = 1 << 14) {
  return sampled_irradiance(
      [&](float choice, const Vec2& u, LightSample* aim) { return lights.sample(p, n, choice, u, aim); }, n, samples);
}

scene::Mesh triangle_mesh(const std::array<Eigen::Vector3f, 3>& corners) {
  scene::Mesh mesh;
  for (const Eigen::Vector3f& c : corners) mesh.positions.push_back({c.x(), c.y(), c.z()});
  mesh.triangles = {{0, 1, 2}};
  return mesh;
}

TEST(LightSet, is_empty_in_a_dark_scene) {
  LightSample aim;
  EXPECT_TRUE(LightSet().empty());
  EXPECT_FALSE(LightSet().sample(Vec3::Zero(), Vec3::UnitY(), 0.5f, {0.5f, 0.5f}, &aim));
  EXPECT_FALSE(set_of({point_light({0, 1, 0}, 0.0f)}).sample(Vec3::Zero(), Vec3::UnitY(), 0.5f, {0.5f, 0.5f}, &aim));
  EXPECT_EQ(LightSet().environment_pdf(Vec3::Zero(), Vec3::UnitY(), Vec3::UnitY()), 0.0f);
}

TEST(LightSet, is_unbiased_with_many_lights) {
  for (const int count : {1, 4, 20, 65, 500}) {
    std::vector<scene::Light> lamps;
    double expected = 0.0;
    for (int i = 0; i < count; ++i) {
      const Eigen::Vector3d at(std::sin(i) * 5.0, 2.0 + std::cos(3.0 * i), std::cos(i) * 5.0);
      lamps.push_back(point_light(at, static_cast<float>(1 + i % 5)));
      lamps.back().radius_m = i % 2 == 0 ? 0.3 : 0.0;
      lamps.back().visible = i % 4 == 0;
      expected += (1 + i % 5) * at.y() / std::pow(at.norm(), 3.0);
    }
    EXPECT_NEAR(irradiance(set_of(lamps), Vec3::Zero(), Vec3::UnitY()) / expected, 1.0, 0.02) << count;
  }
}

TEST(LightSet, sums_lamps_suns_and_sky) {
  scene::Light sun;
  sun.kind = scene::LightKind::kDirectional;
  sun.intensity.setConstant(3.0f);
  const scene::Sky sky{Eigen::Vector3f::Constant(0.5f), Eigen::Vector3f::Constant(0.5f),
                       Eigen::Vector3f::Constant(0.5f)};
  const LightSet lights = set_of({sun, point_light({0, 2, 0}, 8.0f)}, sky);
  const double expected = 3.0 + 2.0 + 0.5 * std::numbers::pi;
  EXPECT_NEAR(irradiance(lights, Vec3::Zero(), Vec3::UnitY()), expected, 0.01 * expected);
}

TEST(LightSet, a_glowing_triangle_follows_lamberts_formula_near_and_far) {
  const std::array<Eigen::Vector3f, 3> corners = {Eigen::Vector3f(-1, 0, -1), {1, 0.2f, -1}, {0, 0.1f, 1.5f}};
  for (const float height : {0.05f, 0.5f, 3.0f, 200.0f}) {
    const Glowing glowing(triangle_mesh(corners), 1.0f,
                          Eigen::Affine3d(Eigen::Translation3d(0.2, static_cast<double>(height), 0.1)));
    const LightSet lights = glowing.lights();
    ASSERT_EQ(lights.triangles(), 1u);
    std::vector<Eigen::Vector3d> seen;
    for (const Eigen::Vector3f& c : corners) seen.push_back((c + Eigen::Vector3f(0.2f, height, 0.1f)).cast<double>());
    const double expected = polygon_irradiance(seen, Eigen::Vector3d::UnitY());
    EXPECT_NEAR(irradiance(lights, Vec3::Zero(), Vec3::UnitY()) / expected, 1.0, 0.01) << height;
    EXPECT_EQ(irradiance(lights, {0.2f, 2 * height + 1, 0.1f}, -Vec3::UnitY(), 64), 0.0) << "behind";
  }
}

TEST(LightSet, samples_of_a_near_triangle_are_uniform_in_solid_angle) {
  const Glowing glowing(triangle_mesh({Eigen::Vector3f(-1, 0, -1), {1, 0, -1}, {0, 0, 1.5f}}), 1.0f,
                        Eigen::Affine3d(Eigen::Translation3d(0, 0.5, 0)));
  const LightSet lights = glowing.lights();
  const auto sample = [&](const Vec2& u, float choice) -> std::optional<Vec3> {
    LightSample aim;
    if (!lights.sample(Vec3::Zero(), Vec3::UnitY(), choice, u, &aim)) return std::nullopt;
    return aim.direction;
  };
  const auto pdf = [&](const Vec3& d) {
    if (!(d.y() > 0.0f)) return 0.0f;
    const float t = 0.5f / d.y();
    const float x = d.x() * t;
    const float z = d.z() * t;
    const bool inside = z >= -1.0f && 2.5f * std::abs(x) <= 1.5f - z;
    return inside ? lights.pdf(Vec3::Zero(), Vec3::UnitY(), 0, d, t) : 0.0f;
  };
  // Bins so fine that the triangle's tip does not fall between them.
  const SamplerCheck check = check_sampler(sample, pdf, 1 << 14, 3, 3);
  EXPECT_GT(check.chi_square.p_value, 0.01) << check.chi_square.statistic << " " << check.lost;
  EXPECT_NEAR(check.integral, 1.0, 0.02);
}

/// Returns the lamp that a ray hits, found by Embree.
class Traced {
 public:
  explicit Traced(const LightSet& lights) : device_(rtcNewDevice("threads=1")), top_(rtcNewScene(device_)) {
    rtcSetSceneFlags(top_, RTC_SCENE_FLAG_ROBUST);
    lamps_ = attach_lamps(lights, 5, device_, top_);
    rtcCommitScene(top_);
    EXPECT_EQ(rtcGetDeviceError(device_), RTC_ERROR_NONE);
  }
  ~Traced() {
    rtcReleaseScene(top_);
    rtcReleaseDevice(device_);
  }
  Traced(const Traced&) = delete;
  Traced& operator=(const Traced&) = delete;
  LightIndex meet(const Vec3& p, const Vec3& direction, float* ret_distance) const {
    const auto rays = std::make_unique<RayQueue<RTCRayHit16>>();
    rays->add(p, direction, kEndless, 0);
    trace_nearest(top_, Coherence::kIncoherent, *rays);
    const RTCHit hit = rays->hit(0);
    if (!lamps_.holds(hit.geomID)) return kNoLight;
    *ret_distance = rays->distance(0);
    return lamps_.light_of(hit.geomID, hit.primID);
  }

 private:
  RTCDevice device_;
  RTCScene top_;
  LampGeometries lamps_;
};

std::vector<scene::Light> visible_lamps() {
  std::vector<scene::Light> lamps = {rectangle({0, 2, 0}, {0, -1, 0}, 1.5, 1.0, 2.0f),
                                     rectangle({3, 1, 0}, {-1, 0, 0.2}, 1, 1, 1.0f),
                                     rectangle({-2, 1, 1}, {1, -0.3, 0}, 0.5, 2, 3.0f)};
  lamps[1].kind = scene::LightKind::kDisk;
  lamps[1].radius_m = 0.7;
  lamps.push_back(point_light({0, 1, -3}, 2.0f));
  lamps.back().radius_m = 0.5;
  lamps.back().visible = true;
  lamps.push_back(point_light({0, 3, 4}, 2.0f));
  return lamps;
}

TEST(LightSet, rays_that_hit_visible_lamps_have_the_pdf_and_radiance_of_light_samples) {
  std::vector<scene::Light> few = visible_lamps();
  std::vector<scene::Light> many = few;
  for (int i = 0; i < 80; ++i) many.push_back(point_light({0.1 * i - 3.0, 8.0, 0.0}, 1.0f));
  for (const std::vector<scene::Light>& lamps : {few, many}) {
    const LightSet lights = set_of(lamps);
    const Traced traced(lights);
    const Vec3 p(0.1f, 0.2f, 0.3f);
    int met = 0;
    for (int i = 0; i < 2000; ++i) {
      const SampleSequence sequence(5, 0, 0, i, 2000);
      LightSample aim;
      if (!lights.sample(p, Vec3::UnitY(), sequence.pair(0).x(), sequence.pair(1), &aim) || aim.pdf == 0.0f) continue;
      float distance = 0.0f;
      const LightIndex light = traced.meet(p, aim.direction, &distance);
      if (light == kNoLight) continue;  // Beyond a rim.
      ++met;
      EXPECT_LT(aim.distance, distance);
      EXPECT_GT(aim.distance, 0.999f * distance);
      EXPECT_NEAR(lights.pdf(p, Vec3::UnitY(), light, aim.direction, distance) / aim.pdf, 1.0f, 0.01f);
      const Vec3 expected = aim.radiance_over_pdf * aim.pdf;
      EXPECT_NEAR(lights.radiance(light, p, aim.direction).x() / expected.x(), 1.0f, 0.01f);
    }
    EXPECT_GT(met, 300);
  }
}

TEST(LightSet, rays_and_light_samples_agree_about_the_light_that_arrives) {
  const LightSet lights = set_of(visible_lamps());
  const Traced traced(lights);
  double by_rays = 0.0;
  double weighed = 0.0;
  constexpr int kSamples = 1 << 15;
  for (int i = 0; i < kSamples; ++i) {
    const SampleSequence sequence(6, 0, 0, i, kSamples);
    const Vec3 local = cosine_hemisphere(sequence.pair(0));
    const Vec3 direction(local.x(), local.z(), local.y());
    const float cosine_pdf = direction.y() / kPi;
    float distance = 0.0f;
    const LightIndex met = traced.meet(Vec3::Zero(), direction, &distance);
    if (met != kNoLight) {
      const double light = static_cast<double>(lights.radiance(met, Vec3::Zero(), direction).x() * kPi);
      const float pdf = lights.pdf(Vec3::Zero(), Vec3::UnitY(), met, direction, distance);
      by_rays += light;
      weighed += light * static_cast<double>(cosine_pdf / (cosine_pdf + pdf));
    }
    LightSample aim;
    if (!lights.sample(Vec3::Zero(), Vec3::UnitY(), sequence.pair(1).x(), sequence.pair(2), &aim)) continue;
    const float cosine = std::max(0.0f, aim.direction.y());
    const float share = aim.pdf > 0.0f ? aim.pdf / (aim.pdf + cosine / kPi) : 1.0f;
    if (aim.pdf == 0.0f) continue;  // A lamp that no ray can hit.
    weighed += static_cast<double>(aim.radiance_over_pdf.x() * cosine * share);
  }
  EXPECT_NEAR(weighed / by_rays, 1.0, 0.02);
}

TEST(LightSet, scales_exactly_with_the_lights_power) {
  std::vector<scene::Light> lamps = visible_lamps();
  const LightSet lights = set_of(lamps);
  for (const float factor : {0x1p-20f, 0x1p20f}) {
    std::vector<scene::Light> scaled = lamps;
    for (scene::Light& lamp : scaled) lamp.intensity *= factor;
    const LightSet other = set_of(scaled);
    for (int i = 0; i < 200; ++i) {
      const SampleSequence sequence(5, 0, 0, i, 200);
      LightSample a;
      LightSample b;
      const bool any = lights.sample(Vec3::Zero(), Vec3::UnitY(), sequence.pair(0).x(), sequence.pair(1), &a);
      ASSERT_EQ(any, other.sample(Vec3::Zero(), Vec3::UnitY(), sequence.pair(0).x(), sequence.pair(1), &b));
      if (!any) continue;
      EXPECT_EQ(a.direction, b.direction);
      EXPECT_EQ(a.pdf, b.pdf);
      EXPECT_EQ(Vec3(a.radiance_over_pdf * factor), b.radiance_over_pdf);
    }
  }
}

TEST(LightSet, is_finite_for_very_unequal_lights_and_points_on_lights) {
  std::vector<scene::Light> lamps = visible_lamps();
  lamps[0].intensity.setConstant(1e10f);
  lamps[2].intensity.setConstant(1e-3f);
  const Glowing glowing(sphere_mesh(1.0f, 8), 5.0f);
  const LightSet lights = glowing.lights(lamps);
  for (const Vec3& p : {Vec3(0, 2, 0), Vec3(0, 1, -3), Vec3(0, 1, -3.5f), Vec3(0, 3, 4), Vec3(0, 1, 0), Vec3(0, 0, 0),
                        Vec3(1e18f, 0, 0)}) {
    for (const Vec3& n : {Vec3(0, 1, 0), Vec3(0, 0, 0), Vec3(0, -1, 0)}) {
      for (int i = 0; i < 64; ++i) {
        const SampleSequence sequence(9, 0, 0, i, 64);
        LightSample aim;
        if (!lights.sample(p, n, sequence.pair(0).x(), sequence.pair(1), &aim)) continue;
        EXPECT_TRUE(is_finite(aim.radiance_over_pdf) && is_finite(aim.direction)) << p.transpose();
        EXPECT_FALSE(std::isnan(aim.pdf) || std::isnan(aim.distance));
      }
      for (LightIndex light = 0; light < static_cast<LightIndex>(lights.size()); ++light) {
        EXPECT_FALSE(std::isnan(lights.pdf(p, n, light, Vec3::UnitX(), 0.0f))) << light;
      }
    }
  }
}

TEST(LightSet, finds_the_light_of_a_triangle) {
  scene::Mesh mesh = square_mesh(2.0f);
  mesh.triangles.push_back({0, 0, 1});  // A triangle without area.
  const Glowing glowing(std::move(mesh), 1.0f);
  const LightSet lights = glowing.lights({point_light({0, 1, 0}, 1.0f)});
  EXPECT_EQ(lights.triangles(), 2u);
  EXPECT_EQ(lights.of_triangle(0, 0), 1);
  EXPECT_EQ(lights.of_triangle(0, 1), 2);
  EXPECT_EQ(lights.of_triangle(0, 2), kNoLight);
  EXPECT_EQ(lights.of_triangle(7, 0), kNoLight) << "no placement";
}

}  // namespace
}  // namespace cyclorama::render
