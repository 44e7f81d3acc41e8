// SPDX-License-Identifier: Apache-2.0
#include "drivers/simulated/museum/simulated_museum.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "drivers/simulated/museum/camera_table.h"
#include "drivers/simulated/museum/gaussian_blur.h"
#include "drivers/simulated/museum/parallel_rows.h"
#include "drivers/simulated/museum/projector_light.h"
#include "drivers/simulated/museum/true_museum.h"
#include "drivers/simulated/museum/true_sensor.h"

namespace cyclorama::simulated {
namespace {

template <int Channels>
Image<std::uint8_t, Channels> shortened(const Image<std::uint16_t, Channels>& photograph, int bits) {
  Image<std::uint8_t, Channels> picture(photograph.width(), photograph.height());
  const double scale = 255.0 / ((1 << bits) - 1);
  std::transform(
      photograph.data().begin(), photograph.data().end(), picture.data().begin(),
      [scale](std::uint16_t code) { return static_cast<std::uint8_t>(std::clamp(scale * code + 0.5, 0.0, 255.0)); });
  return picture;
}

/// Exposure of a camera that exposes as it likes, before it adapts.
constexpr double kAutomatic_s = 1.0 / 30.0;

/// Shifts a plane by parts of a pixel, as a turned camera does. The border is continued.
void shift_plane(std::vector<float>* plane, int width, int height, const Eigen::Vector2d& by_px) {
  if (by_px.isZero()) return;
  const std::vector<float> before = *plane;
  const auto at = [&](int x, int y) {
    const auto row = static_cast<std::size_t>(std::clamp(y, 0, height - 1)) * static_cast<std::size_t>(width);
    return before[row + static_cast<std::size_t>(std::clamp(x, 0, width - 1))];
  };
  const int left = static_cast<int>(std::floor(-by_px.x()));
  const int up = static_cast<int>(std::floor(-by_px.y()));
  const auto fx = static_cast<float>(-by_px.x() - left);
  const auto fy = static_cast<float>(-by_px.y() - up);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const float above = (1.0f - fx) * at(x + left, y + up) + fx * at(x + left + 1, y + up);
      const float below = (1.0f - fx) * at(x + left, y + up + 1) + fx * at(x + left + 1, y + up + 1);
      (*plane)[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)] =
          (1.0f - fy) * above + fy * below;
    }
  }
}

/// Pictures of a projector: one until `since_s`, another from then on.
struct Showing {
  ProjectorLight before;
  ProjectorLight now;
  double since_s = 0.0;
};

}  // namespace

GreyImage to_8_bits(const GreyPhotograph& photograph, int bits) { return shortened(photograph, bits); }
RgbImage to_8_bits(const RgbPhotograph& photograph, int bits) { return shortened(photograph, bits); }

struct SimulatedMuseum::State {
  TrueMuseum truth;
  TrueSensor sensor;
  int threads;
  std::vector<Showing> showing;
  double now_s = 0.0;
  double told_angle_rad = 0.0;
  double last_turn_sign = 1.0;
  double true_angle_rad = 0.0;
  std::uint64_t turns = 0;
  std::uint64_t photographs = 0;
  double automatic_gain = 1.0;
  std::vector<Eigen::Vector3d> directions{};
  std::vector<float> vignetting{};
  std::optional<CameraTable> table{};

  State(TrueMuseum t, int thread_count)
      : truth(std::move(t)),
        sensor(truth.truth().camera),
        threads(std::max(thread_count, 1)),
        showing(truth.truth().projectors.size()) {
    const TrueCamera& camera = truth.truth().camera;
    directions = pixel_directions(camera.lens, threads);
    for (const Eigen::Vector3d& d : directions) {
      const double cosine = d.z() > 0.0 ? d.z() / d.norm() : 0.0;
      vignetting.push_back(static_cast<float>(std::pow(cosine, camera.vignetting_exponent)));
    }
    true_angle_rad = angle_after(0.0);
  }

