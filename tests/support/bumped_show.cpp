// SPDX-License-Identifier: Apache-2.0
#include "tests/support/bumped_show.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/base/cpu_time.h"
#include "common/base/file.h"
#include "common/image/png.h"

namespace cyclorama {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr int kGrid_px = 16;
constexpr int kScoredColumns = 32;
constexpr int kScoredRows = 18;

calibration::BrownParameters parameters_of(const simulated::TrueLens& lens) {
  const Pinhole& p = lens.pinhole();
  return {p.width_px,           p.height_px,          p.focal_px,       p.pixel_aspect * p.focal_px,
          p.centre_u_px,        p.centre_v_px,        lens.radial()[0], lens.radial()[1],
          lens.tangential()[0], lens.tangential()[1], lens.radial()[2]};
}

/// Returns one camera beside each projector, with the projector's line of sight.
std::vector<simulated::FixedCamera> fixed_cameras(const simulated::Preset& preset, const BumpedShowOptions& options) {
  std::vector<simulated::FixedCamera> cameras;
  for (const simulated::TrueProjector& projector : preset.truth.projectors) {
    simulated::FixedCamera camera;
    camera.optics = preset.truth.camera;
    const int height = static_cast<int>(std::lround(std::sqrt(1e6 * options.camera_megapixels / (4.0 / 3.0))));
    Pinhole lens = Pinhole::from_field_of_view(height * 4 / 3, height, options.camera_field_deg * kDegree);
    const simulated::TrueLens& drawn = preset.truth.camera.lens;
    camera.optics.lens = simulated::TrueLens(lens, drawn.radial(), drawn.tangential());
    camera.optics.bits = 8;
    const bool is_together = options.camera_apart_m > 0.0;
    const simulated::TrueProjector& near =
        is_together ? preset.truth.projectors[preset.truth.projectors.size() / 2] : projector;
    const double across = 0.12 + options.camera_apart_m * static_cast<double>(cameras.size());
    const Eigen::Vector3d beside = near.T_room_projector.rotation() * Eigen::Vector3d(across, 0.1, 0.0);
    camera.T_room_camera = {projector.T_room_projector.rotation(), near.T_room_projector.translation() + beside};
    cameras.push_back(camera);
  }
  return cameras;
}

/// Returns the truth as a calibration, except for light: responses are those that the calibrator assumes.
calibration::ShowCalibration true_room(const simulated::Preset& preset,
                                       const std::vector<simulated::FixedCamera>& cameras) {
  calibration::ShowCalibration made;
  made.wall = preset.truth.wall;
  made.sweet_spot = preset.installation.sweet_spot;
  for (std::size_t i = 0; i < preset.truth.projectors.size(); ++i) {
    calibration::ShowProjector projector;
    projector.name = preset.installation.projectors[i].name;
    projector.lens = parameters_of(preset.truth.projectors[i].lens);
    projector.T_room_projector = preset.truth.projectors[i].T_room_projector;
    projector.light.fill(calibration::gamma_light(2.2));
    made.projectors.push_back(projector);
  }
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    made.cameras.push_back({"camera " + std::to_string(i + 1), parameters_of(cameras[i].optics.lens),
                            cameras[i].T_room_camera, calibration::gamma_light(1.0)});
  }
  return made;
}

Eigen::Vector2d grid_pixel(int index, const calibration::BrownParameters& lens) {
  return {(index % kScoredColumns + 0.5) / kScoredColumns * lens.width_px,
          (index / kScoredColumns + 0.5) / kScoredRows * lens.height_px};
}

double noise_at(std::uint32_t seed, int x, int y) {
  std::uint64_t h = simulated::mixed(seed * 0x9e3779b97f4a7c15u +
                                     static_cast<std::uint64_t>(static_cast<std::uint32_t>(x)) * 73856093u);
  h = simulated::mixed(h ^ static_cast<std::uint64_t>(static_cast<std::uint32_t>(y)) * 19349663u);
  return static_cast<double>(h >> 11) * 0x1p-53;
}

