// SPDX-License-Identifier: Apache-2.0
/// colours.json: the mask and colour correction of each projector, beside a calibration's maps.
///
///     FOLDER/calibrations/DATE/colours.json        absent if only geometry was measured
///     FOLDER/calibrations/DATE/N.mask.png          mask of projector N (from 1), grey, 16 bits: a factor on linear
///                                                  light, 65535 is 1
///     FOLDER/calibrations/DATE/N.black_lift.png    black lift in the same format, if there is any
///
///     {"format": "cyclorama-colours", "version": 2,
///      "projectors": [{"name": "left", "mask": "1.mask.png",
///                      "black_lift": "1.black_lift.png", "black_linear": [0.002, 0.002, 0.003],  both or neither
///                      "matrix": [[0.98, 0.01, 0], [0.01, 0.97, 0], [0, 0, 1]],            may be absent
///                      "response": {"red": [0, ..., 1], "green": [...], "blue": [...]}}]}  absent: sRGB
///
/// Matrix, black and response are those of HeadColour (appliance/warp/head_colour.h).
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
  std::string name;  ///< Name of the projector.
  warp::MaskImage mask;
  warp::HeadColour colour;
};

/// Returns the colours as text. The pictures are not included, but the names of their files are.
[[nodiscard]] std::string colours_json(std::span<const CalibratedColour> colours);
/// Inverse of colours_json(): masks and black lifts are empty. Errors: those of parse_calibration().
Result<std::vector<CalibratedColour>> parse_colours(std::string_view text, const std::string& name);

/// Writes to a calibration's own folder, pictures first. Errors: kInvalidArgument for a duplicate projector name;
/// kSystem with the reason from errno.
Status write_colours(const std::filesystem::path& own_folder, std::span<const CalibratedColour> colours);
/// Returns an empty list if there is no colours.json. The caller must check the pictures' sizes. Errors: kBadData, with
/// the file's name, for malformed contents.
Result<std::vector<CalibratedColour>> read_colours(const std::filesystem::path& own_folder);

}  // namespace cyclorama::calibration
