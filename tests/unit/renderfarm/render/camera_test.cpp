// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/render/camera.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <cstring>
#include <random>
#include <vector>

#include "tests/data_sets/simple_scenes.h"

namespace cyclorama::render {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kDegree = kPi / 180.0;
constexpr double kHeading = 2.6;

/// The largest pictures, from the narrowest to the widest field of view.
std::vector<PictureShape> large_shapes() {
  return {Panorama{16384, 4096, 2.0 * kPi, 0.8, -0.8},
          Panorama{16384, 16384, 359.9 * kDegree, 3.0, -0.5},
          Panorama{16384, 6000, 20.0 * kDegree, 0.1, -0.1},
          Panorama{16384, 6000, 1e-3 * kDegree, 1e-5, -1e-5},
          Perspective::from_field(16384, 16384, 90.0 * kDegree, 0.3),
          Perspective{16384, 9000, -0.2, 2.0, 0.9, -0.1, -1.0},
          Perspective::from_field(16384, 16384, 1e-3 * kDegree, 0.0),
          Fisheye{16384, 16384, kPi, 0.5 * kPi},
          Fisheye{16384, 12000, 2.0 * kPi, 0.2},
          Fisheye{16384, 16384, 1e-3 * kDegree, 0.2},
          Equirectangular{16384, 8192},
          Equirectangular{16384, 16384, 1e-3 * kDegree, 0.5 * kPi, 0.5 * kPi - 1e-5}};
}

Projection with_eyes(const PictureShape& shape, Eyes eyes, double eye_distance_m = 0.063) {
  Projection projection{shape, {}};
  projection.viewing.eyes = eyes;
  projection.viewing.eye_distance_m = eye_distance_m;
  projection.viewing.screen_distance_m = 3.0;
  return projection;
}

/// Output arrays of the batch functions.
struct Rays {
  explicit Rays(std::size_t count) : exists(count, 7) {
    for (auto& values : floats) values.assign(count, -77.0f);
  }
  [[nodiscard]] CameraRays arrays() {
    return {floats[0].data(), floats[1].data(), floats[2].data(), floats[3].data(),
            floats[4].data(), floats[5].data(), floats[6].data(), exists.data()};
  }
  [[nodiscard]] Vec3 direction(std::size_t i) const { return {floats[3][i], floats[4][i], floats[5][i]}; }

  std::array<std::vector<float>, 7> floats;
  std::vector<std::uint8_t> exists;
};

struct Places {
  std::vector<float> x;
  std::vector<float> y;
};

Places places_in(const Projection& projection, int count, unsigned seed = 5) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit(0.0f, 1.0f);
  Places places;
  for (int i = 0; i < count; ++i) {
    places.x.push_back(unit(random) * static_cast<float>(projection.width_px()));
    places.y.push_back(unit(random) * static_cast<float>(projection.height_px()));
  }
  return places;
}

/// Expects identical bits, and rays that exist for the same pixels.
void expect_same(const RayCamera& a, const RayCamera& b, const Places& places) {
  const auto count = static_cast<int>(places.x.size());
  Rays from_a(places.x.size());
  Rays from_b(places.x.size());
  EXPECT_EQ(a.rays(count, places.x.data(), places.y.data(), from_a.arrays()),
            b.rays(count, places.x.data(), places.y.data(), from_b.arrays()));
  EXPECT_EQ(from_a.exists, from_b.exists);
  for (std::size_t k = 0; k < from_a.floats.size(); ++k) {
    EXPECT_EQ(std::memcmp(from_a.floats[k].data(), from_b.floats[k].data(), sizeof(float) * places.x.size()), 0) << k;
  }
}

TEST(RayCamera, agrees_with_double_precision_to_a_hundredth_of_a_pixel) {
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(-kHeading, Eigen::Vector3d::UnitY()).toRotationMatrix();
  for (const PictureShape& shape : large_shapes()) {
    for (const Eyes eyes : {Eyes::kMono, Eyes::kLeft, Eyes::kRight}) {
      const Projection projection = with_eyes(shape, eyes);
      const RayCamera camera(projection, kHeading);
      const Places places = places_in(projection, 3000);
      for (std::size_t i = 0; i < places.x.size(); ++i) {
        const auto expected = projection.ray_at({static_cast<double>(places.x[i]), static_cast<double>(places.y[i])});
        CameraRay ray;
        ASSERT_EQ(camera.ray(places.x[i], places.y[i], &ray), expected.has_value());
        if (!expected) continue;
        const Eigen::Vector3d direction = ray.direction.cast<double>();
        const double off = direction.cross(turn * expected->direction).norm();
        EXPECT_LT(off, std::max(0.01 * static_cast<double>(ray.cone), 3e-7)) << shape.index() << " at " << i;
        EXPECT_GT(direction.dot(turn * expected->direction), 0.0);
        EXPECT_NEAR(direction.norm(), 1.0, 6e-7);
        EXPECT_LT((ray.origin.cast<double>() - turn * expected->origin).norm(), 1e-7);
      }
    }
  }
}

