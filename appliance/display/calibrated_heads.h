// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "appliance/display/head_upload.h"
#include "common/room/installation.h"

namespace cyclorama::display {

/// Returns the plans of the heads before anything is measured: from the installation's model, or from warps that other
/// programs measured. Errors: kInvalidArgument if the picture's shape is invalid; those of measured_head().
Result<std::vector<HeadPlan>> planned_heads(const Installation& installation, const PictureShape& picture);

/// The heads as a calibration defines them.
struct CalibratedHeads {
  std::vector<HeadPlan> heads;       ///< In the order of the installation's projectors.
  std::string date;                  ///< Date of the calibration.
  std::vector<std::string> lacking;  ///< Projectors that the calibration lacks; they keep their planned heads.
  /// Projectors that were displaced since the calibration; their heads draw for the present poses.
  std::vector<std::string> corrected = {};
};

/// Reads FOLDER/calibration.json with its maps and, where present, its colours (appliance/calibration). Without
/// colours, the maps alone determine how projectors are blended; a projector that the calibration lacks is blended as
/// planned. FOLDER/correction.json moves projectors from their measured poses to their present ones, if it belongs to
/// this calibration (appliance/healing). A head that packs two eyes' pictures side by side or one above the other uses
/// only the maps, since colours cover whole heads. Takes seconds. Reentrant.
/// Errors: kNotFound if there is no calibration; those of read_calibration() and read_colours(); kInvalidArgument if
/// the calibration contains none of these projectors, or gives one of them another size.
Result<CalibratedHeads> calibrated_heads(const std::filesystem::path& folder, const Installation& installation,
                                         const PictureShape& picture, std::vector<HeadPlan> planned);

}  // namespace cyclorama::display
