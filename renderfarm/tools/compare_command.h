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
  std::optional<LightErrors> light;  ///< Only for two PFM files: code values have lost the light above white.
  quality::ShownError shown;
};

/// Compares PFM, PNG or JPEG files, detected by their first bytes. Light is tone mapped with the standard curve before
/// it is compared as shown. Errors as the readers' and shown_error(); kBadData also for light that is not finite.
Result<Comparison> compare_files(const std::filesystem::path& picture, const std::filesystem::path& reference);

/// `cyclorama-render compare PICTURE REFERENCE`: the errors between two pictures.
[[nodiscard]] RenderCommand add_compare_command(CLI::App* program);

}  // namespace cyclorama::tools