  /// Shift of the camera's picture by its mount.
  [[nodiscard]] Eigen::Vector2d mount_shift_px() const {
    const TrueTurntable& mount = truth.truth().turntable;
    Eigen::Vector2d shift = now_s / 3600.0 * mount.creep_px_per_h;
    if (mount.vibration_px > 0.0) {
      const std::uint64_t random = mixed(mixed(truth.truth().seed + 0x30000u) + photographs);
      const auto quantiles = normal_quantiles();
      for (int axis = 0; axis < 2; ++axis) {
        const float deviate = quantiles[(random >> (16 * axis)) % quantiles.size()];
        shift[axis] += mount.vibration_px * static_cast<double>(deviate);
      }
    }
    return shift;
  }

  /// Brings the mean of the next picture nearer to what the camera likes.
  template <int Channels>
  void adapt_exposure(const Image<std::uint16_t, Channels>& codes) {
    double sum = 0.0;
    for (const std::uint16_t code : codes.data()) sum += code;
    const TrueCamera& camera = truth.truth().camera;
    const double mean = sum / static_cast<double>(codes.data().size()) / ((1 << camera.bits) - 1);
    // The response is a power, so that codes answer light less than in proportion.
    const double wanted = std::pow(camera.pipeline.auto_exposure / std::max(mean, 1e-3), 1.0 / camera.response.gamma);
    automatic_gain = std::clamp(automatic_gain * std::sqrt(wanted), 1.0 / 64.0, 8.0);
  }

  [[nodiscard]] double angle_after(double told) const {
    const TrueTurntable& turntable = truth.truth().turntable;
    const std::uint64_t random = mixed(mixed(truth.truth().seed) + turns);
    const auto quantiles = normal_quantiles();
    const double stop = static_cast<double>(quantiles[random % quantiles.size()]);
    return told * (1.0 + turntable.scale_error) + turntable.wobble_rad * std::sin(told) -
           0.5 * turntable.backlash_rad * last_turn_sign + turntable.jitter_rad * stop;
  }

  /// Response of the camera's channels to the light on the wall's cells that varies slowly: indirect and ambient light.
  [[nodiscard]] std::vector<std::vector<float>> slow_light(const std::vector<CameraChannel>& channels, bool is_before) {
    const RoomColour ambient = truth.truth().ambient_at(now_s);
    InterReflection::Light light(truth.cells().count(), ambient);
    if (const InterReflection* walls = truth.inter_reflection()) {
      for (std::size_t i = 0; i < showing.size(); ++i) {
        const auto& direct = picture_of(i, is_before).direct_light(truth, i);
        for (std::size_t k = 0; k < light.size(); ++k) {
          for (std::size_t r = 0; r < 3; ++r) light[k][r] += direct[k][r];
        }
      }
      light = walls->indirect(light);
      for (RoomColour& lux : light) {
        for (std::size_t r = 0; r < 3; ++r) lux[r] += ambient[r];
      }
    }
    std::vector<std::vector<float>> seen;
    for (const CameraChannel& channel : channels) {
      auto& cells = seen.emplace_back();
      for (const RoomColour& lux : light) {
        double sum = 0.0;
        for (std::size_t r = 0; r < 3; ++r) sum += channel[r] * truth.truth().albedo[r] / std::numbers::pi * lux[r];
        cells.push_back(static_cast<float>(sum));
      }
    }
    return seen;
  }

  ProjectorLight& picture_of(std::size_t projector, bool is_before) {
    return is_before ? showing[projector].before : showing[projector].now;
  }

  /// Light on the sensor in nits, weighted by each channel, before lens blur. One plane per channel.
  std::vector<std::vector<float>> seen_light(const std::vector<CameraChannel>& channels, bool is_before);
  void add_slow_light(const std::vector<std::vector<float>>& cells, int begin, int end,
                      std::vector<std::vector<float>>* planes) const;
  /// Blends the light of both pictures, weighted in each row by exposure time.
  std::vector<std::vector<float>> exposed_light(const std::vector<CameraChannel>& channels, double exposure_s);
  template <int Channels>
  Result<Image<std::uint16_t, Channels>> photograph(const std::vector<CameraChannel>& channels, double exposure_s);
};

