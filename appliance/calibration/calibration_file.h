// SPDX-License-Identifier: Apache-2.0
/// calibration.json: what a calibration found, and how sure it is, for displays, operators and the next calibration.
///
///     FOLDER/calibration.json                     the one that counts; replaced by a rename, so whole or not at all
///     FOLDER/calibrations/DATE/calibration.json   the same, kept: to go back to
///     FOLDER/calibrations/DATE/N.map.pfm          directions of the control points of projector N (from 1); NaN: none
///     FOLDER/calibrations/DATE/N.sigma.pfm        how sure they are, in projector pixels; infinite where there is none
///     FOLDER/calibrations/DATE/colours.json       brightness and colours, if they were measured: colour_file.h
///     FOLDER/calibrations/DATE/light.json         what they were made from: photometry/light_file.h
///
/// FOLDER/calibration.json is written last, and the others are never changed: whoever reads it finds all that belongs
/// to it, also after a power cut. What a power cut left unfinished counts for nothing, and goes with the next one.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "appliance/calibration/calibration.h"
#include "appliance/calibration/colour_file.h"
#include "common/base/result.h"

namespace cyclorama::calibration {

/// A calibration as text, without its maps: their files' names stand in it.
[[nodiscard]] std::string calibration_json(const Calibration& calibration);

/// The opposite: maps have their sizes and no directions. `name` stands for the file in errors.
/// kBadData  "calibration.json: /projectors/0/cells_x: ...; remedy": a key that is missing, unknown or of another kind,
/// a number out of range, counts that do not fit one another, or no JSON at all (then the byte).
Result<Calibration> parse_calibration(std::string_view text, const std::string& name);

/// A file of a calibration's own folder that others read and write.
struct CalibrationPart {
  std::string file;  ///< Its name, without folders.
  std::string text;
};

/// Writes all files, then replaces FOLDER/calibration.json. Keeps the newest ten. kInvalidArgument  the date is no
/// folder's name, or there is one of that date already; a part's name is no file's; or as write_colours().
/// kSystem  errno says why. Nothing that counts has changed then.
Status save_calibration(const std::filesystem::path& folder, const Calibration& calibration,
                        std::span<const CalibratedColour> colours = {}, std::span<const CalibrationPart> parts = {});

/// FOLDER/calibration.json and its maps. Errors as parse_calibration(), and the files'.
Result<Calibration> read_calibration(const std::filesystem::path& folder);

/// Where the maps, colours and pictures of the calibration of that date lie. Precondition: it was read from there.
[[nodiscard]] std::filesystem::path calibration_folder(const std::filesystem::path& folder, const std::string& date);

/// Dates that can be gone back to, the newest first.
[[nodiscard]] std::vector<std::string> kept_calibrations(const std::filesystem::path& folder);

/// Makes the calibration of that date the one that counts, after reading all of it. kNotFound  there is none of that
/// date.
Status restore_calibration(const std::filesystem::path& folder, const std::string& date);

}  // namespace cyclorama::calibration