/// Returns noise that is smooth between lattice points and has period `period` in x.
double smooth_noise(std::uint32_t seed, double x, double y, int period) {
  const int x0 = static_cast<int>(std::floor(x));
  const int y0 = static_cast<int>(std::floor(y));
  const auto ease = [](double t) { return t * t * (3.0 - 2.0 * t); };
  const double fx = ease(x - x0);
  const double fy = ease(y - y0);
  const auto at = [&](int xi, int yi) { return noise_at(seed, ((xi % period) + period) % period, yi); };
  return (1.0 - fy) * ((1.0 - fx) * at(x0, y0) + fx * at(x0 + 1, y0)) +
         fy * ((1.0 - fx) * at(x0, y0 + 1) + fx * at(x0 + 1, y0 + 1));
}

}  // namespace

ShowContent painted_content(int width_px, std::uint32_t seed) {
  ShowContent made;
  made.shape = Panorama{width_px, width_px / 8, 2.0 * std::numbers::pi, 0.4, -0.4};
  made.picture = RgbImage(made.shape.width_px, made.shape.height_px);
  for (int y = 0; y < made.shape.height_px; ++y) {
    for (int x = 0; x < made.shape.width_px; ++x) {
      double value = 0.0;
      double weight = 0.5;
      for (int octave = 0; octave < 6; ++octave) {
        const int period = 12 << octave;
        const double scale = static_cast<double>(period) / made.shape.width_px;
        value += weight * smooth_noise(seed + static_cast<std::uint32_t>(octave), x * scale, y * scale, period);
        weight *= 0.62;
      }
      const double paint = smooth_noise(seed + 40, x * 60.0 / width_px, y * 60.0 / width_px, 60) > 0.6 ? 0.18 : 0.0;
      const double code = std::clamp(255.0 * (value * 0.72 - 0.2 + paint), 0.0, 255.0);
      std::uint8_t* to = made.picture.at(x, y);
      to[0] = static_cast<std::uint8_t>(code);
      to[1] = static_cast<std::uint8_t>(0.85 * code);
      to[2] = static_cast<std::uint8_t>(0.7 * code);
    }
  }
  return made;
}

Result<ShowContent> read_content(const std::string& path, double tan_top, double tan_bottom) {
  TRY_ASSIGN(const auto bytes, read_file(path, std::size_t{1} << 28));
  TRY_ASSIGN(const RgbaImage png, decode_png(bytes, std::size_t{1} << 27));
  ShowContent made;
  made.shape = Panorama{png.width(), png.height(), 2.0 * std::numbers::pi, tan_top, tan_bottom};
  made.picture = RgbImage(png.width(), png.height());
  for (int y = 0; y < png.height(); ++y) {
    for (int x = 0; x < png.width(); ++x) std::copy_n(png.at(x, y), 3, made.picture.at(x, y));
  }
  return made;
}

BumpedShow::BumpedShow(const BumpedShowOptions& options, ShowContent content, simulated::SimulatedShow room,
                       healing::ContinuousCalibrator calibrator, calibration::ShowCalibration truth,
                       std::string installation_text)
    : options_(options),
      content_(std::move(content)),
      truth_(std::move(truth)),
      room_(std::make_unique<simulated::SimulatedShow>(std::move(room))),
      calibrator_(std::make_unique<healing::ContinuousCalibrator>(std::move(calibrator))),
      heads_(calibrator_->applied().projectors.size()),
      is_on_(heads_.size(), true),
      is_moved_(heads_.size(), false),
      installation_text_(std::move(installation_text)) {
  for (const calibration::ShowProjector& projector : calibrator_->applied().projectors)
    draws_for_.push_back(projector.T_room_projector);
  // A display draws with the measured map, which includes deviations that the model lacks. The map's own errors remain:
  simulated::RandomStream draws = simulated::RandomStream(options.seed).stream("map");
  for (std::size_t i = 0; i < heads_.size(); ++i) {
    const calibration::ShowProjector& projector = calibrator_->applied().projectors[i];
    const double error_px = 1.7 * options.left_over.map_px * projector.lens.width_px / 1920.0;
    std::vector<Eigen::Vector2d>& left = left_over_px_.emplace_back();
    for (int k = 0; k < kScoredColumns * kScoredRows; ++k) {
      const Eigen::Vector2d pixel = grid_pixel(k, projector.lens);
      const auto drawn = drawn_at(i, projector, pixel);
      const Eigen::Vector2d noise(draws.about_zero(error_px), draws.about_zero(error_px));
      left.push_back(drawn ? Eigen::Vector2d(*drawn - pixel + noise) : noise);
    }
  }
}