void SimulatedMuseum::State::add_slow_light(const std::vector<std::vector<float>>& cells, int begin, int end,
                                            std::vector<std::vector<float>>* planes) const {
  const auto width = static_cast<std::size_t>(truth.truth().camera.lens.pinhole().width_px);
  for (std::size_t pixel = static_cast<std::size_t>(begin) * width; pixel < static_cast<std::size_t>(end) * width;
       ++pixel) {
    const CameraTable::Place& position = table->positions[pixel];
    if (position.part < 0) continue;
    const auto share = truth.cells().share({static_cast<std::size_t>(position.part),
                                            static_cast<double>(position.across), static_cast<double>(position.along)});
    for (std::size_t c = 0; c < cells.size(); ++c) {
      float light = 0.0f;
      for (std::size_t k = 0; k < 4; ++k) light += static_cast<float>(share.weights[k]) * cells[c][share.cells[k]];
      (*planes)[c][pixel] = position.paint * light;
    }
  }
}

std::vector<std::vector<float>> SimulatedMuseum::State::seen_light(const std::vector<CameraChannel>& channels,
                                                                   bool is_before) {
  const Pinhole& lens = truth.truth().camera.lens.pinhole();
  const auto cells = slow_light(channels, is_before);
  std::vector<std::vector<float>> planes;
  for (const CameraChannel& channel : channels) {
    const double surround = truth.truth().surround_nits * (channel[0] + channel[1] + channel[2]);
    planes.emplace_back(directions.size(), static_cast<float>(surround));
  }
  std::vector<const std::vector<ProjectorLight::Plane>*> lights(showing.size(), nullptr);
  for (std::size_t i = 0; i < showing.size(); ++i) {
    ProjectorLight& picture = picture_of(i, is_before);
    if (!picture.is_dark()) lights[i] = &picture.planes(truth, i, channels, threads);
  }
  for_rows(lens.height_px, threads, [&](int begin, int end) {
    add_slow_light(cells, begin, end, &planes);
    for (std::size_t i = 0; i < lights.size(); ++i) {
      if (lights[i] == nullptr) continue;
      const CameraTable::Projector& seen = table->projectors[i];
      const Eigen::Vector2f drift = truth.truth().projectors[i].drift_at(now_s).cast<float>();
      const std::size_t last = seen.row_begins[static_cast<std::size_t>(end)];
      for (std::size_t k = seen.row_begins[static_cast<std::size_t>(begin)]; k < last; ++k) {
        CameraTable::Sample s = seen.samples[k];
        s.u += drift.x();
        s.v += drift.y();
        const float sum_u = s.uu + s.uv;
        const float sum_v = s.uv + s.vv;
        const float difference_u = s.uu - s.uv;
        const float difference_v = s.uv - s.vv;
        for (std::size_t c = 0; c < planes.size(); ++c) {
          const ProjectorLight::Plane& plane = (*lights[i])[c];
          planes[c][s.pixel] +=
              0.25f * s.gain_lux *
              (plane.at(s.u + sum_u, s.v + sum_v) + plane.at(s.u - sum_u, s.v - sum_v) +
               plane.at(s.u + difference_u, s.v + difference_v) + plane.at(s.u - difference_u, s.v - difference_v));
        }
      }
    }
  });
  return planes;
}

