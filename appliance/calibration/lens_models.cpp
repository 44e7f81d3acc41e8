// SPDX-License-Identifier: Apache-2.0
#include "appliance/calibration/lens_models.h"

#include "common/base/check.h"

namespace cyclorama {

std::string_view name_of(LensRung rung) {
  switch (rung) {
    case LensRung::kPinhole:
      return "pinhole";
    case LensRung::kRadial1:
      return "k1";
    case LensRung::kRadial2:
      return "k1 k2";
    case LensRung::kDecentred:
      return "k1 k2 p1 p2";
    case LensRung::kFull:
      return "k1 k2 p1 p2 k3";
    case LensRung::kFullOblong:
      return "k1 k2 p1 p2 k3, two focal lengths";
  }
  CHECK(false);
}

std::optional<LensRung> lens_rung(std::string_view name) {
  for (const LensRung rung : kLensRungs) {
    if (name_of(rung) == name) return rung;
  }
  return std::nullopt;
}

int freedom_of(LensRung rung) {
  return kBrownValues - static_cast<int>(fixed_values(rung).size()) - (has_square_pixels(rung) ? 1 : 0);
}

bool has_square_pixels(LensRung rung) { return rung != LensRung::kFullOblong; }

std::vector<int> fixed_values(LensRung rung) {
  switch (rung) {
    case LensRung::kPinhole:
      return {kK1, kK2, kP1, kP2, kK3};
    case LensRung::kRadial1:
      return {kK2, kP1, kP2, kK3};
    case LensRung::kRadial2:
      return {kP1, kP2, kK3};
    case LensRung::kDecentred:
      return {kK3};
    case LensRung::kFull:
    case LensRung::kFullOblong:
      return {};
  }
  CHECK(false);
}

}  // namespace cyclorama
