// SPDX-License-Identifier: Apache-2.0
/// light.json: what each projector lights, as brightness and colours of a calibration were made from, so that masks can
/// follow a projector that is moved without photographs of light.
///
///     FOLDER/calibrations/DATE/light.json      beside colours.json
///
///     {"format": "cyclorama-light", "version": 1,
///      "ambient": [[r by x, y, z, 1], [g ...], [b ...]],
///      "projectors": [{"name": "left", "width_px": 1920, "height_px": 1080, "cells_x": 8, "cells_y": 5,
///                      "log_white": [...], "least": -1.2, "most": 0.3,       a bicubic spline's coefficients
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
  std::vector<std::string> names;  ///< Of the projectors.
  WallLighting lighting;           ///< What masks are made from: no vignetting, no remarks.
};

[[nodiscard]] std::string light_json(const SavedLight& light);
/// The opposite. kBadData  "light.json: /projectors/0/black_level: ...; remedy", as parse_calibration().
Result<SavedLight> parse_light(std::string_view text, const std::string& name);

/// For save_calibration(), which writes it before the calibration counts. kInvalidArgument  not as many projectors as
/// their light.
Result<calibration::CalibrationPart> light_part(std::span<const calibration::CalibratedProjector> projectors,
                                                const WallLighting& lighting);
/// kNotFound  there is none.     Others as parse_light().
Result<WallLighting> read_light(const std::filesystem::path& own_folder);

}  // namespace cyclorama::photometry
