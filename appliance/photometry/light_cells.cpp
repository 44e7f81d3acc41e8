// SPDX-License-Identifier: Apache-2.0
#include "appliance/photometry/light_cells.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace cyclorama::photometry {
namespace {

constexpr float kClipped = 0.98f;
constexpr double kMaxClipped = 0.01;  // Fraction of a cell's pixels; not 0, because of hot pixels.
constexpr int kRim = 2;               // Width of the rim, in camera pixels, in which the lens mixes light.
constexpr float kBorder_px = 4.0f;    // Width of the rim, in projector pixels, whose light blur reduces.

int count_of(int pixels, int cell_px) { return std::max(1, (pixels + cell_px / 2) / cell_px); }

bool is_decoded(const structured_light::Decoded& decoded, int x, int y) {
  if (x < 0 || y < 0 || x >= decoded.fate.width() || y >= decoded.fate.height()) return false;
  return *decoded.fate.at(x, y) == structured_light::PixelFate::kDecoded;
}

bool is_inside(const structured_light::Decoded& decoded, int x, int y) {
  return is_decoded(decoded, x, y) && is_decoded(decoded, x - kRim, y) && is_decoded(decoded, x + kRim, y) &&
         is_decoded(decoded, x, y - kRim) && is_decoded(decoded, x, y + kRim);
}

}  // namespace

Result<CameraCells> camera_cells(const structured_light::Decoded& decoded, int projector_width_px,
                                 int projector_height_px, int cell_px) {
  if (projector_width_px < 1 || projector_height_px < 1 || cell_px < 4 || decoded.fate.empty() ||
      decoded.position_px.width() != decoded.fate.width() || decoded.position_px.height() != decoded.fate.height()) {
    return Error(
        ErrorCode::kInvalidArgument,
        fmt::format("cells of {} px of a projector of {}x{} px seen in {}x{}: sizes are above 0, cells have 4 "
                    "px or more, and a decoded view has places for all its pixels",
                    cell_px, projector_width_px, projector_height_px, decoded.fate.width(), decoded.fate.height()));
  }
  CameraCells result;
  result.width_px = projector_width_px;
  result.height_px = projector_height_px;
  result.cells_x = count_of(projector_width_px, cell_px);
  result.cells_y = count_of(projector_height_px, cell_px);
  result.cell_of = Image<std::int32_t, 1>(decoded.fate.width(), decoded.fate.height(), -1);
  result.cells.resize(static_cast<std::size_t>(result.cells_x) * static_cast<std::size_t>(result.cells_y));
  const float width = static_cast<float>(projector_width_px);
  const float height = static_cast<float>(projector_height_px);
  for (int y = 0; y < decoded.fate.height(); ++y) {
    for (int x = 0; x < decoded.fate.width(); ++x) {
      if (!is_inside(decoded, x, y)) continue;
      const float* const position = decoded.position_px.at(x, y);
      const bool is_in_picture = position[0] >= kBorder_px && position[0] <= width - kBorder_px &&
                                 position[1] >= kBorder_px && position[1] <= height - kBorder_px;
      if (!is_in_picture) continue;
      const int cx =
          std::min(static_cast<int>(position[0] / width * static_cast<float>(result.cells_x)), result.cells_x - 1);
      const int cy =
          std::min(static_cast<int>(position[1] / height * static_cast<float>(result.cells_y)), result.cells_y - 1);
      const int cell = cy * result.cells_x + cx;
      *result.cell_of.at(x, y) = cell;
      CameraCells::Cell& sum = result.cells[static_cast<std::size_t>(cell)];
      ++sum.pixels;
      sum.projector_px += Eigen::Vector2d(static_cast<double>(position[0]), static_cast<double>(position[1]));
      sum.camera_px += Eigen::Vector2d(x + 0.5, y + 0.5);
    }
  }
  for (CameraCells::Cell& cell : result.cells) {
    if (cell.pixels == 0) continue;
    cell.projector_px /= cell.pixels;
    cell.camera_px /= cell.pixels;
  }
  return result;
}

double as_shown(double level) { return std::round(255.0 * std::clamp(level, 0.0, 1.0)) / 255.0; }

Result<LightReading> read_light(const CameraCells& cells, const Image<float, 3>& photograph,
                                const structured_light::PatternPicture& picture, double exposure_s) {
  if (photograph.width() != cells.cell_of.width() || photograph.height() != cells.cell_of.height()) {
    return Error(ErrorCode::kInvalidArgument,
                 fmt::format("a photograph of {}x{} px from a camera that had {}x{}", photograph.width(),
                             photograph.height(), cells.cell_of.width(), cells.cell_of.height()));
  }
  if (!(exposure_s > 0.0) || !std::isfinite(exposure_s))
    return Error(ErrorCode::kInvalidArgument, "a photograph whose exposure is not known");
  LightReading reading;
  reading.light = picture.light;
  reading.exposure_s = exposure_s;
  switch (picture.kind) {
    case structured_light::PatternKind::kBlack:
      reading.level = 0.0;
      break;
    case structured_light::PatternKind::kWhite:
      reading.level = 1.0;
      break;
    case structured_light::PatternKind::kLevel:
      reading.level = as_shown(picture.level);
      break;
    default:
      return Error(ErrorCode::kInvalidArgument,
                   fmt::format("'{}' is not even; light is read from white, black and levels",
                               structured_light::name_of(picture)));
  }
  struct Sum {
    std::array<double, 3> sum{};
    std::array<double, 3> squares{};
    std::array<int, 3> clipped{};
  };
  std::vector<Sum> sums(cells.cells.size());
  const auto positions = cells.cell_of.data();
  const auto codes = photograph.data();
  for (std::size_t i = 0; i < positions.size(); ++i) {
    if (positions[i] < 0) continue;
    Sum& sum = sums[static_cast<std::size_t>(positions[i])];
    for (std::size_t c = 0; c < 3; ++c) {
      const float code = codes[3 * i + c];
      if (!(code >= 0.0f && code < kClipped)) {
        ++sum.clipped.at(c);
        continue;
      }
      sum.sum.at(c) += static_cast<double>(code);
      sum.squares.at(c) += static_cast<double>(code) * static_cast<double>(code);
    }
  }
  reading.codes.resize(cells.cells.size());
  for (std::size_t i = 0; i < sums.size(); ++i) {
    const int pixels = cells.cells[i].pixels;
    for (std::size_t c = 0; c < 3; ++c) {
      const int good = pixels - sums[i].clipped.at(c);
      reading.codes[i].is_clipped.at(c) = pixels == 0 || sums[i].clipped.at(c) > kMaxClipped * pixels;
      if (good <= 0) continue;
      const double mean = sums[i].sum.at(c) / good;
      reading.codes[i].code.at(c) = static_cast<float>(mean);
      reading.codes[i].spread.at(c) =
          static_cast<float>(std::sqrt(std::max(0.0, sums[i].squares.at(c) / good - mean * mean)));
    }
  }
  return reading;
}

}  // namespace cyclorama::photometry
