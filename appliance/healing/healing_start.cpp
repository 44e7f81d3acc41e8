// SPDX-License-Identifier: Apache-2.0
#include "appliance/healing/healing_start.h"

#include <fmt/format.h>

#include <algorithm>

#include "appliance/calibration/calibration_file.h"
#include "appliance/calibration/colour_file.h"
#include "appliance/calibration/corrected_map.h"
#include "appliance/healing/estimator/show_fit.h"
#include "appliance/healing/show_record.h"
#include "common/base/file.h"

namespace cyclorama::healing {
namespace {

constexpr std::size_t kMaxBytes = std::size_t{1} << 24;

calibration::ShowProjector installed(const InstalledProjector& projector) {
  calibration::ShowProjector made;
  made.name = projector.name;
  const Pinhole& lens = projector.lens;
  made.lens = {lens.width_px,    lens.height_px,  lens.focal_px, lens.pixel_aspect * lens.focal_px,
               lens.centre_u_px, lens.centre_v_px};
  made.T_room_projector = projector.T_room_projector;
  return made;
}

/// Inverts a response curve: returns the light of a channel for each code.
calibration::CodeLight light_of(const warp::ResponseCurve& curve) {
  calibration::CodeLight light{};
  const std::vector<float>& codes = curve.codes;
  std::size_t above = 0;
  for (std::size_t code = 0; code < light.size(); ++code) {
    const float value = static_cast<float>(code) / 255.0f;
    while (above < codes.size() && codes[above] < value) ++above;
    float root = above == 0 ? 0.0f : 1.0f;
    if (above > 0 && above < codes.size()) {
      const float part = (value - codes[above - 1]) / (codes[above] - codes[above - 1]);
      root = (static_cast<float>(above - 1) + part) / static_cast<float>(codes.size() - 1);
    }
    light[code] = root * root;
  }
  return calibration::rounded_light(light);
}

/// Returns the measured conversion from codes to light; empty if there is none.
Result<std::vector<calibration::CalibratedColour>> measured_colours(const std::filesystem::path& folder,
                                                                    const std::string& date) {
  auto text = read_text_file(calibration::calibration_folder(folder, date) / "colours.json", kMaxBytes);
  if (!text && text.error().code() == ErrorCode::kNotFound) return std::vector<calibration::CalibratedColour>();
  if (!text) return std::move(text).error();
  return calibration::parse_colours(*text, "colours.json");
}

calibration::ShowFile::Projector found_projector(const calibration::Calibration& calibration,
                                                 const Installation& installation,
                                                 const InstalledProjector& projector) {
  const auto remedy = [&](const std::string& why) {
    return fmt::format("{}; calibrate it with 'cyclorama calibrate --quick {}'", why, projector.name);
  };
  const calibration::ShowProjector begun = installed(projector);
  calibration::ShowFile::Projector made{projector.name, begun.lens, begun.T_room_projector, begun.T_room_projector, {}};
  const auto found = std::ranges::find(calibration.projectors, projector.name, &calibration::CalibratedProjector::name);
  if (found == calibration.projectors.end()) {
    made.unplaced = remedy(fmt::format("the calibration of {} knows nothing of it", calibration.date));
    return made;
  }
  const auto fitted = fit_projector(found->map, installation.wall, installation.sweet_spot, begun);
  if (!fitted) {
    made.unplaced = remedy("its pose cannot be told from its map: " + fitted.error().message());
    return made;
  }
  made.lens = fitted->lens;
  made.scanned = made.applied = fitted->pose;
  return made;
}

/// Returns the projectors of the newest calibration, from watch.json or fitted anew.
Result<std::vector<calibration::ShowFile::Projector>> projectors_of(const std::filesystem::path& folder,
                                                                    const calibration::Calibration& calibration,
                                                                    const Installation& installation,
                                                                    const calibration::ShowFile* known) {
  std::vector<calibration::ShowFile::Projector> projectors;
  // The installation's order counts: a projector is addressed by its number.
  if (known != nullptr && known->calibration == calibration.date &&
      std::ranges::equal(known->projectors, installation.projectors, {}, &calibration::ShowFile::Projector::name,
                         &InstalledProjector::name)) {
    projectors = known->projectors;
  } else {
    for (const InstalledProjector& projector : installation.projectors)
      projectors.push_back(found_projector(calibration, installation, projector));
  }
  if (std::ranges::none_of(projectors, &std::string::empty, &calibration::ShowFile::Projector::unplaced)) {
    return Error(ErrorCode::kBadData,
                 projectors.empty() ? "there is no projector"
                                    : fmt::format("projector '{}': {}", projectors[0].name, projectors[0].unplaced));
  }
  TRY_ASSIGN(const auto colours, measured_colours(folder, calibration.date));
  for (calibration::ShowFile::Projector& projector : projectors) {
    const auto found = std::ranges::find(colours, projector.name, &calibration::CalibratedColour::name);
    projector.light.reset();
    if (found == colours.end() || !found->colour.response) continue;
    projector.light.emplace();
    std::ranges::transform(*found->colour.response, projector.light->begin(), light_of);
  }
  return projectors;
}

bool is_same(const calibration::BrownParameters& a, const calibration::BrownParameters& b) {
  return a.width_px == b.width_px && a.height_px == b.height_px && calibration::to_block(a) == calibration::to_block(b);
}

/// Scales the projectors' lenses to pictures reduced by `factor` each way.
void make_smaller(calibration::ShowCalibration* room, int factor) {
  for (calibration::ShowProjector& projector : room->projectors) projector.lens = smaller_lens(projector.lens, factor);
}

}  // namespace

Result<HealingStart> healing_start(const std::filesystem::path& folder, const Installation& installation,
                                   const std::vector<WatchingCamera>& cameras) {
  TRY_ASSIGN(const calibration::Calibration calibration, calibration::read_calibration(folder));
  auto known = calibration::read_show(folder / calibration::kWatchFile);
  if (!known && known.error().code() != ErrorCode::kNotFound) return std::move(known).error();
  HealingStart start;
  calibration::ShowFile& show = start.show;
  show.calibration = calibration.date;
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    const WatchingCamera& camera = cameras[i];
    const auto found = known ? std::ranges::find(known->cameras, camera.name, &calibration::ShowFile::Camera::name)
                             : std::vector<calibration::ShowFile::Camera>::iterator{};
    if (!known || found == known->cameras.end() || !is_same(found->lens, camera.lens)) {
      start.troubles.push_back(
          fmt::format("nobody knows where camera '{}' stands; let the cameras be placed, which takes a minute of "
                      "patterns (cyclorama realign --place-cameras)",
                      camera.name));
      continue;
    }
    show.cameras.push_back(*found);
    start.cameras.push_back(i);
  }
  if (show.cameras.empty()) {
    return Error(ErrorCode::kNotFound, start.troubles.empty() ? kNoCameraWatches : start.troubles.front());
  }
  TRY_ASSIGN(show.projectors, projectors_of(folder, calibration, installation, known ? &*known : nullptr));
  return start;
}