TEST(RayCamera, two_eyes_at_one_position_have_the_rays_of_one_eye) {
  for (const PictureShape& shape : large_shapes()) {
    const Projection mono = with_eyes(shape, Eyes::kMono);
    const RayCamera camera(mono, kHeading);
    EXPECT_FALSE(camera.moves_eye());
    const Places places = places_in(mono, 500);
    for (const Eyes eyes : {Eyes::kLeft, Eyes::kRight}) {
      expect_same(camera, RayCamera(with_eyes(shape, eyes, 0.0), kHeading), places);
    }
  }
}

TEST(RayCamera, a_stacked_picture_contains_both_eyes_pictures_bit_by_bit) {
  for (const PictureShape& shape :
       {PictureShape(Panorama{800, 300, 2.0, 0.5, -0.5}), PictureShape(Perspective::from_field(800, 300, 1.0, 0.1)),
        PictureShape(Fisheye{512, 512}), PictureShape(Equirectangular{600, 300})}) {
    const RayCamera both(with_eyes(shape, Eyes::kOverUnder), kHeading);
    const RayCamera left(with_eyes(shape, Eyes::kLeft), kHeading);
    const RayCamera right(with_eyes(shape, Eyes::kRight), kHeading);
    Places places = places_in(Projection{shape, {}}, 500);
    // Makes the addition of the other picture's height exact.
    for (float& y : places.y) y = std::floor(y * 16.0f) / 16.0f;
    expect_same(both, left, places);
    Places lower = places;
    for (float& y : lower.y) y += static_cast<float>(height_px(shape));
    const std::size_t count = places.x.size();
    Rays from_both(count);
    Rays from_right(count);
    both.rays(static_cast<int>(count), lower.x.data(), lower.y.data(), from_both.arrays());
    right.rays(static_cast<int>(count), places.x.data(), places.y.data(), from_right.arrays());
    EXPECT_EQ(from_both.exists, from_right.exists);
    for (std::size_t k = 0; k < 7; ++k) EXPECT_EQ(from_both.floats[k], from_right.floats[k]);
  }
}

TEST(RayCamera, a_batch_of_any_length_equals_single_rays_bit_by_bit) {
  for (const PictureShape& shape : large_shapes()) {
    for (const Eyes eyes : {Eyes::kMono, Eyes::kLeft}) {
      const Projection projection = with_eyes(shape, eyes);
      const RayCamera camera(projection, kHeading);
      for (const int count : {0, 1, 3, 16, 37, 100}) {
        const Places places = places_in(projection, count + 1);
        const auto size = static_cast<std::size_t>(count);
        Rays rays(size + 1);
        const int found = camera.rays(count, places.x.data(), places.y.data(), rays.arrays());
        EXPECT_EQ(found, std::count(rays.exists.begin(), rays.exists.end(), std::uint8_t{1}));
        EXPECT_EQ(rays.exists[size], 7);  // Nothing is written beyond the end.
        for (const auto& values : rays.floats) EXPECT_EQ(values[size], -77.0f);
        for (std::size_t i = 0; i < size; ++i) {
          CameraRay one;
          ASSERT_EQ(camera.ray(places.x[i], places.y[i], &one), rays.exists[i] != 0);
          if (rays.exists[i] == 0) continue;
          EXPECT_EQ(one.origin, Vec3(rays.floats[0][i], rays.floats[1][i], rays.floats[2][i]));
          EXPECT_EQ(one.direction, rays.direction(i));
          EXPECT_EQ(one.cone, rays.floats[6][i]);
        }
      }
    }
  }
}