std::vector<std::vector<float>> SimulatedMuseum::State::exposed_light(const std::vector<CameraChannel>& channels,
                                                                      double exposure_s) {
  const TrueCamera& camera = truth.truth().camera;
  const int height = camera.lens.pinhole().height_px;
  const double end_s = now_s + exposure_s + camera.line_time_s * (height - 1);
  double earliest = end_s;
  double latest = now_s;
  for (const Showing& s : showing) {
    earliest = std::min(earliest, s.since_s);
    latest = std::max(latest, s.since_s);
  }
  if (latest <= now_s) return seen_light(channels, false);
  if (earliest >= end_s) return seen_light(channels, true);
  // Some rows are exposed during a change. Each projector changes at its own time, so the light of each is computed
  // alone, and the results are added.
  std::vector<std::vector<float>> sum;
  std::vector<Showing> all = std::move(showing);
  const auto only = [&](std::size_t projector, bool is_before) {
    showing = std::vector<Showing>(all.size());
    if (projector < all.size()) showing[projector].now = is_before ? all[projector].before : all[projector].now;
    return seen_light(channels, false);
  };
  const std::vector<std::vector<float>> none = only(all.size(), false);
  sum = none;
  const auto width = static_cast<std::size_t>(camera.lens.pinhole().width_px);
  for (std::size_t i = 0; i < all.size(); ++i) {
    for (const bool is_before : {true, false}) {
      const auto alone = only(i, is_before);
      for (int y = 0; y < height; ++y) {
        const double opened = now_s + camera.line_time_s * y;
        const double after = std::clamp((opened + exposure_s - all[i].since_s) / exposure_s, 0.0, 1.0);
        const auto part = static_cast<float>(is_before ? 1.0 - after : after);
        for (std::size_t c = 0; c < sum.size(); ++c) {
          for (std::size_t k = static_cast<std::size_t>(y) * width; k < static_cast<std::size_t>(y + 1) * width; ++k)
            sum[c][k] += part * (alone[c][k] - none[c][k]);
        }
      }
    }
  }
  showing = std::move(all);
  return sum;
}

template <int Channels>
Result<Image<std::uint16_t, Channels>> SimulatedMuseum::State::photograph(const std::vector<CameraChannel>& channels,
                                                                          double exposure_s) {
  if (!(exposure_s >= 1e-6 && exposure_s <= 60.0))
    return Error(ErrorCode::kInvalidArgument,
                 fmt::format("an exposure of {} s; take one from 1e-6 to 60 s", exposure_s));
  const TrueCamera& camera = truth.truth().camera;
  const int width = camera.lens.pinhole().width_px;
  const int height = camera.lens.pinhole().height_px;
  if (!table) table = make_camera_table(truth, camera.lens, truth.camera_pose(true_angle_rad), directions, threads);
  std::vector<std::vector<float>> light = exposed_light(channels, exposure_s);
  Image<std::uint16_t, Channels> codes(width, height);
  const double exposed_s = camera.pipeline.auto_exposure > 0.0 ? kAutomatic_s * automatic_gain : exposure_s;
  const auto electrons_per_nit = static_cast<float>(camera.electrons_per_nit_s * exposed_s);
  const Eigen::Vector2d moved = mount_shift_px();
  const double blur_px = std::sqrt(camera.blur_px * camera.blur_px + kFootprintLack_px2);
  for (std::size_t c = 0; c < light.size(); ++c) {
    shift_plane(&light[c], width, height, moved);
    blur_plane(&light[c], width, height, blur_px, threads);
    for_rows(height, threads, [&](int begin, int end) {
      for (int y = begin; y < end; ++y) {
        const std::size_t first = static_cast<std::size_t>(y) * static_cast<std::size_t>(width);
        const std::span<float> row(light[c].data() + first, static_cast<std::size_t>(width));
        for (std::size_t x = 0; x < row.size(); ++x) row[x] *= electrons_per_nit * vignetting[first + x];
        const std::uint64_t stream = mixed(mixed(truth.truth().seed + 0x10000u) + (photographs * 4 + c) * 0x10000u +
                                           static_cast<std::uint64_t>(y));
        sensor.read_row(row, stream, codes.at(0, y) + c, Channels);
      }
    });
  }
  camera.pipeline.apply(&codes, (1 << camera.bits) - 1);
  if (camera.pipeline.auto_exposure > 0.0) adapt_exposure(codes);
  ++photographs;
  now_s += exposure_s + camera.line_time_s * (height - 1);
  return codes;
}

Result<SimulatedMuseum> SimulatedMuseum::make(Installation installation, const MuseumTruth& truth, int threads) {
  TRY_ASSIGN(TrueMuseum museum, TrueMuseum::make(std::move(installation), truth));
  return SimulatedMuseum(std::make_unique<State>(std::move(museum), threads));
}

