// SPDX-License-Identifier: Apache-2.0
/// camera.json: the calibrated lens of one camera. Written by cyclorama-calibrate-camera; read by the tracker and by
/// the calibration of the wall.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "appliance/calibration/lens_model.h"
#include "appliance/calibration/measured_lens.h"
#include "common/base/result.h"

namespace cyclorama::calibration {

struct CameraFile {
  std::string camera;  ///< Id of the camera (Camera::id()), or the folder of the pictures.
  std::string date;
  MeasuredLens lens;
  LensModel model = LensModel::kPinhole;
  int views = 0;
  double rms_px = 0.0;
  double heldout_rms_px = 0.0;
};

[[nodiscard]] std::string camera_json(const CameraFile& camera);
/// Errors: kBadData, with the position of the error, for an unknown key, a number out of range, or a lens whose
/// distortion folds within its picture.
Result<CameraFile> parse_camera(std::string_view text, const std::string& name);
/// Reads a camera.json. Errors: those of read_file() and parse_camera().
Result<CameraFile> read_camera(const std::filesystem::path& path);

/// Adapts a lens to pictures of another size from the same camera that show the same field of view. Errors:
/// kInvalidArgument, with the calibrated size, if the picture has another aspect ratio.
Result<MeasuredLens> lens_for_picture(const MeasuredLens& lens, int width_px, int height_px);

}  // namespace cyclorama::calibration