TEST(RayCamera, turning_a_panorama_by_whole_pixels_shifts_it) {
  const Panorama panorama{4096, 512, 2.0 * kPi, 0.5, -0.5};
  const RayCamera ahead(Projection{panorama, {}}, 0.0);
  for (const int columns : {1, 100, 1024, 3000}) {
    const RayCamera turned(Projection{panorama, {}}, columns * panorama.radians_per_px());
    for (int i = 0; i < 500; ++i) {
      const float x = static_cast<float>(i) * 2.17f;
      const float y = static_cast<float>(i) + 0.3f;
      CameraRay a;
      CameraRay b;
      ASSERT_TRUE(ahead.ray(x + static_cast<float>(columns), y, &a));
      ASSERT_TRUE(turned.ray(x, y, &b));
      EXPECT_LT((a.direction - b.direction).norm(), 0.001f * static_cast<float>(panorama.radians_per_px()));
      EXPECT_EQ(a.cone, b.cone);
    }
  }
}

TEST(RayCamera, the_cone_is_the_larger_angle_between_neighbouring_pixels) {
  const Viewing displaced{Eyes::kMono, 0.0, 3.0, {0, 0, -1.5}};  // The centre of the screen is half as far away.
  for (const PictureShape& shape :
       {PictureShape(Panorama{2000, 1000, 5.0, 2.0, -1.0}), PictureShape(Perspective::from_field(2000, 1000, 2.0, 0.1)),
        PictureShape(Fisheye{1000, 1000, 3.0, 0.5}), PictureShape(Equirectangular{2000, 1000})}) {
    const RayCamera camera(Projection{shape, {}}, kHeading);
    const Places places = places_in(Projection{shape, {}}, 300);
    const auto direction = [&](double x, double y) { return direction_at(shape, {x, y})->normalized(); };
    for (std::size_t i = 0; i < places.x.size(); ++i) {
      CameraRay ray;
      const double x = static_cast<double>(places.x[i]);
      const double y = static_cast<double>(places.y[i]);
      if (!camera.ray(places.x[i], places.y[i], &ray) || !direction_at(shape, {x + 1.0, y + 1.0}) ||
          !direction_at(shape, {x - 1.0, y + 1.0}) || !direction_at(shape, {x + 1.0, y - 1.0})) {
        continue;
      }
      // The larger singular value of the derivative is at least the length of each column.
      Eigen::Matrix<double, 3, 2> derivative;
      derivative.col(0) = direction(x + 0.5, y) - direction(x - 0.5, y);
      derivative.col(1) = direction(x, y + 0.5) - direction(x, y - 0.5);
      const double widest = Eigen::JacobiSVD<Eigen::Matrix<double, 3, 2>>(derivative).singularValues()[0];
      EXPECT_NEAR(static_cast<double>(ray.cone) / widest, 1.0, 0.01) << shape.index() << " at " << x << ", " << y;
    }
  }
  const PictureShape wall = Perspective::from_field(1001, 1001, 0.5, 0.0);
  CameraRay near_ray;
  CameraRay far_ray;
  ASSERT_TRUE(RayCamera(Projection{wall, displaced}, 0.0).ray(500.5f, 500.5f, &near_ray));
  ASSERT_TRUE(RayCamera(Projection{wall, {}}, 0.0).ray(500.5f, 500.5f, &far_ray));
  EXPECT_NEAR(near_ray.cone, 2.0f * far_ray.cone, 1e-6f * far_ray.cone);
}

TEST(RayCamera, there_are_no_rays_outside_a_fisheyes_circle) {
  const RayCamera camera(Projection{Fisheye{100, 60, kPi, 0.0}, {}}, 0.0);
  EXPECT_TRUE(camera.leaves_out_pixels());
  CameraRay ray;
  EXPECT_FALSE(camera.ray(19.5f, 30.0f, &ray));
  EXPECT_TRUE(camera.ray(20.5f, 30.0f, &ray));
  EXPECT_FALSE(camera.ray(0.5f, 0.5f, &ray));
  EXPECT_TRUE(camera.ray(50.0f, 30.0f, &ray));
  EXPECT_EQ(ray.direction, Vec3(0, 0, -1));
}

TEST(RayCamera, a_360_degree_fisheye_looks_backwards_at_its_edge) {
  const RayCamera camera(Projection{Fisheye{1000, 1000, 2.0 * kPi, 0.0}, {}}, 0.0);
  CameraRay ray;
  for (int i = 0; i < 16; ++i) {
    const double angle = i * kPi / 8.0;
    ASSERT_TRUE(camera.ray(static_cast<float>(500.0 + 499.999 * std::sin(angle)),
                           static_cast<float>(500.0 + 499.999 * std::cos(angle)), &ray));
    EXPECT_LT((ray.direction - Vec3(0, 0, 1)).norm(), 1e-4f);
  }
}

