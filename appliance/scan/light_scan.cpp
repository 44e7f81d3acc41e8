// SPDX-License-Identifier: Apache-2.0
#include "appliance/scan/light_scan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "appliance/photometry/photometry.h"
#include "appliance/structured_light/pattern_drawing.h"

namespace cyclorama::scan {
namespace {

// Factor on the exposure for black pictures, whose light is some thousandths of white's.
constexpr double kBlackExposure = 32.0;
// Largest code that counts as unclipped.
constexpr float kBrightest = 0.9f;
constexpr int kMaxTries = 12;

class LightScanning {
 public:
  LightScanning(const Installation& installation, std::span<const ScanView> views,
                const structured_light::ExposureLimits& limits, const ScanDevices& devices,
                const ScanListener& listener, std::stop_token stop)
      : installation_(installation),
        views_(views),
        limits_(limits),
        devices_(devices),
        camera_(devices.colour_camera == nullptr ? devices.camera : *devices.colour_camera),
        listener_(listener),
        stop_(std::move(stop)) {}

  Result<LightScan> run() {
    auto scan = scanned();
    // All projectors are made dark, also after an error; the first error is returned.
    for (std::size_t p = 0; p < installation_.projectors.size(); ++p) {
      const Status dark = devices_.screen.show(p, RgbImage());
      if (scan && !dark) return dark.error();
    }
    return scan;
  }

 private:
  Result<LightScan> scanned() {
    scan_.input.camera_width_px = camera_.width_px();
    scan_.input.camera_height_px = camera_.height_px();
    scan_.input.has_colour = camera_.has_colour();
    scan_.input.code_step = camera_.code_step();
    std::map<std::size_t, std::vector<const ScanView*>> by_direction;
    for (const ScanView& view : views_) {
      if (view.correspondences.empty()) continue;
      by_direction[view.direction].push_back(&view);
      const ScanView*& best = best_[view.projector];
      if (best == nullptr || view.correspondences.size() > best->correspondences.size()) best = &view;
    }
    // All projectors share one exposure, since their light is compared with each other's.
    double exposure_s = limits_.longest.count();
    for (const auto& [projector, view] : best_) exposure_s = std::min(exposure_s, view->exposure_s);
    for (const auto& [projector, view] : best_) {
      TRY(turn_to(*view));
      TRY_ASSIGN(exposure_s, unclipped(*view, exposure_s));
    }
    for (const double factor : photometry::kRampExposures) exposures_s_.push_back(within(factor * exposure_s));
    for (const auto& [direction, views] : by_direction) {
      TRY(turn_to(*views.front()));
      for (const ScanView* view : views) TRY(read(*view));
    }
    return std::move(scan_);
  }

  Status turn_to(const ScanView& view) {
    if (stop_.stop_requested()) return cancelled();
    return turn_with_retry(devices_.turntable, view.angle_rad);
  }

  /// Limits an exposure, and rounds it down to whole refreshes if it is at least one, since a projector may show its
  /// colours in sequence.
  [[nodiscard]] double within(double exposure_s) const {
    const double period_s = limits_.projector_period.count();
    if (period_s > 0.0 && exposure_s >= period_s) exposure_s = std::floor(exposure_s / period_s + 1e-6) * period_s;
    return std::clamp(exposure_s, limits_.shortest.count(), limits_.longest.count());
  }

  /// Returns an exposure of at most `exposure_s` at which white is not clipped; darker pictures are also taken at
  /// longer exposures.
  Result<double> unclipped(const ScanView& view, double exposure_s) {
    TRY_ASSIGN(const photometry::CameraCells cells, cells_of(view));
    TRY(show(view.projector, {.kind = structured_light::PatternKind::kWhite}));
    for (int round = 0; round < kMaxTries && exposure_s >= limits_.shortest.count(); ++round) {
      TRY_ASSIGN(const ScanPhotograph photograph, photographed(within(exposure_s)));
      std::vector<float> codes;
      for (std::size_t i = 0; i < cells.cell_of.data().size(); ++i) {
        if (cells.cell_of.data()[i] < 0) continue;
        const auto pixel = photograph.data().subspan(3 * i, 3);
        codes.push_back(std::max({pixel[0], pixel[1], pixel[2]}));
      }
      TRY(devices_.screen.show(view.projector, RgbImage()));
      if (codes.empty()) return exposure_s;
      const auto bright = codes.begin() + static_cast<std::ptrdiff_t>(0.995 * static_cast<double>(codes.size() - 1));
      std::nth_element(codes.begin(), bright, codes.end());
      if (*bright <= kBrightest) return exposure_s;
      exposure_s *= 0.7;
      TRY(show(view.projector, {.kind = structured_light::PatternKind::kWhite}));
    }
    return Error(ErrorCode::kBadData,
                 fmt::format("projector '{}' is too bright for the camera's shortest exposure, {:.2g} s; close the "
                             "iris, or put a grey filter before the camera",
                             name_of_projector(view.projector), limits_.shortest.count()));
  }