Result<SimulatedMuseum> SimulatedMuseum::open(const std::filesystem::path& path, int threads) {
  TRY_ASSIGN(Installation installation, read_installation(path));
  TRY_ASSIGN(const MuseumTruth truth, MuseumTruth::read(truth_path_beside(path)));
  return make(std::move(installation), truth, threads);
}

SimulatedMuseum::SimulatedMuseum(std::unique_ptr<State> state) : state_(std::move(state)) {}
SimulatedMuseum::SimulatedMuseum(SimulatedMuseum&&) noexcept = default;
SimulatedMuseum& SimulatedMuseum::operator=(SimulatedMuseum&&) noexcept = default;
SimulatedMuseum::~SimulatedMuseum() = default;

const Installation& SimulatedMuseum::installation() const { return state_->truth.installation(); }
std::size_t SimulatedMuseum::projector_count() const { return state_->showing.size(); }

Status SimulatedMuseum::show(std::size_t projector, RgbImage picture) {
  if (projector >= state_->showing.size()) {
    return Error(ErrorCode::kInvalidArgument,
                 fmt::format("there is no projector {}; there are {}", projector, state_->showing.size()));
  }
  const TrueProjector& real = state_->truth.truth().projectors[projector];
  const Pinhole& lens = real.lens.pinhole();
  if (!picture.empty() && (picture.width() != lens.width_px || picture.height() != lens.height_px)) {
    return Error(ErrorCode::kInvalidArgument,
                 fmt::format("a picture of {}x{} for a projector of {}x{}", picture.width(), picture.height(),
                             lens.width_px, lens.height_px));
  }
  Showing& showing = state_->showing[projector];
  // A pending picture that has not appeared yet is replaced.
  if (showing.since_s <= state_->now_s) showing.before = std::move(showing.now);
  showing.now = ProjectorLight(std::move(picture));
  showing.since_s = state_->now_s + real.latency_s;
  return Done{};
}

void SimulatedMuseum::settle() {
  for (const Showing& showing : state_->showing) state_->now_s = std::max(state_->now_s, showing.since_s);
}

void SimulatedMuseum::wait(double seconds) { state_->now_s += std::max(seconds, 0.0); }
double SimulatedMuseum::now_s() const { return state_->now_s; }

void SimulatedMuseum::turn_to(double angle_rad) {
  State& state = *state_;
  const double by = angle_rad - state.told_angle_rad;
  if (by != 0.0) state.last_turn_sign = by > 0.0 ? 1.0 : -1.0;
  state.now_s += std::abs(by) / state.truth.truth().turntable.speed_rad_s;
  state.told_angle_rad = angle_rad;
  ++state.turns;
  state.true_angle_rad = state.angle_after(angle_rad);
  state.table.reset();
}

double SimulatedMuseum::turntable_angle_rad() const { return state_->told_angle_rad; }

int SimulatedMuseum::camera_width_px() const { return state_->truth.truth().camera.lens.pinhole().width_px; }
int SimulatedMuseum::camera_height_px() const { return state_->truth.truth().camera.lens.pinhole().height_px; }
int SimulatedMuseum::camera_bits() const { return state_->truth.truth().camera.bits; }

Result<GreyPhotograph> SimulatedMuseum::photograph_grey(double exposure_s) {
  return state_->photograph<1>({state_->truth.truth().camera.grey_sensitivity}, exposure_s);
}

Result<RgbPhotograph> SimulatedMuseum::photograph_colour(double exposure_s) {
  const ColourMatrix& filters = state_->truth.truth().camera.sensitivity;
  return state_->photograph<3>({filters[0], filters[1], filters[2]}, exposure_s);
}

const TrueMuseum& SimulatedMuseum::truth() const { return state_->truth; }
double SimulatedMuseum::true_turntable_angle_rad() const { return state_->true_angle_rad; }

}  // namespace cyclorama::simulated