TEST(RayCamera, every_projection_shows_the_same_scene) {
  scene::Scene scene = scene_of(square_mesh(200.0f));
  scene.model.lights = {point_light({0, 2, 0}, 10.0f)};
  const auto renderer = *Renderer::build(std::move(scene), 1, nullptr);
  // Looks down onto the plane, 45 degrees below the horizon: the law of a point light holds for every shape.
  const auto middle = [&](const PictureShape& shape) {
    PanoramaView view;
    view.eye = {0, 1, 0};
    view.projection = Projection{shape, {}};
    EXPECT_TRUE(check_view(view, {0, 0, 1, 1}).has_value());
    RadianceImage pixel;
    renderer->render_radiance(view, {0, 0, 1, 1}, &pixel, nullptr);
    return static_cast<double>(pixel.at(0, 0)[0]);
  };
  const double law = 10.0 * 2.0 / std::pow(5.0, 1.5) / kPi * 0.5;
  const double small = 1e-4;
  EXPECT_NEAR(middle(Panorama{1, 1, small, -1.0 + small, -1.0 - small}) / law, 1.0, 1e-3);
  EXPECT_NEAR(middle(Perspective::from_field(1, 1, small, -0.25 * kPi)) / law, 1.0, 1e-3);
  EXPECT_NEAR(middle(Fisheye{1, 1, small, -0.25 * kPi}) / law, 1.0, 1e-3);
  EXPECT_NEAR(middle(Equirectangular{1, 1, small, -0.25 * kPi + small, -0.25 * kPi - small}) / law, 1.0, 1e-3);
}

TEST(RayCamera, a_picture_is_black_where_the_fisheye_has_no_ray) {
  scene::Scene scene = scene_of(sphere_mesh(5.0f, 8));
  scene.ambient = Eigen::Vector3f::Ones();
  const auto renderer = *Renderer::build(std::move(scene), 1, nullptr);
  PanoramaView view;
  view.projection = Projection{Fisheye{40, 40, 2.0 * kPi, 0.0}, {}};
  RadianceImage image;
  const RenderCost cost = renderer->render_radiance(view, {0, 0, 40, 40}, &image, nullptr);
  EXPECT_EQ(image.at(0, 0)[0], 0.0f);
  EXPECT_EQ(image.at(39, 39)[2], 0.0f);
  EXPECT_NEAR(image.at(20, 20)[0], 0.5f, 1e-5f);
  EXPECT_NEAR(static_cast<double>(cost.rays), 1600.0 * kPi / 4.0, 60.0);
}

TEST(RayCamera, a_near_object_appears_where_each_eye_sees_it) {
  scene::Scene scene = scene_of(sphere_mesh(0.02f, 16));
  scene.ambient = Eigen::Vector3f::Ones();
  const auto renderer = *Renderer::build(std::move(scene), 1, nullptr);
  const auto centre = [&](Eyes eyes, double distance_m) {
    PanoramaView view;
    view.eye = {0, 0, distance_m};
    view.projection = with_eyes(Panorama{400, 100, 0.4, 0.05, -0.05}, eyes);
    view.projection->viewing.screen_distance_m = 1.0;
    RadianceImage image;
    renderer->render_radiance(view, {0, 0, 400, 100}, &image, nullptr);
    double sum = 0.0;
    double moment = 0.0;
    for (int y = 0; y < 100; ++y) {
      for (int x = 0; x < 400; ++x) {
        sum += static_cast<double>(image.at(x, y)[0]);
        moment += (x + 0.5) * static_cast<double>(image.at(x, y)[0]);
      }
    }
    return moment / sum;
  };
  EXPECT_NEAR(centre(Eyes::kLeft, 1.0), centre(Eyes::kRight, 1.0), 0.5);
  // Beyond the screen, the two images of a point are separated by eye distance times (1/1 m - 1/2 m), as an angle.
  EXPECT_NEAR(centre(Eyes::kRight, 2.0) - centre(Eyes::kLeft, 2.0), 0.063 * 0.5 * 1000.0, 1.0);
  EXPECT_NEAR(centre(Eyes::kMono, 2.0), 200.0, 0.5);
}

}  // namespace
}  // namespace cyclorama::render
