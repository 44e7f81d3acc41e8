// SPDX-License-Identifier: Apache-2.0
/// calibration.json: the result of a calibration with its uncertainties, for displays, operators and later scans.
///
///     FOLDER/calibration.json                     the current calibration; replaced atomically by a rename
///     FOLDER/calibrations/DATE/calibration.json   the same, kept for restoring
///     FOLDER/calibrations/DATE/N.map.pfm          directions of the control points of projector N (from 1); NaN: none
///     FOLDER/calibrations/DATE/N.sigma.pfm        their sigmas, in projector pixels; infinite where there is none
///     FOLDER/calibrations/DATE/colours.json       brightness and colours, if they were measured: colour_file.h
///     FOLDER/calibrations/DATE/light.json         the light that they were computed from: photometry/light_file.h
///
/// FOLDER/calibration.json is written last, and the other files are never changed, so a reader always finds all files
/// that belong to it, even after a power cut. An unfinished calibration is ignored, and the next calibration removes
/// it.
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

/// Returns a calibration as text. The maps are not included, but the names of their files are.
[[nodiscard]] std::string calibration_json(const Calibration& calibration);

/// Inverse of calibration_json(): maps have their sizes but no directions. `name` stands for the file in errors.
/// Errors: kBadData, such as "calibration.json: /projectors/0/cells_x: ...; remedy", for a key that is missing, unknown
/// or of another type, a number out of range, inconsistent counts, or text that is not JSON (then with the byte).
Result<Calibration> parse_calibration(std::string_view text, const std::string& name);

/// An additional file in a calibration's own folder, which other modules read and write.
struct CalibrationPart {
  std::string file;  ///< File name without folders.
  std::string text;
};

/// Writes all files, then replaces FOLDER/calibration.json. Keeps the newest ten calibrations. Errors: kInvalidArgument
/// if the date cannot be a folder's name or already exists, or if a part's name cannot be a file name; kSystem with the
/// reason from errno; those of write_colours(). After an error the current calibration is unchanged.
Status save_calibration(const std::filesystem::path& folder, const Calibration& calibration,
                        std::span<const CalibratedColour> colours = {}, std::span<const CalibrationPart> parts = {});

/// Reads FOLDER/calibration.json and its maps. Errors: those of parse_calibration(), and those of reading the files.
Result<Calibration> read_calibration(const std::filesystem::path& folder);

/// Returns the folder with the maps, colours and pictures of the calibration of `date`. Precondition: a calibration of
/// that date was read from `folder`.
[[nodiscard]] std::filesystem::path calibration_folder(const std::filesystem::path& folder, const std::string& date);

/// Returns the dates that can be restored, newest first.
[[nodiscard]] std::vector<std::string> kept_calibrations(const std::filesystem::path& folder);

/// Makes the calibration of that date the current one, after reading all of it. Errors: kNotFound if there is none of
/// that date; those of read_calibration().
Status restore_calibration(const std::filesystem::path& folder, const std::string& date);

}  // namespace cyclorama::calibration
