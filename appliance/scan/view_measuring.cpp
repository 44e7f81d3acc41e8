// SPDX-License-Identifier: Apache-2.0
#include "appliance/scan/view_measuring.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "appliance/structured_light/pattern_drawing.h"

namespace cyclorama::scan {
namespace {

// Minimum fraction of the camera's pixels that a visible projector lights; a smaller fraction is indirect light or
// noise.
constexpr double kMinLitShare = 0.002;
constexpr int kMaxExposures = 12;
// Maximum relative difference between a pattern plus its inverse and white plus black. They would be equal without the
// cameras' response curves, which cause a difference of at most a sixth.
constexpr float kUneven = 0.3f;
constexpr float kUnevenCodes = 0.03f;
constexpr float kLitGain = 0.05f;

class ViewMeasuring {
 public:
  ViewMeasuring(const ViewOrder& order, const ViewSettings& settings, PatternScreen& screen, ScanCamera& camera,
                const PhotographListener& listener, std::stop_token stop)
      : order_(order),
        settings_(settings),
        screen_(screen),
        camera_(camera),
        listener_(listener),
        stop_(std::move(stop)) {}

  Result<ScanView> run() {
    structured_light::PatternChoice choice;
    choice.width_px = order_.width_px;
    choice.height_px = order_.height_px;
    choice.finest_bit = settings_.finest_bit;
    choice.base_bit = settings_.base_bit;
    choice.phase_period_px = settings_.phase_period_px;
    choice.phase_steps = settings_.phase_steps;
    TRY_ASSIGN(set_, structured_light::structured_light(choice));
    auto view = measured();
    // The projector is made dark, also after an error; the first error is returned.
    const Status dark = screen_.show(order_.projector, RgbImage());
    if (view && !dark) return dark.error();
    return view;
  }

 private:
  Result<ScanView> measured() {
    ScanView view;
    view.projector = order_.projector;
    TRY_ASSIGN(const bool is_lit, find_exposure());
    if (!is_lit) {
      view.pictures = pictures_;
      return view;
    }
    TRY_ASSIGN(structured_light::Decoder decoder,
               structured_light::Decoder::from(set_, settings_.decode, camera_.width_px(), camera_.height_px()));
    // White and black come first in every set, and were already photographed for the exposure.
    structured_light::Photo pattern;
    TRY(decoder.add(white_));
    TRY(decoder.add(black_));
    for (std::size_t i = 2; i < set_.pictures.size(); ++i) {
      const double fraction = static_cast<double>(i) / static_cast<double>(set_.pictures.size());
      TRY_ASSIGN(structured_light::Photo photo, photographed(set_.pictures[i], settings_.photographs, fraction));
      TRY(decoder.add(photo));
      if (set_.pictures[i].kind != structured_light::PatternKind::kBit) continue;
      if (set_.pictures[i].is_inverse) view.disturbed = std::max(view.disturbed, uneven_share(pattern, photo));
      pattern = std::move(photo);
    }
    view.pictures = pictures_;
    view.exposure_s = exposure_s_;
    const auto decoded = decoder.finish();
    if (!decoded) {  // The camera sees no direct light of the projector, only light from the wall.
      if (decoded.error().code() != ErrorCode::kBadData) return decoded.error();
      view.exposure_s = 0.0;
      return view;
    }
    take_correspondences(*decoded, &view);
    return view;
  }

  /// Returns the fraction of the lit pixels at which a pattern and its inverse do not add up, because somebody was in
  /// the way in some of the photographs. If all pixels are affected, the decoder cannot distinguish this from noise.
  [[nodiscard]] double uneven_share(const structured_light::Photo& pattern,
                                    const structured_light::Photo& inverse) const {
    std::size_t lit = 0;
    std::size_t uneven = 0;
    for (std::size_t i = 0; i < white_.data().size(); i += 3) {
      const float gain = std::max(white_.data()[i] - black_.data()[i], std::abs(pattern.data()[i] - inverse.data()[i]));
      if (gain < kLitGain) continue;
      ++lit;
      const float off = pattern.data()[i] + inverse.data()[i] - white_.data()[i] - black_.data()[i];
      uneven += static_cast<std::size_t>(std::abs(off) > kUneven * gain + kUnevenCodes);
    }
    return lit == 0 ? 0.0 : static_cast<double>(uneven) / static_cast<double>(lit);
  }

  Result<structured_light::Photo> photographed(const structured_light::PatternPicture& picture, int times,
                                               double fraction) {
    if (stop_.stop_requested()) return cancelled();
    TRY(screen_.show(order_.projector, structured_light::drawn(set_, picture)));
    structured_light::Photo mean(camera_.width_px(), camera_.height_px());
    for (int i = 0; i < times; ++i) {
      TRY_ASSIGN(const ScanPhotograph photograph, take_photograph(camera_, exposure_s_, stop_));
      ++pictures_;
      if (listener_) listener_(name_of(picture), fraction, photograph);
      const structured_light::Photo photo = photo_of(photograph);
      if (times == 1) return photo;
      for (std::size_t k = 0; k < mean.data().size(); ++k)
        mean.data()[k] += photo.data()[k] / static_cast<float>(times);
    }
    return mean;
  }

