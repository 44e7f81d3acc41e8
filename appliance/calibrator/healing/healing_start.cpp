// SPDX-License-Identifier: Apache-2.0
#include "appliance/calibrator/healing/healing_start.h"

#include <fmt/format.h>

#include <algorithm>

#include "appliance/calibrator/continuous/corrected_map.h"
#include "appliance/calibrator/continuous/show_fit.h"
#include "appliance/calibrator/healing/show_record.h"
#include "appliance/calibrator/solve/calibration_file.h"

namespace cyclorama {
namespace {

ShowProjector installed(const InstalledProjector& projector) {
  ShowProjector made;
  made.name = projector.name;
  const Pinhole& lens = projector.lens;
  made.lens = {lens.width_px,    lens.height_px,  lens.focal_px, lens.pixel_aspect * lens.focal_px,
               lens.centre_u_px, lens.centre_v_px};
  made.T_room_projector = projector.T_room_projector;
  return made;
}

/// Those of the newest calibration, as watch.json has them, or found anew.
Result<std::vector<ShowFile::Projector>> projectors_of(const Calibration& calibration, const Installation& installation,
                                                       const ShowFile* known) {
  if (known != nullptr && known->calibration == calibration.date &&
      known->projectors.size() == installation.projectors.size())
    return known->projectors;
  std::vector<ShowFile::Projector> projectors;
  for (const InstalledProjector& projector : installation.projectors) {
    const auto found = std::ranges::find(calibration.projectors, projector.name, &CalibratedProjector::name);
    if (found == calibration.projectors.end()) {
      return Error(ErrorCode::kNotFound,
                   fmt::format("the calibration of {} knows nothing of projector '{}'; calibrate again",
                               calibration.date, projector.name));
    }
    auto fitted = fit_projector(found->map, installation.wall, installation.sweet_spot, installed(projector));
    if (!fitted)
      return std::move(fitted).error().while_doing(fmt::format("finding projector '{}' by its map", projector.name));
    projectors.push_back({projector.name, fitted->lens, fitted->pose, fitted->pose, {}});
  }
  return projectors;
}

bool is_same(const BrownParameters& a, const BrownParameters& b) {
  return a.width_px == b.width_px && a.height_px == b.height_px && to_block(a) == to_block(b);
}

/// For pictures of 1/`factor` of the heads' pixels.
void make_smaller(ShowCalibration* room, int factor) {
  for (ShowProjector& projector : room->projectors) projector.lens = smaller_lens(projector.lens, factor);
}

}  // namespace

Result<ShowFile> healing_start(const std::filesystem::path& folder, const Installation& installation,
                               const std::vector<WatchingCamera>& cameras) {
  TRY_ASSIGN(const Calibration calibration, read_calibration(folder));
  auto known = read_show(folder / kWatchFile);
  if (!known && known.error().code() != ErrorCode::kNotFound) return std::move(known).error();
  ShowFile show;
  show.calibration = calibration.date;
  for (const WatchingCamera& camera : cameras) {
    const auto found = known ? std::ranges::find(known->cameras, camera.name, &ShowFile::Camera::name)
                             : std::vector<ShowFile::Camera>::iterator{};
    if (!known || found == known->cameras.end() || !is_same(found->lens, camera.lens)) {
      return Error(ErrorCode::kNotFound,
                   fmt::format("nobody knows where camera '{}' stands; let the cameras be placed, which takes a minute "
                               "of patterns (cyclorama realign --place-cameras)",
                               camera.name));
    }
    show.cameras.push_back(*found);
  }
  TRY_ASSIGN(show.projectors, projectors_of(calibration, installation, known ? &*known : nullptr));
  return show;
}

Result<ShowFile> keep_places(const std::filesystem::path& folder, const Installation& installation,
                             const std::vector<PlacedCamera>& cameras) {
  TRY_ASSIGN(const Calibration calibration, read_calibration(folder));
  const auto known = read_show(folder / kWatchFile);
  ShowFile show;
  show.calibration = calibration.date;
  for (const PlacedCamera& camera : cameras) show.cameras.push_back({camera.name, camera.lens, camera.T_room_camera});
  TRY_ASSIGN(show.projectors, projectors_of(calibration, installation, known ? &*known : nullptr));
  // Seen from elsewhere, something else is left over.
  for (ShowFile::Projector& projector : show.projectors) projector.learned.reset();
  TRY(write_show(folder / kWatchFile, show));
  return show;
}

Result<Calibration> corrected_calibration(const std::filesystem::path& folder, const Installation& installation) {
  TRY_ASSIGN(Calibration calibration, read_calibration(folder));
  const auto show = read_show(folder / kCorrectionFile);
  if (!show || show->calibration != calibration.date) return calibration;
  for (const ShowFile::Projector& projector : show->projectors) {
    const auto found = std::ranges::find(calibration.projectors, projector.name, &CalibratedProjector::name);
    if (found != calibration.projectors.end())
      found->map = corrected_map(found->map, projector, installation.wall, installation.sweet_spot);
  }
  return calibration;
}

ShowCalibration applied_room(const ShowFile& show, const Installation& installation, int factor) {
  ShowCalibration room = show_of(show, installation);
  make_smaller(&room, factor);
  return room;
}

std::optional<LearnedRoom> learned_room(const ShowFile& show, const Installation& installation, int factor) {
  std::optional<LearnedRoom> room = learned_of(show, installation);
  if (room) make_smaller(&room->believed, factor);
  return room;
}

}  // namespace cyclorama