Result<BumpedShow> BumpedShow::make(const BumpedShowOptions& options, ShowContent content) {
  simulated::PresetOptions wanted;
  wanted.projectors = options.projectors;
  wanted.projector_width_px = options.projector_width_px;
  wanted.projector_height_px = options.projector_height_px;
  wanted.camera_megapixels = options.camera_megapixels;
  TRY_ASSIGN(simulated::Preset preset, simulated::make_preset(options.museum, options.seed, wanted));
  preset.truth.cells = options.wall_cells;
  const std::vector<simulated::FixedCamera> cameras = fixed_cameras(preset, options);
  calibration::ShowCalibration truth = true_room(preset, cameras);
  TRY_ASSIGN(const calibration::ShowCalibration known,
             calibrated(truth, options.left_over, simulated::RandomStream(options.seed).stream("calibration")));
  TRY_ASSIGN(healing::ContinuousCalibrator calibrator, healing::ContinuousCalibrator::make(known, options.calibrator));
  TRY_ASSIGN(simulated::SimulatedShow room,
             simulated::SimulatedShow::make(preset.installation, preset.truth, cameras, options.threads));
  return BumpedShow(options, std::move(content), std::move(room), std::move(calibrator), std::move(truth),
                    preset.installation_text);
}

RgbImage BumpedShow::draw(std::size_t index) const {
  calibration::ShowCalibration room = calibrator_->applied();
  for (std::size_t i = 0; i < draws_for_.size(); ++i) room.projectors[i].T_room_projector = draws_for_[i];
  const calibration::ShowProjector& projector = room.projectors[index];
  const int width = projector.lens.width_px;
  const int height = projector.lens.height_px;
  struct Node {
    float u = -1e9f;
    float v = 0.0f;
    float mask = 0.0f;
  };
  const int columns = width / kGrid_px + 2;
  const int rows = height / kGrid_px + 2;
  std::vector<Node> nodes;
  const auto inwardness = [](const calibration::BrownParameters& lens, const Eigen::Vector2d& p) {
    if (!contains(lens, p)) return 0.0;
    const double w = lens.width_px;
    const double h = lens.height_px;
    const double inward = 16.0 * p.x() * (w - p.x()) * p.y() * (h - p.y()) / (w * w * h * h);
    return inward * inward;
  };
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      Node& node = nodes.emplace_back();
      const Eigen::Vector2d pixel(column * kGrid_px, row * kGrid_px);
      const auto wall = calibration::wall_lit_at(room, projector, pixel);
      if (!wall) continue;
      const PanoramaPixel at = content_.shape.pixel_of(Eigen::AngleAxisd(-heading_rad_, Eigen::Vector3d::UnitY()) *
                                                       (*wall - room.sweet_spot.xyz));
      node.u = static_cast<float>(at.u);
      node.v = static_cast<float>(at.v);
      double sum = 0.0;
      for (const calibration::ShowProjector& other : room.projectors) {
        const auto there = pixel_of(other.lens, (other.T_room_projector.inverse() * Point<frame::Room>{*wall}).xyz);
        if (there && &other != &projector) sum += inwardness(other.lens, *there);
      }
      const double own = inwardness(projector.lens, pixel);
      // Code value for this fraction of light, with a gamma of 2.2.
      node.mask = sum + own > 0.0 ? static_cast<float>(std::pow(own / (sum + own), 1.0 / 2.2)) : 0.0f;
    }
  }
  RgbImage head(width, height);
  const float around = static_cast<float>(content_.shape.width_px);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const auto first = static_cast<std::size_t>((y / kGrid_px) * columns + x / kGrid_px);
      const Node* corner[4] = {&nodes[first], &nodes[first + 1], &nodes[first + static_cast<std::size_t>(columns)],
                               &nodes[first + static_cast<std::size_t>(columns) + 1]};
      const float fx = (static_cast<float>(x % kGrid_px) + 0.5f) / kGrid_px;
      const float fy = (static_cast<float>(y % kGrid_px) + 0.5f) / kGrid_px;
      const float weight[4] = {(1 - fx) * (1 - fy), fx * (1 - fy), (1 - fx) * fy, fx * fy};
      float u = 0.0f;
      float v = 0.0f;
      float mask = 0.0f;
      for (int k = 0; k < 4; ++k) {
        // The panorama wraps around, so corners are shifted by a full turn if that brings them closer to the first one.
        float near = corner[k]->u;
        if (near - corner[0]->u > 0.5f * around) near -= around;
        if (near - corner[0]->u < -0.5f * around) near += around;
        u += weight[k] * near;
        v += weight[k] * corner[k]->v;
        mask += weight[k] * corner[k]->mask;
      }
      if (!(mask > 0.0f) || !(u > -2.0f * around)) continue;
      const float px = u - 0.5f;
      const float py = std::clamp(v - 0.5f, 0.0f, static_cast<float>(content_.shape.height_px) - 1.001f);
      const int x0 = static_cast<int>(std::floor(px));
      const int y0 = static_cast<int>(py);
      const float gx = px - static_cast<float>(x0);
      const float gy = py - static_cast<float>(y0);
      const int w = content_.shape.width_px;
      const int left = ((x0 % w) + w) % w;
      const int right = (left + 1) % w;
      const int below = std::min(y0 + 1, content_.shape.height_px - 1);
      for (int c = 0; c < 3; ++c) {
        const float a = content_.picture.at(left, y0)[c];
        const float b = content_.picture.at(right, y0)[c];
        const float d = content_.picture.at(left, below)[c];
        const float e = content_.picture.at(right, below)[c];
        const float code = (1 - gy) * (a + gx * (b - a)) + gy * (d + gx * (e - d));
        head.at(x, y)[c] = static_cast<std::uint8_t>(mask * code + 0.5f);
      }
    }
  }
  return head;
}

