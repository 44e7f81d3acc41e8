// SPDX-License-Identifier: Apache-2.0
/// A front in a file, as `cyclorama-render trade` measures one:
///
///   [[point]]
///   cpu_us_per_px = 1.9   # Processor time of a shown pixel.
///   error = 0.041         # In one measure for the whole file.
///   samples = 4           # The knobs of PictureQuality; one that is left out has its default.
///   bounces = 1
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "common/base/result.h"
#include "renderfarm/governor/front.h"

namespace cyclorama {

/// Errors as Config's; kBadData also for a file without a point. Reentrant.
Result<Front> read_front(const std::filesystem::path& path);
/// `name` stands for the file in errors.
Result<Front> parse_front(std::string_view text, std::string name);

/// parse_front() gives the same front back, bit by bit. `comment` comes first, each of its lines after "# ".
[[nodiscard]] std::string front_text(const Front& front, std::string_view comment);

}  // namespace cyclorama
