// SPDX-License-Identifier: Apache-2.0
/// The ray kernels: from a cell of pixels to its radiance. One for each combination of needs, compiled without the
/// rest.
#pragma once

#include <cstdint>

#include "renderfarm/render/camera.h"
#include "renderfarm/render/requirements.h"
#include "renderfarm/render/trace_scene.h"

namespace cyclorama {

/// A PanoramaView in the render frame.
struct TraceView {
  Vec3 eye = Vec3::Zero();
  Camera camera;
  int samples = 1;
  std::uint64_t seed = 0;
};

/// A piece of work: pixels [x, x + width) by [y, y + height) of the picture, written from `radiance` on, three floats
/// a pixel, rows `stride` floats apart. Borrowed.
struct TraceCell {
  int x = 0;
  int y = 0;
  int width = 0;
  int height = 0;
  float* radiance = nullptr;
  std::size_t stride = 0;
};

/// Mean radiance of each pixel, finite and not negative. Returns the number of rays. Reentrant.
using Kernel = std::uint64_t (*)(const TraceScene& scene, const TraceView& view, const TraceCell& cell);

[[nodiscard]] Kernel kernel_for(const SceneNeeds& needs);

}  // namespace cyclorama
