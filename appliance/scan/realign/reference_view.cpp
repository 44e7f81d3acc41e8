// SPDX-License-Identifier: Apache-2.0
#include "appliance/scan/realign/reference_view.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "appliance/structured_light/pattern_drawing.h"
#include "appliance/structured_light/phase_reading.h"

namespace cyclorama::scan {
namespace {

constexpr int kSteps = 4;             // Per period; cancels the second harmonic, the strongest of a gamma curve.
constexpr float kExpected_px = 6.0f;  // Sigma of the prediction, which the sine's phase replaces where it can be read.
constexpr float kRead_px = 1.0f;      // Maximum sigma of a phase that counts as read.
constexpr float kSaturated = 0.98f;
constexpr float kBright = 0.5f;
constexpr float kMinLight = 0.04f;
constexpr double kMaxSaturated = 0.01;
constexpr int kMaxExposures = 6;
// Noise (sigma) of one photograph at one pixel, in units of Photo; averages over cells estimate their own sigma.
constexpr double kNoise = 0.006;

class ReferenceMeasuring {
 public:
  ReferenceMeasuring(const std::vector<ReferenceProjector>& references, const ExpectedReferences& expected,
                     PatternScreen& screen, ScanCamera& camera, const PhotographListener& listener,
                     std::stop_token stop)
      : references_(references),
        expected_(expected),
        screen_(screen),
        camera_(camera),
        listener_(listener),
        stop_(std::move(stop)) {}

  Result<ReferenceView> run(double exposure_s, const structured_light::ExposureLimits& limits) {
    exposure_s_ = exposure_s;
    auto view = measured(limits);
    // All projectors are made dark, also after an error; the first error is returned.
    for (const ReferenceProjector& reference : references_) {
      const Status dark = screen_.show(reference.projector, RgbImage());
      if (view && !dark) return dark.error();
    }
    return view;
  }

 private:
  [[nodiscard]] bool is_expected(std::size_t pixel) const { return expected_.reference.data()[pixel] >= 0; }

  Status show(const structured_light::PatternPicture& picture) {
    for (const ReferenceProjector& reference : references_) {
      if (stop_.stop_requested()) return cancelled();
      const structured_light::PatternSet set{
          reference.width_px, reference.height_px, -1, kReferencePeriod_px, kSteps, {}};
      TRY(screen_.show(reference.projector, structured_light::drawn(set, picture)));
    }
    return Done{};
  }

  Result<structured_light::Photo> photographed(const structured_light::PatternPicture& picture) {
    TRY_ASSIGN(const ScanPhotograph photograph, take_photograph(camera_, exposure_s_, stop_));
    ++view_.pictures;
    if (listener_) listener_(name_of(picture), view_.pictures / 12.0, photograph);
    return photo_of(photograph);
  }

  /// Finds an exposure at which white is not clipped.
  Status find_exposure(const structured_light::ExposureLimits& limits) {
    const structured_light::PatternPicture white{.kind = structured_light::PatternKind::kWhite};
    TRY(show(white));
    for (int round = 0; round < kMaxExposures; ++round) {
      TRY_ASSIGN(white_, photographed(white));
      std::vector<float> codes;
      std::size_t clipped = 0;
      for (std::size_t i = 0; i < white_.data().size(); ++i) {
        if (!is_expected(i)) continue;
        codes.push_back(white_.data()[i]);
        clipped += static_cast<std::size_t>(white_.data()[i] >= kSaturated);
      }
      if (codes.empty()) return Done{};
      const bool is_clipped = static_cast<double>(clipped) > kMaxSaturated * static_cast<double>(codes.size());
      const auto high = codes.begin() + static_cast<std::ptrdiff_t>(0.98 * static_cast<double>(codes.size() - 1));
      std::nth_element(codes.begin(), high, codes.end());
      double next_s = exposure_s_;
      if (is_clipped) {
        next_s *= 0.6;
      } else if (*high < kBright) {
        next_s *= std::min(4.0, 0.8 / std::max(0.05, static_cast<double>(*high)));
      }
      // An exposure of at least one refresh is rounded to whole refreshes, since a projector may show its colours in
      // sequence.
      const double period_s = limits.projector_period.count();
      if (period_s > 0.0 && next_s >= period_s) next_s = std::floor(next_s / period_s + 1e-6) * period_s;
      next_s = std::clamp(next_s, limits.shortest.count(), limits.longest.count());
      if (std::abs(next_s - exposure_s_) < 0.05 * exposure_s_) return Done{};
      exposure_s_ = next_s;
    }
    return Done{};
  }

