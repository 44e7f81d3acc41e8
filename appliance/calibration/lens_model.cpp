// SPDX-License-Identifier: Apache-2.0
#include "appliance/calibration/lens_model.h"

#include "common/base/check.h"

namespace cyclorama::calibration {

std::string_view name_of(LensModel model) {
  switch (model) {
    case LensModel::kPinhole:
      return "pinhole";
    case LensModel::kRadial1:
      return "k1";
    case LensModel::kRadial2:
      return "k1 k2";
    case LensModel::kDecentred:
      return "k1 k2 p1 p2";
    case LensModel::kFull:
      return "k1 k2 p1 p2 k3";
    case LensModel::kFullOblong:
      return "k1 k2 p1 p2 k3, two focal lengths";
  }
  CHECK(false);
}

std::optional<LensModel> lens_model(std::string_view name) {
  for (const LensModel model : kLensModels) {
    if (name_of(model) == name) return model;
  }
  return std::nullopt;
}

int freedom_of(LensModel model) {
  return kBrownValues - static_cast<int>(fixed_values(model).size()) - (has_square_pixels(model) ? 1 : 0);
}

bool has_square_pixels(LensModel model) { return model != LensModel::kFullOblong; }

std::vector<int> fixed_values(LensModel model) {
  switch (model) {
    case LensModel::kPinhole:
      return {kK1, kK2, kP1, kP2, kK3};
    case LensModel::kRadial1:
      return {kK2, kP1, kP2, kK3};
    case LensModel::kRadial2:
      return {kP1, kP2, kK3};
    case LensModel::kDecentred:
      return {kK3};
    case LensModel::kFull:
    case LensModel::kFullOblong:
      return {};
  }
  CHECK(false);
}

}  // namespace cyclorama::calibration
