// SPDX-License-Identifier: Apache-2.0
#include "tests/data_sets/board_photo.h"

#include <Eigen/LU>
#include <cmath>

#include "common/base/check.h"
#include "common/wand/tag_bitmap.h"

namespace cyclorama {
namespace {
constexpr int kRays = 3;
constexpr double kBlack = 25.0;
constexpr double kWhite = 225.0;
constexpr double kTable = 110.0;
}  // namespace

BoardPhotographer::BoardPhotographer(const TagBoard& board, const calibration::BrownLens& lens)
    : board_(board), width_px_(lens.parameters().width_px), height_px_(lens.parameters().height_px) {
  for (int y = 0; y < kRays * height_px_; ++y) {
    for (int x = 0; x < kRays * width_px_; ++x) {
      const calibration::SlopeAnswer answer = lens.slope_at({(x + 0.5) / kRays, (y + 0.5) / kRays});
      CHECK(answer.refusal == calibration::LensRefusal::kNone);
      slopes_.push_back(answer.slope);
    }
  }
  for (int tag = board.first_tag; tag < board.first_tag + board.tags(); ++tag) {
    const TagBitmap bitmap = tag_bitmap(tag);
    white_.push_back(bitmap.white);
    cells_ = bitmap.cells;
    width_in_tags_ = bitmap.width_in_tags;
  }
}

double BoardPhotographer::grey_at(const Eigen::Vector2d& board_m) const {
  const Eigen::Vector2d square = board_m / board_.square_m + Eigen::Vector2d::Ones();
  constexpr double kBorder = 0.4;
  if (!(square.x() > -kBorder && square.y() > -kBorder && square.x() < board_.columns + kBorder &&
        square.y() < board_.rows + kBorder)) {
    return kTable;
  }
  const int x = static_cast<int>(std::floor(square.x()));
  const int y = static_cast<int>(std::floor(square.y()));
  if (x < 0 || y < 0 || x >= board_.columns || y >= board_.rows) return kWhite;
  if (TagBoard::is_black(x, y)) return kBlack;
  // Number of white squares before this one, row by row.
  const int tag = (y * board_.columns + x) / 2;
  const double side = board_.tag_m * width_in_tags_ / board_.square_m;  // Includes the tag's border.
  const double u = (square.x() - x - 0.5) / side + 0.5;
  const double v = (square.y() - y - 0.5) / side + 0.5;
  if (!(u >= 0.0 && v >= 0.0 && u < 1.0 && v < 1.0)) return kWhite;
  const int cell = static_cast<int>(v * cells_) * cells_ + static_cast<int>(u * cells_);
  return white_[static_cast<std::size_t>(tag)][static_cast<std::size_t>(cell)] ? kWhite : kBlack;
}

GreyImage BoardPhotographer::photograph(const Eigen::Matrix3d& R, const Eigen::Vector3d& t) const {
  GreyImage photo(width_px_, height_px_);
  const Eigen::Vector3d origin = -R.transpose() * t;  // Camera centre in the board's frame.
  for (int y = 0; y < height_px_; ++y) {
    for (int x = 0; x < width_px_; ++x) {
      double sum = 0.0;
      for (int j = 0; j < kRays; ++j) {
        for (int i = 0; i < kRays; ++i) {
          const std::size_t at = static_cast<std::size_t>((kRays * y + j) * kRays * width_px_ + kRays * x + i);
          const Eigen::Vector3d ray = R.transpose() * slopes_[at].homogeneous();
          const double far = -origin.z() / ray.z();
          sum += far > 0.0 ? grey_at((origin + far * ray).head<2>()) : kTable;
        }
      }
      *photo.at(x, y) = static_cast<std::uint8_t>(std::lround(sum / (kRays * kRays)));
    }
  }
  return photo;
}

}  // namespace cyclorama