  Result<ReferenceView> measured(const structured_light::ExposureLimits& limits) {
    TRY(find_exposure(limits));
    const structured_light::PatternPicture black{.kind = structured_light::PatternKind::kBlack, .level = 0.0};
    TRY(show(black));
    TRY_ASSIGN(const structured_light::Photo dark, photographed(black));
    std::array<structured_light::PhaseReading, 2> phases{structured_light::PhaseReading(kReferencePeriod_px, kSteps),
                                                         structured_light::PhaseReading(kReferencePeriod_px, kSteps)};
    for (const structured_light::PatternAxis axis :
         {structured_light::PatternAxis::kColumns, structured_light::PatternAxis::kRows}) {
      for (int step = 0; step < kSteps; ++step) {
        const structured_light::PatternPicture picture{
            .kind = structured_light::PatternKind::kPhase, .axis = axis, .step = step};
        TRY(show(picture));
        TRY_ASSIGN(const structured_light::Photo photo, photographed(picture));
        phases.at(axis == structured_light::PatternAxis::kColumns ? 0 : 1).add(step, photo);
      }
    }
    std::array<structured_light::AxisPositions, 2> correspondences;
    for (std::size_t a = 0; a < 2; ++a) {
      structured_light::AxisPositions& axis = correspondences.at(a);
      axis = {Image<float, 1>(dark.width(), dark.height(), 0.0f), Image<float, 1>(dark.width(), dark.height(), -1.0f)};
      for (std::size_t i = 0; i < dark.data().size(); ++i) {
        const float light = white_.data()[i] - dark.data()[i];
        if (!is_expected(i) || white_.data()[i] >= kSaturated || light < kMinLight) continue;
        axis.position_px.data()[i] = expected_.pixel_px.data()[2 * i + a];
        axis.sigma_px.data()[i] = kExpected_px;
      }
      phases.at(a).refine(kNoise, &axis);
    }
    take_correspondences(correspondences);
    return std::move(view_);
  }

  void take_correspondences(const std::array<structured_light::AxisPositions, 2>& correspondences) {
    for (int y = 0; y < white_.height(); ++y) {
      for (int x = 0; x < white_.width(); ++x) {
        const float sigma_x = *correspondences[0].sigma_px.at(x, y);
        const float sigma_y = *correspondences[1].sigma_px.at(x, y);
        if (!(sigma_x >= 0.0f && sigma_x < kRead_px && sigma_y >= 0.0f && sigma_y < kRead_px)) continue;
        const auto reference = static_cast<std::size_t>(*expected_.reference.at(x, y));
        solve::Correspondence position;
        position.camera_u = static_cast<float>(x) + 0.5f;
        position.camera_v = static_cast<float>(y) + 0.5f;
        position.projector_x = *correspondences[0].position_px.at(x, y);
        position.projector_y = *correspondences[1].position_px.at(x, y);
        const bool is_inside = position.projector_x > 0.0f && position.projector_y > 0.0f &&
                               position.projector_x < static_cast<float>(references_[reference].width_px) &&
                               position.projector_y < static_cast<float>(references_[reference].height_px);
        if (!is_inside) continue;
        position.sigma_px = std::max({sigma_x, sigma_y, 0.01f});
        position.projector = static_cast<std::uint32_t>(reference);
        view_.correspondences.push_back(position);
      }
    }
  }

  const std::vector<ReferenceProjector>& references_;
  const ExpectedReferences& expected_;
  PatternScreen& screen_;
  ScanCamera& camera_;
  const PhotographListener& listener_;
  std::stop_token stop_;
  double exposure_s_ = 0.0;
  structured_light::Photo white_;
  ReferenceView view_;
};

}  // namespace

Result<ReferenceView> measure_references(const std::vector<ReferenceProjector>& references,
                                         const ExpectedReferences& expected, double exposure_s,
                                         const structured_light::ExposureLimits& limits, PatternScreen& screen,
                                         ScanCamera& camera, const PhotographListener& listener, std::stop_token stop) {
  return ReferenceMeasuring(references, expected, screen, camera, listener, std::move(stop)).run(exposure_s, limits);
}

}  // namespace cyclorama::scan
