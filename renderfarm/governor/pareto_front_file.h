// SPDX-License-Identifier: Apache-2.0
/// A file with a Pareto front, as measured by `cyclorama-bench-render trade`:
///
///   # pareto_front.toml
///   [[point]]
///   cpu_us_per_px = 1.9   # Processor time per displayed pixel.
///   error = 0.041         # The same measure for the whole file.
///   samples = 4           # Parameters of PictureQuality; omitted ones have their defaults.
///   bounces = 1
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "common/base/result.h"
#include "renderfarm/governor/front.h"

namespace cyclorama::governor {

/// Name of the file, which is in the scene's folder.
inline constexpr const char* kParetoFrontFileName = "pareto_front.toml";

/// Reads a file. Errors: those of Config, and kBadData for a file without points. Reentrant.
Result<ParetoFront> read_pareto_front(const std::filesystem::path& path);
/// Parses a file's text. `name` identifies the file in errors.
Result<ParetoFront> parse_pareto_front(std::string_view text, std::string name);

/// Formats a front. parse_pareto_front() restores it bit for bit. The text begins with `comment`, with "# " before each
/// line.
[[nodiscard]] std::string pareto_front_text(const ParetoFront& front, std::string_view comment);

}  // namespace cyclorama::governor
