// SPDX-License-Identifier: Apache-2.0
/// Extreme scenes, and checks of their pictures.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "renderfarm/render/renderer.h"
#include "renderfarm/scene/scene.h"

namespace cyclorama {

struct ExtremePicture {
  scene::Scene scene;
  render::PanoramaView view;
};

/// The scene emits light everywhere, so that no pixel may be black.
struct PictureCase {
  std::string name;
  /// `scratch` is a folder for cases that read files. An error is a failure of the case.
  std::function<Result<ExtremePicture>(const std::filesystem::path& scratch)> make;
};

/// Defined in surface_cases.cpp and light_cases.cpp.
[[nodiscard]] std::vector<PictureCase> surface_cases();
[[nodiscard]] std::vector<PictureCase> light_cases();
[[nodiscard]] std::vector<PictureCase> all_picture_cases();

struct PictureVerdict {
  int pixels = 0;
  std::uint64_t broken_samples = 0;  ///< Samples that were NaN.
  int not_finite = 0;                ///< Pixels of the film, of its features, or of the denoised picture.
  int black = 0;                     ///< Pixels of the film or of the denoised picture.
  double seconds = 0.0;              ///< Time for building and rendering.
  [[nodiscard]] int nan_pixels() const { return not_finite + static_cast<int>(broken_samples); }
  [[nodiscard]] bool holds() const { return broken_samples == 0 && not_finite == 0 && black == 0; }
};

/// Errors as PictureCase::make and Renderer::build().
Result<PictureVerdict> judge(const PictureCase& extreme, const std::filesystem::path& scratch, int threads);

}  // namespace cyclorama
