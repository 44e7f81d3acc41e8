// SPDX-License-Identifier: Apache-2.0
#include "appliance/scan/known_lens.h"

#include <fmt/format.h>

#include "appliance/calibration/camera_file.h"

namespace cyclorama::scan {

Result<std::optional<calibration::MeasuredLens>> known_lens(const std::filesystem::path& file,
                                                            const std::filesystem::path& folder,
                                                            const std::string& camera_id, int width_px, int height_px) {
  const bool is_named = !file.empty();
  const std::filesystem::path path = is_named ? file : folder / "camera.json";
  auto read = calibration::read_camera(path);
  if (!read) {
    if (!is_named && read.error().code() == ErrorCode::kNotFound) return std::optional<calibration::MeasuredLens>();
    return std::move(read).error().while_doing(fmt::format("reading the camera's lens from '{}'", path.string()));
  }
  // A file that was not named explicitly may belong to another camera.
  if (!is_named && read->camera != camera_id) return std::optional<calibration::MeasuredLens>();
  auto lens = calibration::lens_for_picture(read->lens, width_px, height_px);
  if (!lens) return std::move(lens).error().while_doing(fmt::format("using the lens of '{}'", path.string()));
  return std::optional<calibration::MeasuredLens>(*std::move(lens));
}

}  // namespace cyclorama::scan
