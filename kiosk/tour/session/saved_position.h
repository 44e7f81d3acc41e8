// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <string_view>

#include "common/base/result.h"

namespace cyclorama::tour {

/// A visitor's position in a file, so that a restarted tour continues there. A few lines of TOML:
///
///   # place.toml
///   scene = "grotto"
///   x_m = 1.25
///   z_m = -3.5
///   heading_rad = 0.7
struct SavedPosition {
  std::string scene;
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();  ///< (x, z) in the Scene frame.
  double heading_rad = 0.0;

  friend bool operator==(const SavedPosition&, const SavedPosition&) = default;
};

[[nodiscard]] std::string to_text(const SavedPosition& position);
/// Errors: kBadData with file, line and remedy. `name` stands for the file in errors.
Result<SavedPosition> parse_saved_position(std::string_view text, std::string name);

/// Returns the path of the file in a tour's folder.
[[nodiscard]] std::filesystem::path saved_position_path(const std::filesystem::path& folder);

}  // namespace cyclorama::tour
