// SPDX-License-Identifier: Apache-2.0
/// Reduces photographs of uniform pictures to one mean per cell of the projector's picture. Photographs are reduced as
/// they are taken: each has millions of pixels, but the light of a projector varies slowly.
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

/// The cell of one projector's picture that each pixel of a camera at rest sees. A value; reentrant.
struct CameraCells {
  struct Cell {
    int pixels = 0;                                          ///< Number of camera pixels that see it; 0 if none does.
    Eigen::Vector2d projector_px = Eigen::Vector2d::Zero();  ///< Mean of the projector pixels seen in the cell.
    Eigen::Vector2d camera_px = Eigen::Vector2d::Zero();     ///< Mean of the camera pixels that see the cell.
  };
  int width_px = 0;  ///< Width of the projector's picture.
  int height_px = 0;
  int cells_x = 0;
  int cells_y = 0;
  Image<std::int32_t, 1> cell_of;  ///< Per camera pixel, index of its cell; -1 if it sees none.
  std::vector<Cell> cells;         ///< Row by row from the top.
};

/// Assigns camera pixels to cells. Pixels near the edge of the decoded area or of the projector's picture are left out,
/// since they see a blurred border. Errors: kInvalidArgument for pictures without size or cells of less than 4 pixels.
/// Reentrant.
Result<CameraCells> camera_cells(const structured_light::Decoded& decoded, int projector_width_px,
                                 int projector_height_px, int cell_px = 32);

/// Mean code of a cell in one photograph.
struct CellCode {
  std::array<float, 3> code{};       ///< Camera code, 0 to 1.
  std::array<float, 3> spread{};     ///< Standard deviation among the cell's pixels.
  std::array<bool, 3> is_clipped{};  ///< True if too many pixels have codes of 0.98 or more; the mean is then invalid.
};

/// Reading of one photograph of a uniform picture on one projector, while the others are dark.
struct LightReading {
  structured_light::PatternLight light = structured_light::PatternLight::kAll;
  double level = 0.0;  ///< Code value as shown, 0 (black) to 1: as_shown(PatternPicture::level).
  double exposure_s = 0.0;
  std::vector<CellCode> codes;  ///< In the order of CameraCells::cells.
};

/// Rounds a level to 8 bits, as patterns are drawn.
[[nodiscard]] double as_shown(double level);

/// Averages a photograph over the cells. Codes that are not finite count as clipped. Errors: kInvalidArgument if the
/// photograph's size differs from the camera's, the picture is not uniform (only white, black and levels are), or the
/// exposure is not positive. Reentrant.
Result<LightReading> read_light(const CameraCells& cells, const Image<float, 3>& photograph,
                                const structured_light::PatternPicture& picture, double exposure_s);

}  // namespace cyclorama::photometry
