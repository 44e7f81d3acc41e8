// SPDX-License-Identifier: Apache-2.0
/// A Pareto front in a file, as measured by `cyclorama-bench-render trade`:
///
///   # front.toml
///   [[point]]
///   cpu_us_per_px = 1.9   # Processor time per displayed pixel.
///   error = 0.041         # The same measure for the whole file.
///   samples = 4           # Parameters of PictureQuality; those left out have their defaults.
///   bounces = 1
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "common/base/result.h"
#include "renderfarm/governor/front.h"

namespace cyclorama {

/// Reads a file. Errors: those of Config, and kBadData for a file without points. Reentrant.
Result<Front> read_front(const std::filesystem::path& path);
/// Parses a file's text. `name` identifies the file in errors.
Result<Front> parse_front(std::string_view text, std::string name);

/// Formats a front; parse_front() restores it bit for bit. `comment` comes first, with "# " before each of its lines.
[[nodiscard]] std::string front_text(const Front& front, std::string_view comment);

}  // namespace cyclorama
