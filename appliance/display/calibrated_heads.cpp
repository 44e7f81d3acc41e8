// SPDX-License-Identifier: Apache-2.0
#include "appliance/display/calibrated_heads.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "appliance/calibration/calibration_file.h"
#include "appliance/calibration/corrected_map.h"
#include "appliance/calibration/measured_blend.h"
#include "appliance/display/measured_head.h"
#include "common/base/text.h"

namespace cyclorama::display {
namespace {

Pinhole lens_of(const Installation& installation, std::size_t projector) {
  const Pinhole& lens = installation.projectors[projector].lens;
  return installation.stereo ? lens_of_eye(lens, installation.stereo->packing) : lens;
}

Error of_others(const std::string& name, int width_px, int height_px, const Pinhole& lens, const char* what) {
  return Error(ErrorCode::kInvalidArgument,
               fmt::format("projector '{}': its {} is of {}x{} pixels, but it has {}x{}; calibrate again",
                           printable(name), what, width_px, height_px, lens.width_px, lens.height_px));
}

/// Returns the map of each projector of the installation; null where the calibration lacks it. Each map is resized to
/// the pixels of one eye, which are stretched over the whole head; its evenly spread control points do not change.
Result<std::vector<const calibration::MeasuredMap*>> maps_of(calibration::Calibration* calibration,
                                                             const Installation& installation) {
  std::vector<const calibration::MeasuredMap*> maps;
  for (std::size_t i = 0; i < installation.projectors.size(); ++i) {
    const InstalledProjector& installed = installation.projectors[i];
    const auto found =
        std::ranges::find(calibration->projectors, installed.name, &calibration::CalibratedProjector::name);
    maps.push_back(found == calibration->projectors.end() ? nullptr : &found->map);
    if (maps.back() == nullptr) continue;
    calibration::MeasuredMap& map = found->map;
    if (map.width_px != installed.lens.width_px || map.height_px != installed.lens.height_px)
      return of_others(installed.name, map.width_px, map.height_px, installed.lens, "map");
    const Pinhole lens = lens_of(installation, i);
    map.width_px = lens.width_px;
    map.height_px = lens.height_px;
  }
  return maps;
}

Status add_colours(std::vector<calibration::CalibratedColour> colours, const Installation& installation,
                   std::size_t projector, HeadPlan* head) {
  const InstalledProjector& installed = installation.projectors[projector];
  const auto found = std::ranges::find(colours, installed.name, &calibration::CalibratedColour::name);
  if (found == colours.end()) return Done{};
  if (found->mask.width() != installed.lens.width_px || found->mask.height() != installed.lens.height_px)
    return of_others(installed.name, found->mask.width(), found->mask.height(), installed.lens, "mask");
  const auto& black_lift = found->colour.black_lift;
  if (black_lift &&
      (black_lift->width() != installed.lens.width_px || black_lift->height() != installed.lens.height_px))
    return of_others(installed.name, black_lift->width(), black_lift->height(), installed.lens, "black lift");
  if (found->mask.width() != head->mask.width() || found->mask.height() != head->mask.height()) {
    found->colour.black_lift.reset();  // A head that packs two eyes' pictures cannot use images of the whole head.
  } else {
    head->mask = std::move(found->mask);
  }
  head->colour = std::move(found->colour);
  return Done{};
}

/// Displacement of a projector from which masks are adapted to it; below it, their ramps hardly change.
constexpr double kCarryMasksFrom_px = 2.0;

/// Adapts the maps to the present poses. Returns true if a projector moved so far that the masks must be adapted as
/// well. Without a correction, or if it belongs to another calibration or is unreadable, everything stays as measured.
bool correct_maps(const std::filesystem::path& folder, const Installation& installation,
                  calibration::Calibration* calibration, std::vector<std::string>* corrected) {
  const auto show = calibration::read_show(folder / calibration::kCorrectionFile);
  if (!show || show->calibration != calibration->date) return false;
  double max_px = 0.0;
  for (const calibration::ShowFile::Projector& projector : show->projectors) {
    const auto found =
        std::ranges::find(calibration->projectors, projector.name, &calibration::CalibratedProjector::name);
    if (found == calibration->projectors.end()) continue;
    const double px = calibration::moved_px(projector, installation.wall);
    if (px <= 0.0) continue;
    found->map = calibration::corrected_map(found->map, projector, installation.wall, installation.sweet_spot);
    corrected->push_back(projector.name);
    max_px = std::max(max_px, px);
  }
  return max_px > kCarryMasksFrom_px;
}

/// Adapts `mask` to the present pose: keeps the measured brightness of each pixel, and updates its share of the wall's
/// light.
void carry(const warp::MaskImage& share_before, const warp::MaskImage& share_now, warp::MaskImage* mask) {
  if (mask->width() != share_now.width() || mask->height() != share_now.height() || share_before.empty()) return;
  for (std::size_t i = 0; i < mask->data().size(); ++i) {
    const float before = share_before.data()[i];
    const float now = share_now.data()[i];
    float& weight = mask->data()[i];
    weight = before > 1e-3f ? std::clamp(weight * now / before, 0.0f, 1.0f) : now;
  }
}

}  // namespace

Result<std::vector<HeadPlan>> planned_heads(const Installation& of, const PictureShape& picture) {
  Installation installation = of;
  std::optional<StereoPacking> packing;
  if (installation.stereo) packing = installation.stereo->packing;
  for (std::size_t i = 0; i < of.projectors.size(); ++i) installation.projectors[i].lens = lens_of(of, i);
  const std::vector<warp::ProjectorMap> maps = warp::projector_maps(installation);
  std::vector<warp::MaskImage> masks = warp::make_blend_masks(maps);
  std::vector<HeadPlan> heads;
  for (std::size_t i = 0; i < maps.size(); ++i) {
    if (installation.projectors[i].warp) {
      TRY_ASSIGN(HeadPlan measured, measured_head(installation, i, picture));
      heads.push_back(std::move(measured));
      heads.back().packing = packing;
      continue;
    }
    auto warp = warp::make_warp(maps[i], picture);
    if (!warp)
      return std::move(warp).error().while_doing(fmt::format("projector '{}'", installation.projectors[i].name));
    HeadPlan& head = heads.emplace_back();
    head.warp = *std::move(warp);
    head.mask = std::move(masks[i]);
    head.picture = picture;
    head.packing = packing;
  }
  return heads;
}

Result<CalibratedHeads> calibrated_heads(const std::filesystem::path& folder, const Installation& installation,
                                         const PictureShape& picture, std::vector<HeadPlan> planned) {
  CHECK(planned.size() == installation.projectors.size());
  TRY_ASSIGN(calibration::Calibration calibration, calibration::read_calibration(folder));
  TRY_ASSIGN(const std::vector<calibration::CalibratedColour> colours,
             calibration::read_colours(calibration::calibration_folder(folder, calibration.date)));
  calibration::Calibration scanned = calibration;
  std::vector<std::string> corrected;
  const bool has_moved = correct_maps(folder, installation, &calibration, &corrected);
  TRY_ASSIGN(const std::vector<const calibration::MeasuredMap*> maps, maps_of(&calibration, installation));
  if (std::ranges::all_of(maps, [](const calibration::MeasuredMap* map) { return map == nullptr; })) {
    return Error(ErrorCode::kInvalidArgument,
                 fmt::format("the calibration of {} knows none of this installation's projectors; calibrate again",
                             calibration.date));
  }
  const std::vector<warp::MaskImage> masks = calibration::measured_blend_masks(maps, picture);
  std::vector<warp::MaskImage> masks_before;
  if (has_moved && !colours.empty()) {
    TRY_ASSIGN(const std::vector<const calibration::MeasuredMap*> maps_before, maps_of(&scanned, installation));
    masks_before = calibration::measured_blend_masks(maps_before, picture);
  }
  CalibratedHeads made{std::move(planned), calibration.date, {}, std::move(corrected)};
  for (std::size_t i = 0; i < maps.size(); ++i) {
    const std::string& name = installation.projectors[i].name;
    if (maps[i] == nullptr) {
      made.lacking.push_back(name);
      continue;
    }
    HeadPlan& head = made.heads[i];
    auto warp = calibration::warp_of(*maps[i], picture);
    if (!warp) return std::move(warp).error().while_doing(fmt::format("projector '{}'", name));
    head.warp = *std::move(warp);
    head.mask = masks[i];
    head.colour = {};
    head.picture = picture;
    TRY(add_colours(colours, installation, i, &head));
    const bool has_measured_mask =
        std::ranges::find(colours, name, &calibration::CalibratedColour::name) != colours.end();
    if (!masks_before.empty() && has_measured_mask) carry(masks_before[i], masks[i], &head.mask);
  }
  return made;
}

}  // namespace cyclorama::display