  /// Finds the exposure; returns false if the projector lights nothing that the camera sees.
  Result<bool> find_exposure() {
    std::vector<structured_light::ExposureSample> samples;
    structured_light::ExposureTime next{order_.exposure_s.value_or(0.0)};
    if (!order_.exposure_s) {
      TRY_ASSIGN(const structured_light::ExposureAdvice first,
                 structured_light::next_exposure(samples, settings_.exposure));
      next = first.exposure;
    }
    for (int round = 0; round < kMaxExposures; ++round) {
      exposure_s_ = next.count();
      TRY_ASSIGN(white_, photographed(set_.pictures[0], settings_.photographs, 0.0));
      TRY_ASSIGN(black_, photographed(set_.pictures[1], settings_.photographs, 0.0));
      samples.push_back(structured_light::exposure_sample(next, white_, black_));
      const auto advice = structured_light::next_exposure(samples, settings_.exposure);
      if (!advice) {
        // Nothing is lit at the longest exposure: the projector lights something else, or is dark.
        const structured_light::ExposureSample& newest = samples.back();
        if (newest.lit < kMinLitShare && newest.saturated <= 0.0) return false;
        return Error(advice.error()).while_doing(fmt::format("photographing projector '{}'", order_.name));
      }
      if (advice->is_good) return samples.back().lit >= kMinLitShare;
      next = advice->exposure;
    }
    return Error(ErrorCode::kBadData,
                 fmt::format("no exposure was found for projector '{}': its light, or the room's, changes all the "
                             "time; switch off what flickers",
                             order_.name));
  }

  void take_correspondences(const structured_light::Decoded& decoded, ScanView* view) const {
    for (int y = 0; y < decoded.fate.height(); ++y) {
      for (int x = 0; x < decoded.fate.width(); ++x) {
        if (*decoded.fate.at(x, y) != structured_light::PixelFate::kDecoded) continue;
        const float* position = decoded.position_px.at(x, y);
        const float* sigma = decoded.sigma_px.at(x, y);
        solve::Correspondence pixel;
        pixel.camera_u = static_cast<float>(x) + 0.5f;
        pixel.camera_v = static_cast<float>(y) + 0.5f;
        pixel.projector_x = std::clamp(position[0], 0.0f, static_cast<float>(order_.width_px));
        pixel.projector_y = std::clamp(position[1], 0.0f, static_cast<float>(order_.height_px));
        // One sigma for both axes, since the solver weights correspondences, not axes; at least a hundredth of a pixel.
        pixel.sigma_px = std::max({sigma[0], sigma[1], 0.01f});
        pixel.projector = static_cast<std::uint32_t>(order_.projector);
        view->correspondences.push_back(pixel);
      }
    }
  }

  const ViewOrder& order_;
  const ViewSettings& settings_;
  PatternScreen& screen_;
  ScanCamera& camera_;
  const PhotographListener& listener_;
  std::stop_token stop_;
  structured_light::PatternSet set_;
  structured_light::Photo white_;
  structured_light::Photo black_;
  double exposure_s_ = 0.0;
  int pictures_ = 0;
};

}  // namespace

std::string ViewSettings::text() const {
  return fmt::format("finest bit {}, base bit {}, phase period {}, steps {}, photographs {}", finest_bit, base_bit,
                     phase_period_px, phase_steps, photographs);
}

structured_light::Photo photo_of(const ScanPhotograph& photograph) {
  structured_light::Photo photo(photograph.width(), photograph.height());
  const auto codes = photograph.data();
  for (std::size_t i = 0; i < photo.data().size(); ++i)
    photo.data()[i] = (codes[3 * i] + codes[3 * i + 1] + codes[3 * i + 2]) * (1.0f / 3.0f);
  return photo;
}

Result<ScanPhotograph> take_photograph(ScanCamera& camera, double exposure_s, const std::stop_token& stop) {
  if (stop.stop_requested()) return cancelled();
  TRY_ASSIGN(ScanPhotograph photograph, camera.photograph(exposure_s));
  if (photograph.width() != camera.width_px() || photograph.height() != camera.height_px()) {
    return Error(ErrorCode::kBadData,
                 fmt::format("camera '{}' gave a photograph of {}x{} instead of {}x{}; plug it in again", camera.id(),
                             photograph.width(), photograph.height(), camera.width_px(), camera.height_px()));
  }
  return photograph;
}

Result<ScanView> measure_view(const ViewOrder& order, const ViewSettings& settings, PatternScreen& screen,
                              ScanCamera& camera, const PhotographListener& listener, std::stop_token stop) {
  return ViewMeasuring(order, settings, screen, camera, listener, std::move(stop)).run();
}

Error cancelled() {
  return {ErrorCode::kUnavailable, "the calibration was cancelled; resume it to go on where it was"};
}

}  // namespace cyclorama::scan
