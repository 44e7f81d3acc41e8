// SPDX-License-Identifier: Apache-2.0
/// light.json: the projectors' light from which the brightness and colours of a calibration were computed, so that new
/// masks for a displaced projector need no new photographs of its light.
///
///     FOLDER/calibrations/DATE/light.json      beside colours.json
///
///     {"format": "cyclorama-light", "version": 2,
///      "ambient": [[r by x, y, z, 1], [g ...], [b ...]],
///      "projectors": [{"name": "left", "width_px": 1920, "height_px": 1080, "cells_x": 8, "cells_y": 5,
///                      "log_white": [...], "min": -1.2, "max": 0.3,         a bicubic spline's coefficients
///                      "primaries": [[...], [...], [...]], "black_level": [r, g, b]}]}
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "appliance/calibration/calibration_file.h"
#include "appliance/photometry/wall_light.h"

namespace cyclorama::photometry {

struct SavedLight {
  std::vector<std::string> names;  ///< Names of the projectors.
  WallLighting lighting;           ///< Input of the masks, without vignetting.
};

[[nodiscard]] std::string light_json(const SavedLight& light);
/// Parses the result of light_json(). `name` is the file's name in errors. Errors: kBadData, as in "light.json:
/// /projectors/0/black_level: ...; remedy".
Result<SavedLight> parse_light(std::string_view text, const std::string& name);

/// Returns light.json as a part for save_calibration(), which writes it before the calibration takes effect. Errors:
/// kInvalidArgument if the numbers of projectors and of their lighting differ.
Result<calibration::CalibrationPart> light_part(std::span<const calibration::CalibratedProjector> projectors,
                                                const WallLighting& lighting);
/// Reads light.json from a calibration's folder. Errors: kNotFound if there is no such file; otherwise those of
/// parse_light().
Result<WallLighting> read_light(const std::filesystem::path& own_folder);

}  // namespace cyclorama::photometry