Result<healing::ShowReport> BumpedShow::step() {
  for (std::size_t i = 0; i < draws_for_.size(); ++i)
    draws_for_[i] = calibrator_->applied().projectors[i].T_room_projector;
  TRY_ASSIGN(healing::ShowMoment moment, look());
  const double begun = thread_cpu_seconds();
  healing::ShowReport report = calibrator_->step(moment);
  cpu_s_ += thread_cpu_seconds() - begun;
  moment_ = std::move(moment);
  return report;
}

Result<healing::ShowMoment> BumpedShow::look() {
  now_ += options_.period;
  heading_rad_ += options_.turn_rad_s * std::chrono::duration<double>(options_.period).count();
  healing::ShowMoment moment;
  const Duration exposure = std::chrono::duration_cast<Duration>(std::chrono::duration<double>(options_.exposure_s));
  bool is_same = !is_changed_ && heading_rad_ == drawn_heading_rad_ && drawn_for_.size() == draws_for_.size();
  for (std::size_t i = 0; is_same && i < draws_for_.size(); ++i)
    is_same = calibration::step_between(drawn_for_[i], draws_for_[i]).norm() == 0.0;
  if (!is_same) {
    // The show turns shortly before the cameras take pictures; everything else changed earlier. A new listener gets
    // states that have lasted for a long time.
    Duration before = options_.period / 3;
    if (is_untold_) before = healing::ShowTimeline::kKept;
    if (heading_rad_ != drawn_heading_rad_) before = std::chrono::milliseconds(5);
    is_untold_ = false;
    drawn_for_ = draws_for_;
    drawn_heading_rad_ = heading_rad_;
    is_changed_ = false;
    for (std::size_t i = 0; i < heads_.size(); ++i) {
      // A display cannot detect that a lamp is off, so it reports the picture that it draws.
      heads_[i] = std::make_shared<const RgbImage>(draw(i));
      TRY(room_->show(i, is_on_[i] ? RgbImage(*heads_[i]) : RgbImage()));
      moment.shown.push_back({i, now_ - exposure - before, heads_[i], number_ + 1});
    }
    ++number_;
  } else {
    // A projector that moved shows its previous picture, because no display notices the movement.
    for (std::size_t i = 0; i < heads_.size(); ++i) {
      if (is_moved_[i]) TRY(room_->show(i, is_on_[i] ? RgbImage(*heads_[i]) : RgbImage()));
    }
  }
  is_moved_.assign(heads_.size(), false);
  // Displays are polled a moment after the cameras.
  const Duration asked_after = std::min<Duration>(options_.period / 4, std::chrono::milliseconds(100));
  for (std::size_t i = 0; i < heads_.size(); ++i) moment.until.push_back({i, now_ + asked_after, number_});
  for (std::size_t i = 0; i < room_->cameras().size(); ++i) {
    TRY_ASSIGN(GreyImage seen, room_->photograph(i, options_.exposure_s));
    moment.seen.push_back({i, now_ - exposure, now_, std::make_shared<const GreyImage>(std::move(seen))});
  }
  moment.now = now_;
  if (teller_) teller_(&moment);
  return moment;
}

