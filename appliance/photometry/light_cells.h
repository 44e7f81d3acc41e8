// SPDX-License-Identifier: Apache-2.0
/// Reduces photographs of evenly lit projectors to one mean per cell of the projector's picture as they are taken,
/// because a photograph has millions of pixels and the light of a projector varies slowly.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "appliance/structured_light/decoded.h"
#include "appliance/structured_light/pattern_set.h"
#include "common/base/result.h"
#include "common/image/image.h"

namespace cyclorama::photometry {

/// For a camera at rest, the cell of one projector's picture that each camera pixel sees. A value; reentrant.
struct CameraCells {
  struct Cell {
    int pixels = 0;                                          ///< Number of camera pixels; 0: the cell is not seen.
    Eigen::Vector2d projector_px = Eigen::Vector2d::Zero();  ///< Mean of the projector pixels that they see.
    Eigen::Vector2d camera_px = Eigen::Vector2d::Zero();     ///< Mean of their positions.
  };
  int width_px = 0;  ///< Width of the projector's picture.
  int height_px = 0;
  int cells_x = 0;
  int cells_y = 0;
  Image<std::int32_t, 1> cell_of;  ///< Per camera pixel; -1: none.
  std::vector<Cell> cells;         ///< Row by row from the top.
};

/// Assigns camera pixels to cells. Pixels near the edge of the decoded area or of the projector's picture see a blurred
/// border and are left out. Errors: kInvalidArgument for pictures without size or cells of less than 4 pixels.
/// Reentrant.
Result<CameraCells> camera_cells(const structured_light::Decoded& decoded, int projector_width_px,
                                 int projector_height_px, int cell_px = 32);

/// A cell's mean in one photograph.
struct CellCode {
  std::array<float, 3> code{};       ///< Camera code, 0 to 1.
  std::array<float, 3> spread{};     ///< Standard deviation among the cell's pixels.
  std::array<bool, 3> is_clipped{};  ///< Too many pixels have codes of 0.98 or more; the mean is meaningless.
};

/// One photograph of one projector that shines evenly while the others are dark.
struct LightReading {
  structured_light::PatternLight light = structured_light::PatternLight::kAll;
  double level = 0.0;  ///< Code value as shown, 0 to 1: as_shown() of PatternPicture::level. 0 is black.
  double exposure_s = 0.0;
  std::vector<CellCode> codes;  ///< In the order of CameraCells::cells.
};

/// Rounds a level to 8 bits, in which patterns are drawn.
[[nodiscard]] double as_shown(double level);

/// Averages a photograph over the cells. Codes that are not finite count as clipped. Errors: kInvalidArgument if the
/// photograph's size differs from the camera's, the picture is not even (only white, black and levels are), or the
/// exposure is not above 0. Reentrant.
Result<LightReading> read_light(const CameraCells& cells, const Image<float, 3>& photograph,
                                const structured_light::PatternPicture& picture, double exposure_s);

}  // namespace cyclorama::photometry
