// SPDX-License-Identifier: Apache-2.0
/// What photographs of evenly lit projectors tell, boiled down as they are taken: a photograph has millions of pixels
/// and the light of a projector varies slowly, so a mean for each cell of the projector's picture is all that is kept.
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

/// Which pixels of a standing camera see which cell of one projector's picture. A value; reentrant.
struct CameraCells {
  struct Cell {
    int pixels = 0;                                          ///< Of the camera; 0: not seen.
    Eigen::Vector2d projector_px = Eigen::Vector2d::Zero();  ///< Mean of what they see.
    Eigen::Vector2d camera_px = Eigen::Vector2d::Zero();     ///< Mean of where they are.
  };
  int width_px = 0;  ///< Of the projector.
  int height_px = 0;
  int cells_x = 0;
  int cells_y = 0;
  Image<std::int32_t, 1> cell_of;  ///< Per camera pixel; -1: none.
  std::vector<Cell> cells;         ///< Row by row from the top.
};

/// Pixels near the edge of what was decoded, or of the projector's picture, see a blurred border: they are left out.
/// kInvalidArgument  pictures of no size, or cells of less than 4 pixels. Reentrant.
Result<CameraCells> camera_cells(const structured_light::Decoded& decoded, int projector_width_px,
                                 int projector_height_px, int cell_px = 32);

/// A cell's mean in one photograph.
struct CellCode {
  std::array<float, 3> code{};       ///< Camera code, 0 to 1.
  std::array<float, 3> spread{};     ///< Standard deviation among the cell's pixels.
  std::array<bool, 3> is_clipped{};  ///< Some pixels have no code above 0.98: the mean tells nothing.
};

/// One photograph of one projector that shines evenly, the others dark.
struct LightReading {
  structured_light::PatternLight light = structured_light::PatternLight::kAll;
  double level = 0.0;  ///< Code value as shown, 0 to 1: as_shown() of PatternPicture::level. 0 is black.
  double exposure_s = 0.0;
  std::vector<CellCode> codes;  ///< As CameraCells::cells.
};

/// Patterns are drawn in 8 bits.
[[nodiscard]] double as_shown(double level);

/// kInvalidArgument  a photograph of another size than the camera's, a picture that is not even (only white, black and
/// levels are), or an exposure that is not above 0. Codes that are not finite count as clipped. Reentrant.
Result<LightReading> read_light(const CameraCells& cells, const Image<float, 3>& photograph,
                                const structured_light::PatternPicture& picture, double exposure_s);

}  // namespace cyclorama::photometry
