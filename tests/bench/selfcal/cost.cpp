// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "appliance/healing/estimator/feature_matching.h"
#include "common/base/cpu_time.h"
#include "common/image/png.h"
#include "tests/bench/selfcal/selfcal_benches.h"

namespace cyclorama {

int cost(const ShowContent& content, bool is_quick) {
  constexpr double kHz = 2.0;
  const int steps = is_quick ? 10 : 40;
  double cores = 0.0;
  double cores_turning = 0.0;
  fmt::print("{:>9} {:>9} {:>10} {:>12} {:>12} {:>12} {:>10}\n", "width px", "cpu ms", "cores 2 Hz", "turning ms",
             "bump cpu ms", "error px", "patches");
  for (const int width : {272, 408, 544, 816}) {
    BumpedShowOptions options;
    options.calibrator.width_px = width;
    auto made = BumpedShow::make(options, content);
    if (!made) return 1;
    BumpedShow& show = *made;
    for (int i = 0; i < 14; ++i) {
      if (!show.step()) return 1;
    }
    double begun = show.calibrator_cpu_s();
    for (int i = 0; i < steps; ++i) {
      if (!show.step()) return 1;
    }
    const double each = (show.calibrator_cpu_s() - begun) / steps;
    // While the picture turns, several times are compared.
    show.set_turn(0.03);
    begun = show.calibrator_cpu_s();
    for (int i = 0; i < steps / 2; ++i) {
      if (!show.step()) return 1;
    }
    const double turning = (show.calibrator_cpu_s() - begun) / (steps / 2);
    show.set_turn(0.0);
    calibration::PoseStep bump = calibration::PoseStep::Zero();
    bump[1] = 0.008;
    show.bump(1, bump);
    begun = show.calibrator_cpu_s();
    std::size_t patches = 0;
    if (!show.step()) return 1;
    const double healing = show.calibrator_cpu_s() - begun;
    for (int i = 0; i < 8; ++i) {
      if (!show.step()) return 1;
    }
    for (const healing::CameraObservation& look : show.calibrator().looks()) {
      for (const healing::PatchShift& patch : look.patches) patches += patch.fit == healing::PatchFit::kFits ? 1 : 0;
    }
    fmt::print("{:>9} {:>9.1f} {:>10.3f} {:>12.1f} {:>12.1f} {:>12.3f} {:>10}\n", width, 1e3 * each, kHz * each,
               1e3 * turning, 1e3 * healing, show.error_px(1), patches);
    std::fflush(stdout);
    if (width == 816) {
      cores = kHz * each;
      cores_turning = kHz * turning;
    }
  }
  const auto pacing = measure_pacing(content, is_quick);
  if (!pacing) return 1;
  fmt::print("refreshes, p99: {:.2f} ms without, {:.2f} ms with it; late: {:.3f} % and {:.3f} %\n", pacing->p99_off_ms,
             pacing->p99_on_ms, 1e2 * pacing->late_off, 1e2 * pacing->late_on);
  fmt::print("{}\n", nlohmann::json{{"cores", cores},
                                    {"cores_turning", cores_turning},
                                    {"hz", kHz},
                                    {"pacing_ratio", pacing->p99_on_ms / pacing->p99_off_ms},
                                    {"late_percent_off", 1e2 * pacing->late_off},
                                    {"late_percent_on", 1e2 * pacing->late_on}}
                         .dump());
  return 0;
}

int features(const ShowContent& content, bool is_quick) {
  nlohmann::json all;
  fmt::print("{:<8} {:>8} {:>12} {:>10} {:>10} {:>10} {:>9}\n", "kind", "bump px", "predicted", "seen", "matches",
             "wrong %", "cpu ms");
  for (const auto& [name, kind] :
       {std::pair("sift", healing::FeatureKind::kSift), std::pair("akaze", healing::FeatureKind::kAkaze)}) {
    double matches = 0.0;
    double wrong = 0.0;
    double cpu_s = 0.0;
    int pictures = 0;
    for (std::uint32_t seed = 1; seed <= (is_quick ? 1u : 4u); ++seed) {
      BumpedShowOptions options;
      options.seed = seed;
      options.calibrator.settle = std::chrono::hours(1);
      auto made = BumpedShow::make(options, content);
      if (!made) return 1;
      BumpedShow& show = *made;
      show.set_turn(0.5);
      for (int i = 0; i < 2; ++i) {
        if (!show.step()) return 1;
      }
      calibration::PoseStep bump = calibration::PoseStep::Zero();
      bump[1] = 0.01 * seed;
      bump[2] = 0.004;
      show.bump(1, bump);
      const double moved = show.error_px(1, 0.5);
      if (!show.step()) return 1;
      for (const healing::CameraObservation& look : show.calibrator().looks()) {
        const double begun = thread_cpu_seconds();
        const auto found = healing::match_features(look.prediction, look.seen, kind);
        if (!found) return 1;
        cpu_s += thread_cpu_seconds() - begun;
        ++pictures;
        int wrong_here = 0;
        for (const healing::FeatureMatch& match : found->matches) {
          // True position of this projector's pixel.
          const calibration::ShowCalibration& room = show.calibrator().believed();
          const int factor = look.prediction.light.factor;
          const auto wall = calibration::wall_seen_at(room, room.cameras[look.camera], match.predicted * factor);
          if (!wall) continue;
          const auto who = static_cast<std::size_t>(match.projector);
          const calibration::ShowProjector& lamp = room.projectors[who];
          const auto shown = pixel_of(lamp.lens, (lamp.T_room_projector.inverse() * Point<frame::Room>{*wall}).xyz);
          const auto at = shown ? show.room().truth().wall_at(who, shown->x(), shown->y()) : std::nullopt;
          if (!at) continue;
          const simulated::FixedCamera& eye = show.room().cameras()[look.camera];
          const auto truly = eye.optics.lens.pixel_of((eye.T_room_camera.inverse() * at->point).xyz);
          if (!truly || (*truly / factor - match.seen).norm() > 2.0) ++wrong_here;
        }
        matches += static_cast<double>(found->matches.size());
        wrong += wrong_here;
        if (look.camera == 1) {
          fmt::print("{:<8} {:>8.1f} {:>12} {:>10} {:>10} {:>10.1f} {:>9.0f}\n", name, moved, found->in_prediction,
                     found->in_picture, found->matches.size(),
                     100.0 * wrong_here / std::max<double>(1.0, static_cast<double>(found->matches.size())),
                     1e3 * cpu_s / pictures);
        }
      }
    }
    all[name] = {{"matches_per_picture", matches / pictures},
                 {"wrong_percent", 100.0 * wrong / std::max(1.0, matches)},
                 {"cpu_ms", 1e3 * cpu_s / pictures}};
  }
  fmt::print("{}\n", all.dump());
  return 0;
}

int pictures(const ShowContent& content, const std::string& folder) {
  BumpedShowOptions options;
  auto made = BumpedShow::make(options, content);
  if (!made) return 1;
  BumpedShow& show = *made;
  const auto keep = [&](const std::string& name) {
    const auto seen = show.room().photograph(1, options.exposure_s);
    if (!seen) return false;
    RgbImage picture(seen->width(), seen->height());
    for (int y = 0; y < seen->height(); ++y) {
      for (int x = 0; x < seen->width(); ++x) {
        const double light = *seen->at(x, y) / 255.0;
        std::fill_n(picture.at(x, y), 3, static_cast<std::uint8_t>(255.0 * std::pow(light, 1.0 / 2.2) + 0.5));
      }
    }
    return write_png(folder + "/" + name + ".png", picture).has_value();
  };
  for (int i = 0; i < 14; ++i) {
    if (!show.step()) return 1;
  }
  if (!keep("before")) return 1;
  calibration::PoseStep bump = calibration::PoseStep::Zero();
  bump << 0.006, -0.014, 0.02, 0.0, 0.01, 0.0;
  show.bump(1, bump);
  const auto bumped = show.step();
  if (!bumped || !keep("during")) return 1;
  for (int i = 0; i < 6; ++i) {
    const auto report = show.step();
    if (!report) return 1;
    for (const std::string& line : report->log) fmt::print("{}\n", line);
  }
  return keep("after") ? 0 : 1;
}

}  // namespace cyclorama