  Status read(const ScanView& view) {
    photometry::ProjectorView read;
    read.projector = view.projector;
    TRY_ASSIGN(read.cells, cells_of(view));
    const structured_light::PatternPicture black{.kind = structured_light::PatternKind::kBlack};
    std::vector<structured_light::PatternPicture> pictures{black, {.kind = structured_light::PatternKind::kWhite}};
    if (best_.at(view.projector) == &view) {
      TRY_ASSIGN(const structured_light::PatternSet set,
                 structured_light::ramps(read.cells.width_px, read.cells.height_px, photometry::kRampSteps,
                                         {structured_light::PatternLight::kRed, structured_light::PatternLight::kGreen,
                                          structured_light::PatternLight::kBlue}));
      for (const structured_light::PatternPicture& picture : set.pictures) {
        if (picture.level > 0.0) pictures.push_back(picture);
      }
    }
    // Photographs are taken in the order of their exposures, since many cameras must be reopened to change the
    // exposure.
    for (const double exposure_s : exposures_s_) {
      for (const structured_light::PatternPicture& picture : pictures) TRY(read_picture(picture, exposure_s, &read));
    }
    TRY(read_picture(black, within(kBlackExposure * exposures_s_.front()), &read));
    TRY(devices_.screen.show(view.projector, RgbImage()));
    scan_.input.views.push_back(std::move(read));
    ++done_;
    return Done{};
  }

  Status read_picture(const structured_light::PatternPicture& picture, double exposure_s,
                      photometry::ProjectorView* read) {
    TRY(show(read->projector, picture));
    TRY_ASSIGN(const ScanPhotograph photograph, photographed(exposure_s));
    TRY_ASSIGN(photometry::LightReading reading,
               photometry::read_light(read->cells, photograph, picture, camera_.exposed_s(exposure_s)));
    read->readings.push_back(std::move(reading));
    if (listener_) {
      listener_({fmt::format("measures the light of projector '{}': {}", name_of_projector(read->projector),
                             name_of(picture)),
                 static_cast<double>(done_) / static_cast<double>(views_.size()), &photograph});
    }
    return Done{};
  }

  Status show(std::size_t projector, const structured_light::PatternPicture& picture) {
    if (stop_.stop_requested()) return cancelled();
    const Pinhole& lens = installation_.projectors[projector].lens;
    return devices_.screen.show(projector,
                                structured_light::drawn({lens.width_px, lens.height_px, -1, 0.0, 0, {}}, picture));
  }

  Result<ScanPhotograph> photographed(double exposure_s) {
    ++scan_.pictures;
    return take_photograph(camera_, exposure_s, stop_);
  }

  [[nodiscard]] Result<photometry::CameraCells> cells_of(const ScanView& view) const {
    structured_light::Decoded decoded;
    decoded.position_px = Image<float, 2>(camera_.width_px(), camera_.height_px());
    decoded.fate = Image<structured_light::PixelFate, 1>(camera_.width_px(), camera_.height_px(),
                                                         structured_light::PixelFate::kDark);
    for (const solve::Correspondence& position : view.correspondences) {
      const int x = static_cast<int>(position.camera_u);
      const int y = static_cast<int>(position.camera_v);
      decoded.position_px.at(x, y)[0] = position.projector_x;
      decoded.position_px.at(x, y)[1] = position.projector_y;
      *decoded.fate.at(x, y) = structured_light::PixelFate::kDecoded;
    }
    const Pinhole& lens = installation_.projectors[view.projector].lens;
    return photometry::camera_cells(decoded, lens.width_px, lens.height_px);
  }

  [[nodiscard]] const std::string& name_of_projector(std::size_t projector) const {
    return installation_.projectors[projector].name;
  }

  const Installation& installation_;
  std::span<const ScanView> views_;
  const structured_light::ExposureLimits& limits_;
  const ScanDevices& devices_;
  ScanCamera& camera_;
  const ScanListener& listener_;
  std::stop_token stop_;
  LightScan scan_;
  std::map<std::size_t, const ScanView*> best_;  ///< For each projector, the view that sees most of it.
  std::vector<double> exposures_s_;
  std::size_t done_ = 0;
};

}  // namespace

Result<LightScan> scan_light(const Installation& installation, std::span<const ScanView> views,
                             const structured_light::ExposureLimits& limits, const ScanDevices& devices,
                             const ScanListener& listener, std::stop_token stop) {
  return LightScanning(installation, views, limits, devices, listener, std::move(stop)).run();
}

}  // namespace cyclorama::scan
