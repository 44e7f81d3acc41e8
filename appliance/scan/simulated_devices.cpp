// SPDX-License-Identifier: Apache-2.0
#include "appliance/scan/simulated_devices.h"

#include "common/base/check.h"

namespace cyclorama::scan {
namespace {

/// Time to close and reopen the camera, with four warm-up pictures.
constexpr double kOpening_s = 0.5;

template <int Channels>
ScanPhotograph photograph_of(const Image<std::uint16_t, Channels>& codes, int bits) {
  ScanPhotograph photograph(codes.width(), codes.height());
  const float scale = 1.0f / static_cast<float>((1 << bits) - 1);
  for (std::size_t i = 0; i < photograph.data().size(); ++i)
    photograph.data()[i] = scale * static_cast<float>(codes.data()[Channels == 3 ? i : i / 3]);
  return photograph;
}

}  // namespace

SimulatedPatternScreen::SimulatedPatternScreen(simulated::SimulatedMuseum* museum) : museum_(museum) {
  for (std::size_t i = 0; i < museum_->projector_count(); ++i) show_dark(i);
  museum_->settle();
}

SimulatedPatternScreen::~SimulatedPatternScreen() {
  for (std::size_t i = 0; i < museum_->projector_count(); ++i) {
    const Status ignored = museum_->show(i, RgbImage());
    static_cast<void>(ignored);
  }
}

void SimulatedPatternScreen::show_dark(std::size_t projector) {
  const Pinhole& lens = museum_->installation().projectors[projector].lens;
  const Status shown = museum_->show(projector, RgbImage(lens.width_px, lens.height_px));
  CHECK(shown.has_value());  // Always succeeds, since the picture has the size that the installation gives.
}

Status SimulatedPatternScreen::show(std::size_t projector, const RgbImage& picture) {
  if (picture.empty() && projector < museum_->projector_count()) {
    show_dark(projector);
  } else {
    TRY(museum_->show(projector, picture));
  }
  museum_->settle();
  return Done{};
}

Result<ScanPhotograph> SimulatedScanCamera::photograph(double exposure_s) {
  if (exposure_s != exposure_s_) museum_->wait(kOpening_s);
  exposure_s_ = exposure_s;
  if (colour_ == PhotographColour::kColour) {
    TRY_ASSIGN(const simulated::RgbPhotograph codes, museum_->photograph_colour(exposure_s));
    return photograph_of(codes, museum_->camera_bits());
  }
  TRY_ASSIGN(const simulated::GreyPhotograph codes, museum_->photograph_grey(exposure_s));
  return photograph_of(codes, museum_->camera_bits());
}

}  // namespace cyclorama::scan
