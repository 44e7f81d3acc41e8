// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>

#include "renderfarm/quality/shown_error.h"
#include "renderfarm/tools/render_command.h"

namespace cyclorama::tools {

struct LightErrors {
  double mse = 0.0;
  double relmse = 0.0;
};

struct Comparison {
  /// Set only for two PFM files, because code values do not contain the light above white.
  std::optional<LightErrors> light;
  quality::ShownError shown;
};

/// Compares PFM, PNG or JPEG files, detected by their first bytes. Light is tone mapped with the standard curve before
/// it is compared as shown. Errors: those of the readers and of shown_error(); kBadData also if light is not finite.
Result<Comparison> compare_files(const std::filesystem::path& picture, const std::filesystem::path& reference);

/// Adds `cyclorama-render compare PICTURE REFERENCE`, which prints the errors between two pictures.
[[nodiscard]] RenderCommand add_compare_command(CLI::App* program);

}  // namespace cyclorama::tools
