// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "appliance/display/head_upload.h"
#include "common/room/installation.h"

namespace cyclorama::display {

/// What the heads draw with as long as nothing was measured: an installation's model, and warps of other programs.
/// kInvalidArgument  the picture is none. Errors of measured_head().
Result<std::vector<HeadPlan>> planned_heads(const Installation& installation, const PictureShape& picture);

/// What a calibration makes of the heads.
struct CalibratedHeads {
  std::vector<HeadPlan> heads;              ///< As the installation's projectors.
  std::string date;                         ///< The calibration's.
  std::vector<std::string> lacking;         ///< Projectors of which it knows nothing: they keep what was planned.
  std::vector<std::string> corrected = {};  ///< Those that moved since, and are drawn for from where they stand now.
};

/// Reads FOLDER/calibration.json with its maps, and colours where there are any (appliance/calibration). Without
/// colours the projectors are blended by where their maps lie; a projector that it does not know is blended as planned.
/// FOLDER/correction.json moves projectors from where they were measured to where they stand now, if it is of this
/// calibration (appliance/healing).
/// A head of two eyes' pictures side by side or one above the other keeps to the maps: colours are of whole heads.
/// Takes seconds. Reentrant.
/// kNotFound  there is no calibration.     kBadData  as read_calibration() and read_colours().     kInvalidArgument  it
/// is of other projectors: none of these, or of another size.
Result<CalibratedHeads> calibrated_heads(const std::filesystem::path& folder, const Installation& installation,
                                         const PictureShape& picture, std::vector<HeadPlan> planned);

}  // namespace cyclorama::display
