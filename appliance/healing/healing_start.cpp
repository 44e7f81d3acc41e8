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

namespace cyclorama {
namespace {

constexpr std::size_t kMostBytes = std::size_t{1} << 24;

ShowProjector installed(const InstalledProjector& projector) {
  ShowProjector made;
  made.name = projector.name;
  const Pinhole& lens = projector.lens;
  made.lens = {lens.width_px,    lens.height_px,  lens.focal_px, lens.pixel_aspect * lens.focal_px,
               lens.centre_u_px, lens.centre_v_px};
  made.T_room_projector = projector.T_room_projector;
  return made;
}

/// What a channel shines for each code: the curve that says which code makes a light, the other way round.
CodeLight light_of(const ResponseCurve& curve) {
  CodeLight light{};
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
  return rounded_light(light);
}

/// What the calibration measured of how codes become light.
Result<std::vector<CalibratedColour>> measured_colours(const std::filesystem::path& folder, const std::string& date) {
  auto text = read_text_file(calibration_folder(folder, date) / "colours.json", kMostBytes);
  if (!text && text.error().code() == ErrorCode::kNotFound) return std::vector<CalibratedColour>();
  if (!text) return std::move(text).error();
  return parse_colours(*text, "colours.json");
}

ShowFile::Projector found_projector(const Calibration& calibration, const Installation& installation,
                                    const InstalledProjector& projector) {
  const auto remedy = [&](const std::string& why) {
    return fmt::format("{}; calibrate it with 'cyclorama calibrate --quick {}'", why, projector.name);
  };
  const ShowProjector begun = installed(projector);
  ShowFile::Projector made{projector.name, begun.lens, begun.T_room_projector, begun.T_room_projector, {}};
  const auto found = std::ranges::find(calibration.projectors, projector.name, &CalibratedProjector::name);
  if (found == calibration.projectors.end()) {
    made.unplaced = remedy(fmt::format("the calibration of {} knows nothing of it", calibration.date));
    return made;
  }
  const auto fitted = fit_projector(found->map, installation.wall, installation.sweet_spot, begun);
  if (!fitted) {
    made.unplaced = remedy("where it stands cannot be told from its map: " + fitted.error().message());
    return made;
  }
  made.lens = fitted->lens;
  made.scanned = made.applied = fitted->pose;
  return made;
}

/// Those of the newest calibration, as watch.json has them, or found anew.
Result<std::vector<ShowFile::Projector>> projectors_of(const std::filesystem::path& folder,
                                                       const Calibration& calibration, const Installation& installation,
                                                       const ShowFile* known) {
  std::vector<ShowFile::Projector> projectors;
  if (known != nullptr && known->calibration == calibration.date &&
      known->projectors.size() == installation.projectors.size()) {
    projectors = known->projectors;
  } else {
    for (const InstalledProjector& projector : installation.projectors)
      projectors.push_back(found_projector(calibration, installation, projector));
  }
  if (std::ranges::none_of(projectors, &std::string::empty, &ShowFile::Projector::unplaced)) {
    return Error(ErrorCode::kBadData,
                 projectors.empty() ? "there is no projector"
                                    : fmt::format("projector '{}': {}", projectors[0].name, projectors[0].unplaced));
  }
  TRY_ASSIGN(const auto colours, measured_colours(folder, calibration.date));
  for (ShowFile::Projector& projector : projectors) {
    const auto found = std::ranges::find(colours, projector.name, &CalibratedColour::name);
    projector.light.reset();
    if (found == colours.end() || !found->colour.response) continue;
    projector.light.emplace();
    std::ranges::transform(*found->colour.response, projector.light->begin(), light_of);
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

Result<HealingStart> healing_start(const std::filesystem::path& folder, const Installation& installation,
                                   const std::vector<WatchingCamera>& cameras) {
  TRY_ASSIGN(const Calibration calibration, read_calibration(folder));
  auto known = read_show(folder / kWatchFile);
  if (!known && known.error().code() != ErrorCode::kNotFound) return std::move(known).error();
  HealingStart start;
  ShowFile& show = start.show;
  show.calibration = calibration.date;
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    const WatchingCamera& camera = cameras[i];
    const auto found = known ? std::ranges::find(known->cameras, camera.name, &ShowFile::Camera::name)
                             : std::vector<ShowFile::Camera>::iterator{};
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

Result<ShowFile> keep_places(const std::filesystem::path& folder, const Installation& installation,
                             const std::vector<PlacedCamera>& cameras) {
  TRY_ASSIGN(const Calibration calibration, read_calibration(folder));
  const auto known = read_show(folder / kWatchFile);
  ShowFile show;
  show.calibration = calibration.date;
  for (const PlacedCamera& camera : cameras) {
    if (camera.trouble.empty()) {
      show.cameras.push_back({camera.name, camera.lens, camera.T_room_camera});
      continue;
    }
    // Somebody stood before it: the place that it had is better than none.
    if (!known || known->calibration != calibration.date) continue;
    const auto before = std::ranges::find(known->cameras, camera.name, &ShowFile::Camera::name);
    if (before != known->cameras.end() && is_same(before->lens, camera.lens)) show.cameras.push_back(*before);
  }
  TRY_ASSIGN(show.projectors, projectors_of(folder, calibration, installation, known ? &*known : nullptr));
  // Seen from elsewhere, something else is left over.
  for (ShowFile::Projector& projector : show.projectors) {
    projector.learned.reset();
    projector.light.reset();
  }
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
