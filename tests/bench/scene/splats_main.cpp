// SPDX-License-Identifier: Apache-2.0
// Gaussian splats: the error against the equations in double, memory, and rays per cpu-second.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <atomic>
#include <ctime>

#include "common/base/cpu_time.h"
#include "renderfarm/render/splats/splat_scene.h"
#include "tests/data_sets/random_splats.h"

namespace cyclorama {
namespace {

std::atomic<std::int64_t> embree_bytes = 0;

bool count_bytes(void* /*user*/, ssize_t bytes, bool /*post*/) {
  embree_bytes += bytes;
  return true;
}

struct Errors {
  double equations = 0.0;   ///< In code values, largest of all rays.
  double rasteriser = 0.0;  ///< In code values, mean of all rays; its order and its projection differ.
};

/// Compares rays from a distance with the equations along the ray, and with the original projection.
Errors errors_of(RTCDevice device) {
  const scene::SplatCloud cloud = random_splats({.count = 200}, 1);
  const auto scene = render::SplatScene::build(std::span(&cloud, 1), Eigen::Vector3d::Zero(), device);
  const std::vector<ExactSplat> splats = exact_splats(cloud);
  const Eigen::Vector3d eye(0, 0, 5);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> across(-0.25, 0.25);
  constexpr int kRays = 2000;
  Errors errors;
  for (int i = 0; i < kRays; ++i) {
    const Eigen::Vector3d direction = Eigen::Vector3d(across(random), across(random), -1.0).normalized();
    const render::SplatLight light =
        (*scene)->trace(eye.cast<float>(), direction.cast<float>(), std::numeric_limits<float>::infinity());
    const auto code_error = [&](const SplatView& view) {
      return 255.0 * (light.colour.cast<double>() - view.colour).cwiseAbs().maxCoeff();
    };
    errors.equations = std::max(errors.equations, code_error(exact_view(cloud, splats, eye, direction, 1e9)));
    errors.rasteriser += code_error(rasterised_view(cloud, splats, eye, direction)) / kRays;
  }
  return errors;
}

/// Splats on the walls of a round room about the eye, each about as large as the distance to the next: what training
/// leaves of a room. Half of them are faint.
scene::SplatCloud room_of_splats(std::size_t count) {
  constexpr double kRadiusM = 5.0;
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> opacity(0.02, 1.0);
  const double spacing = kRadiusM * std::sqrt(4.0 * std::numbers::pi / static_cast<double>(count));
  scene::SplatCloud cloud;
  cloud.degree = 3;
  std::vector<std::array<float, 3>> coefficients(cloud.coefficient_count());
  for (std::size_t i = 0; i < count; ++i) {
    scene::SplatValues values;
    const Eigen::Vector3d out = Eigen::Vector3d(normal(random), normal(random), normal(random)).normalized();
    values.position = (kRadiusM + 0.05 * normal(random)) * out;
    values.rotation = Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), out);
    values.scale = {spacing, spacing, 0.1 * spacing};
    values.opacity = opacity(random);
    for (auto& rgb : coefficients) {
      for (float& channel : rgb) channel = static_cast<float>(0.2 * normal(random));
    }
    scene::add_splat(values, coefficients, &cloud);
  }
  return cloud;
}

int measure(std::size_t count) {
  const RTCDevice device = rtcNewDevice("threads=2");
  const Errors errors = errors_of(device);
  const scene::SplatCloud cloud = room_of_splats(count);
  rtcSetDeviceMemoryMonitorFunction(device, &count_bytes, nullptr);
  const std::clock_t before_build = std::clock();
  const auto scene = render::SplatScene::build(std::span(&cloud, 1), Eigen::Vector3d::Zero(), device);
  if (!scene) {
    fmt::print(stderr, "{}\n", scene.error().message());
    return 1;
  }
  const double build_s = static_cast<double>(std::clock() - before_build) / CLOCKS_PER_SEC;
  const double gib =
      static_cast<double>(cloud.memory_bytes() + (*scene)->bytes() + static_cast<std::size_t>(embree_bytes.load())) /
      static_cast<double>(std::size_t{1} << 30);
  // A picture of 512x512 over 60 degrees, row by row as cameras do.
  constexpr int kSide = 512;
  const double before = thread_cpu_seconds();
  double seen = 0.0;
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      const Eigen::Vector3f direction(1.15f * (static_cast<float>(x) / kSide - 0.5f),
                                      1.15f * (static_cast<float>(y) / kSide - 0.5f), -1.0f);
      seen +=
          double{(*scene)
                     ->trace(Eigen::Vector3f::Zero(), direction.normalized(), std::numeric_limits<float>::infinity())
                     .transmittance};
    }
  }
  const double mrays = 1e-6 * kSide * kSide / (thread_cpu_seconds() - before);
  fmt::print(
      "{} splats of degree 3: built in {:.1f} cpu-s, {:.2f} GiB, {:.3f} million rays per cpu-s, {:.1f} % of the "
      "rays pass\n",
      cloud.size(), build_s, gib, mrays, 100.0 * seen / (kSide * kSide));
  fmt::print(
      "200 splats, 2000 rays: at most {:.3f} codes from the equations along the ray; {:.2f} on average from the "
      "original's projection and order\n",
      errors.equations, errors.rasteriser);
  fmt::print(
      "{{\"benchmark\": \"splats\", \"splats\": {}, \"code_error\": {:.4f}, \"rasteriser_mean_code_error\": {:.3f}, "
      "\"mrays_per_cpu_s\": {:.4f}, \"build_cpu_s\": {:.2f}, \"gib\": {:.3f}}}\n",
      cloud.size(), errors.equations, errors.rasteriser, mrays, build_s, gib);
  rtcReleaseDevice(device);
  return 0;
}

}  // namespace
}  // namespace cyclorama

int main(int argc, char** argv) {
  CLI::App app("Measures Gaussian splats");
  std::size_t splats = 1'000'000;
  bool quick = false;
  app.add_option("--splats", splats, "Number of splats");
  app.add_flag("--quick", quick, "100,000 splats");
  CLI11_PARSE(app, argc, argv);
  return cyclorama::measure(quick ? 100'000 : splats);
}