Result<calibration::ShowFile> save_camera_poses(const std::filesystem::path& folder, const Installation& installation,
                                                const std::vector<PlacedCamera>& cameras) {
  TRY_ASSIGN(const calibration::Calibration calibration, calibration::read_calibration(folder));
  const auto known = calibration::read_show(folder / calibration::kWatchFile);
  calibration::ShowFile show;
  show.calibration = calibration.date;
  for (const PlacedCamera& camera : cameras) {
    if (camera.trouble.empty()) {
      show.cameras.push_back({camera.name, camera.lens, camera.T_room_camera});
      continue;
    }
    // The camera could not be placed; its former pose is better than none.
    if (!known || known->calibration != calibration.date) continue;
    const auto before = std::ranges::find(known->cameras, camera.name, &calibration::ShowFile::Camera::name);
    if (before != known->cameras.end() && is_same(before->lens, camera.lens)) show.cameras.push_back(*before);
  }
  TRY_ASSIGN(show.projectors, projectors_of(folder, calibration, installation, known ? &*known : nullptr));
  // What was learned holds for the former camera poses only.
  for (calibration::ShowFile::Projector& projector : show.projectors) {
    projector.learned.reset();
    projector.light.reset();
  }
  TRY(calibration::write_show(folder / calibration::kWatchFile, show));
  return show;
}

Result<calibration::Calibration> corrected_calibration(const std::filesystem::path& folder,
                                                       const Installation& installation) {
  TRY_ASSIGN(calibration::Calibration calibration, calibration::read_calibration(folder));
  const auto show = calibration::read_show(folder / calibration::kCorrectionFile);
  if (!show || show->calibration != calibration.date) return calibration;
  for (const calibration::ShowFile::Projector& projector : show->projectors) {
    const auto found =
        std::ranges::find(calibration.projectors, projector.name, &calibration::CalibratedProjector::name);
    if (found != calibration.projectors.end())
      found->map = calibration::corrected_map(found->map, projector, installation.wall, installation.sweet_spot);
  }
  return calibration;
}

calibration::ShowCalibration applied_room(const calibration::ShowFile& show, const Installation& installation,
                                          int factor) {
  calibration::ShowCalibration room = show_of(show, installation);
  make_smaller(&room, factor);
  return room;
}

std::optional<LearnedRoom> learned_room(const calibration::ShowFile& show, const Installation& installation,
                                        int factor) {
  std::optional<LearnedRoom> room = learned_of(show, installation);
  if (room) make_smaller(&room->believed, factor);
  return room;
}

}  // namespace cyclorama::healing