Status BumpedShow::restart() {
  const calibration::ShowCalibration applied = calibrator_->applied();
  const auto learned = calibrator_->learned();
  TRY_ASSIGN(healing::ContinuousCalibrator anew,
             learned ? healing::ContinuousCalibrator::resume(applied, *learned, options_.calibrator)
                     : healing::ContinuousCalibrator::make(applied, options_.calibrator));
  *calibrator_ = std::move(anew);
  forget_told();  // The restarted process has no reports of what is shown.
  return Done{};
}

void BumpedShow::bump(std::size_t projector, const calibration::PoseStep& step) {
  const auto moved = room_->move_projector(
      projector, calibration::stepped(room_->truth().truth().projectors[projector].T_room_projector, step));
  CHECK(moved);
  is_moved_[projector] = true;
}

void BumpedShow::bump_camera(std::size_t camera, const calibration::PoseStep& step) {
  room_->move_camera(camera, calibration::stepped(room_->cameras()[camera].T_room_camera, step));
}

double BumpedShow::error_px(std::size_t projector, double percentile) const {
  return off_px(projector, calibrator_->applied().projectors[projector], percentile);
}

double BumpedShow::drawn_error_px(std::size_t projector, double percentile) const {
  calibration::ShowProjector drawn_for = calibrator_->applied().projectors[projector];
  drawn_for.T_room_projector = draws_for_[projector];
  return off_px(projector, drawn_for, percentile);
}

std::optional<Eigen::Vector2d> BumpedShow::drawn_at(std::size_t projector, const calibration::ShowProjector& drawn_for,
                                                    const Eigen::Vector2d& pixel) const {
  const auto at = room_->truth().wall_at(projector, pixel.x(), pixel.y());
  if (!at) return std::nullopt;
  const auto position = believed_position(truth_, calibrator_->applied(), at->point.xyz);
  if (!position) return std::nullopt;
  return pixel_of(drawn_for.lens, (drawn_for.T_room_projector.inverse() * Point<frame::Room>{*position}).xyz);
}

double BumpedShow::off_px(std::size_t projector, const calibration::ShowProjector& drawn_for, double percentile) const {
  std::vector<double> errors;
  for (int i = 0; i < kScoredColumns * kScoredRows; ++i) {
    const Eigen::Vector2d pixel = grid_pixel(i, drawn_for.lens);
    if (!room_->truth().wall_at(projector, pixel.x(), pixel.y())) continue;
    const auto drawn = drawn_at(projector, drawn_for, pixel);
    errors.push_back(drawn ? (*drawn - pixel - left_over_px_[projector][static_cast<std::size_t>(i)]).norm() : 1e3);
  }
  if (errors.empty()) return 0.0;
  std::ranges::sort(errors);
  return errors[std::min(errors.size() - 1, static_cast<std::size_t>(percentile * static_cast<double>(errors.size())))];
}

calibration::PoseStep drawn_bump(simulated::RandomStream* draws) {
  // Uniform in the logarithm, from 0.05 to 5 degrees and from 1 to 100 mm:
  const auto log_between = [&](double min, double max) { return min * std::pow(max / min, draws->between(0.0, 1.0)); };
  calibration::PoseStep step = calibration::PoseStep::Zero();
  const int kind = static_cast<int>(draws->between(0.0, 7.0));
  const double turn = log_between(0.05, 5.0) * kDegree;
  const double shift = log_between(0.001, 0.1);
  const auto sign = [&] { return draws->about_zero(1.0) < 0.0 ? -1.0 : 1.0; };
  if (kind < 3) {
    step[kind] = sign() * turn;
  } else if (kind < 6) {
    step[kind] = sign() * shift;
  } else {
    for (int i = 0; i < 6; ++i) step[i] = draws->about_zero(i < 3 ? turn : shift);
  }
  return step;
}

}  // namespace cyclorama
