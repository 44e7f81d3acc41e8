// SPDX-License-Identifier: Apache-2.0
#include "appliance/calibrator/solve/surface_fit.h"

namespace cyclorama {
namespace {
constexpr std::string_view kLensNames[] = {"pinhole", "k1", "k1 k2", "k1 k2 p1 p2"};
}  // namespace

std::string_view name_of(LensRung rung) { return kLensNames[static_cast<std::size_t>(rung)]; }

std::optional<LensRung> lens_rung(std::string_view name) {
  for (const LensRung rung : kLensRungs) {
    if (name_of(rung) == name) return rung;
  }
  return std::nullopt;
}

}  // namespace cyclorama
