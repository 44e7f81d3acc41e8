// SPDX-License-Identifier: Apache-2.0
/// colours.json: how bright each projector's pixels may be and which codes make its light, beside a calibration's maps.
///
///     FOLDER/calibrations/DATE/colours.json      absent where only geometry was measured
///     FOLDER/calibrations/DATE/N.mask.png        of projector N (from 1): grey, 16 bits: a factor on linear light,
///                                                65535 is 1
///     FOLDER/calibrations/DATE/N.black_lift.png        the same of the head's black; where there is any
///
///     {"format": "cyclorama-colours", "version": 1,
///      "projectors": [{"name": "left", "mask": "1.mask.png",
///                      "black_lift": "1.black_lift.png", "black_linear": [0.002, 0.002, 0.003],     with `black_lift` only
///                      "matrix": [[0.98, 0.01, 0], [0.01, 0.97, 0], [0, 0, 1]],            or left out
///                      "response": {"red": [0, ..., 1], "green": [...], "blue": [...]}}]}  or left out: sRGB
///
/// Matrix, black and response as HeadColour has them (appliance/warp/head_colour.h).
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "appliance/warp/blend_mask.h"
#include "appliance/warp/head_colour.h"
#include "common/base/result.h"

namespace cyclorama::calibration {

struct CalibratedColour {
  std::string name;  ///< The projector's.
  warp::MaskImage mask;
  warp::HeadColour colour;
};

/// Without the pictures: their files' names stand in it.
[[nodiscard]] std::string colours_json(std::span<const CalibratedColour> colours);
/// The opposite: masks are empty, a black_lift too. Errors as parse_calibration().
Result<std::vector<CalibratedColour>> parse_colours(std::string_view text, const std::string& name);

/// Into a calibration's own folder, pictures first. kInvalidArgument  a projector's name twice.     kSystem  errno says
/// why.
Status write_colours(const std::filesystem::path& own_folder, std::span<const CalibratedColour> colours);
/// None where there is no colours.json. kBadData  a file is not what it should be, and which; sizes of pictures are the
/// caller's to compare.
Result<std::vector<CalibratedColour>> read_colours(const std::filesystem::path& own_folder);

}  // namespace cyclorama::calibration
