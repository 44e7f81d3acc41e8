// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/walk/walk_score.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "renderfarm/quality/shown_error.h"

namespace cyclorama {
namespace {

constexpr int kJudgedEvery = 8;

double mean_square(const RgbImage& a, const RgbImage& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.data().size(); ++i) {
    const double difference = static_cast<double>(a.data()[i]) - b.data()[i];
    sum += difference * difference;
  }
  return sum / static_cast<double>(a.data().size());
}

double psnr_of(double mean_square) { return 10.0 * std::log10(255.0 * 255.0 / std::max(mean_square, 1e-6)); }

}  // namespace

double WalkScore::Change::share() const { return truth > 0.0 ? std::sqrt(error / truth) : 0.0; }

void WalkScore::add_change(const RgbImage& shown, const RgbImage& truth, Change* change) const {
  change->values += static_cast<double>(shown.data().size());
  for (std::size_t i = 0; i < shown.data().size(); ++i) {
    const int change_of_truth = truth.data()[i] - truth_before_.data()[i];
    const int error = shown.data()[i] - shown_before_.data()[i] - change_of_truth;
    change->truth += change_of_truth * change_of_truth;
    change->error += error * error;
  }
}

Result<bool> WalkScore::add(RgbImage shown, const RgbImage& truth, bool is_first_of_frame) {
  const double square = mean_square(shown, truth);
  squares_ += square;
  ++refreshes_;
  if (!shown_before_.empty()) add_change(shown, truth, is_first_of_frame ? &at_switch_ : &between_);
  if (refreshes_ % kJudgedEvery == 0) {
    TRY_ASSIGN(const quality::ShownError error, quality::shown_error(shown, truth));
    ssim_ += error.ssim;
    flip_ += error.flip;
    ++judged_;
  }
  const bool is_worst = psnr_of(square) < worst_psnr_db_;
  worst_psnr_db_ = std::min(worst_psnr_db_, psnr_of(square));
  shown_before_ = std::move(shown);
  truth_before_ = truth;
  return is_worst;
}

void WalkScore::add_switch(const RgbImage& by_old, const RgbImage& by_new) {
  flicker_squares_ += mean_square(by_old, by_new);
}

void WalkScore::write_to(WalkFigures* figures) const {
  figures->psnr_db = psnr_of(squares_ / refreshes_);
  figures->ssim = ssim_ / std::max(1, judged_);
  figures->flip = flip_ / std::max(1, judged_);
  figures->worst_psnr_db = worst_psnr_db_;
  figures->switch_share = at_switch_.share();
  figures->step_share = between_.share();
  figures->motion = std::sqrt((at_switch_.truth + between_.truth) / std::max(1.0, at_switch_.values + between_.values));
  figures->flicker = std::sqrt(flicker_squares_ / refreshes_);
}

}  // namespace cyclorama
