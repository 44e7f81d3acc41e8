// SPDX-License-Identifier: Apache-2.0
// Draws a hand with the standard wand as seen by a camera, for tests/image: test-wand FILE YAW_DEG DISTANCE_M writes
// 640x480 grey bytes.
#include <fmt/format.h>

#include <cstdlib>
#include <fstream>
#include <numbers>

#include "drivers/simulated/camera/simulated_camera.h"

int main(int argc, char** argv) {
  using namespace cyclorama;
  if (argc != 4) {
    fmt::print(stderr, "test-wand: FILE YAW_DEG DISTANCE_M\n");
    return 2;
  }
  simulated::KeyPose key;
  key.position_m = {0.0, 0.0, std::atof(argv[3])};
  key.yaw_rad = std::atof(argv[2]) * std::numbers::pi / 180.0;
  auto path = simulated::HandPath::make({key}, std::nullopt);
  if (!path) {
    fmt::print(stderr, "test-wand: {}\n", path.error().message());
    return 1;
  }
  simulated::Simulation simulation;
  simulation.path = *std::move(path);
  const GreyImage picture = simulated::SimulatedView(std::move(simulation)).picture(0);
  std::ofstream file(argv[1], std::ios::binary);
  file.write(reinterpret_cast<const char*>(picture.data().data()), static_cast<std::streamsize>(picture.data().size()));
  file.flush();
  return file ? 0 : 1;
}
