// SPDX-License-Identifier: Apache-2.0
/// camera.json: what is known of one camera's lens. Written by cyclorama-calibrate-camera, read by whoever looks
/// through that camera: the tracker, the calibration of the wall.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "appliance/calibration/lens_model.h"
#include "appliance/calibration/measured_lens.h"
#include "common/base/result.h"

namespace cyclorama::calibration {

struct CameraFile {
  std::string camera;  ///< Camera::id(), or the pictures' folder.
  std::string date;
  MeasuredLens lens;
  LensModel model = LensModel::kPinhole;
  int views = 0;
  double rms_px = 0.0;
  double heldout_rms_px = 0.0;
};

[[nodiscard]] std::string camera_json(const CameraFile& camera);
/// kBadData  names the place of what is wrong: a key that is not known, a number out of range, a lens that folds over
///           within its picture.
Result<CameraFile> parse_camera(std::string_view text, const std::string& name);
/// Others as read_file().
Result<CameraFile> read_camera(const std::filesystem::path& path);

/// For pictures of another size of the same camera, when they show the same field in other pixels.
/// kInvalidArgument  the picture has another shape: says what the lens was calibrated for.
Result<MeasuredLens> lens_for_picture(const MeasuredLens& lens, int width_px, int height_px);

}  // namespace cyclorama::calibration
