// SPDX-License-Identifier: Apache-2.0
#include "tests/data_sets/photometry_museum.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "appliance/calibration/map_grid.h"
#include "appliance/structured_light/pattern_drawing.h"
#include "drivers/simulated/museum/camera_table.h"

namespace cyclorama {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr int kThreads = 2;

Image<float, 3> as_floats(const simulated::RgbPhotograph& photograph, int bits) {
  Image<float, 3> codes(photograph.width(), photograph.height());
  const float largest = static_cast<float>((1 << bits) - 1);
  std::transform(photograph.data().begin(), photograph.data().end(), codes.data().begin(),
                 [largest](std::uint16_t code) { return static_cast<float>(code) / largest; });
  return codes;
}

/// Returns the result of a perfect decoder for a projector.
structured_light::Decoded decoded_of(const simulated::SimulatedMuseum& museum, const simulated::CameraTable& table,
                                     std::size_t projector) {
  structured_light::Decoded decoded;
  const int width = museum.camera_width_px();
  decoded.position_px = Image<float, 2>(width, museum.camera_height_px());
  decoded.fate =
      Image<structured_light::PixelFate, 1>(width, museum.camera_height_px(), structured_light::PixelFate::kDark);
  const Pinhole& lens = museum.installation().projectors[projector].lens;
  for (const simulated::CameraTable::Sample& sample : table.projectors[projector].samples) {
    if (!lens.contains({static_cast<double>(sample.u), static_cast<double>(sample.v)})) continue;
    const int x = static_cast<int>(sample.pixel) % width;
    const int y = static_cast<int>(sample.pixel) / width;
    decoded.position_px.at(x, y)[0] = sample.u;
    decoded.position_px.at(x, y)[1] = sample.v;
    *decoded.fate.at(x, y) = structured_light::PixelFate::kDecoded;
  }
  return decoded;
}

/// One stop of the turntable.
class Stop {
 public:
  Stop(simulated::SimulatedMuseum* museum, const MuseumLightOptions& scan, int* photographs)
      : museum_(*museum), scan_(scan), photographs_(*photographs) {}

  Result<std::vector<photometry::ProjectorView>> views(std::span<const Eigen::Vector3d> directions) {
    const simulated::CameraTable table =
        simulated::make_camera_table(museum_.truth(), museum_.truth().truth().camera.lens,
                                     museum_.truth().camera_pose(museum_.true_turntable_angle_rad()),
                                     std::vector<Eigen::Vector3d>(directions.begin(), directions.end()), kThreads);
    std::vector<photometry::ProjectorView> views;
    for (std::size_t p = 0; p < museum_.projector_count(); ++p) {
      const Pinhole& lens = museum_.installation().projectors[p].lens;
      TRY_ASSIGN(photometry::CameraCells cells,
                 photometry::camera_cells(decoded_of(museum_, table, p), lens.width_px, lens.height_px, scan_.cell_px));
      views.push_back({p, std::move(cells), {}});
    }
    return views;
  }

  /// Shows a picture on one projector, with all others dark.
  Status show(std::size_t projector, const structured_light::PatternPicture& picture) {
    for (std::size_t p = 0; p < museum_.projector_count(); ++p) {
      const Pinhole& lens = museum_.installation().projectors[p].lens;
      const structured_light::PatternSet set{lens.width_px, lens.height_px, -1, 0.0, 0, {}};
      TRY(museum_.show(
          p, p == projector ? structured_light::drawn(set, picture) : RgbImage(lens.width_px, lens.height_px)));
    }
    museum_.settle();
    return Done{};
  }

  Result<Image<float, 3>> photograph(double exposure_s) {
    ++photographs_;
    TRY_ASSIGN(const simulated::RgbPhotograph codes, museum_.photograph_colour(exposure_s));
    return as_floats(codes, museum_.camera_bits());
  }

  Status read(const structured_light::PatternPicture& picture, const std::vector<double>& exposures_s,
              photometry::ProjectorView* view) {
    TRY(show(view->projector, picture));
    for (const double exposure_s : exposures_s) {
      TRY_ASSIGN(const auto codes, photograph(exposure_s));
      TRY_ASSIGN(photometry::LightReading reading, photometry::read_light(view->cells, codes, picture, exposure_s));
      view->readings.push_back(std::move(reading));
    }
    return Done{};
  }

 private:
  simulated::SimulatedMuseum& museum_;
  const MuseumLightOptions& scan_;
  int& photographs_;
};

int seen_cells(const photometry::ProjectorView& view) {
  return static_cast<int>(std::ranges::count_if(view.cells.cells, [](const auto& cell) { return cell.pixels > 0; }));
}

/// Returns the exposure at which white of the brightest projector is just not clipped.
Result<double> white_exposure(simulated::SimulatedMuseum* museum, Stop* stop) {
  double exposure_s = 1.0 / 60.0;
  for (int round = 0; round < 8; ++round) {
    float bright = 0.0f;
    for (std::size_t p = 0; p < museum->projector_count(); ++p) {
      TRY(stop->show(p, {.kind = structured_light::PatternKind::kWhite}));
      TRY_ASSIGN(auto codes, stop->photograph(exposure_s));
      const auto at =
          codes.data().begin() + static_cast<std::ptrdiff_t>(0.999 * static_cast<double>(codes.data().size()));
      std::nth_element(codes.data().begin(), at, codes.data().end());
      bright = std::max(bright, *at);
    }
    if (bright > 0.6f && bright < 0.88f) break;
    exposure_s *= bright > 0.95f ? 0.4 : std::min(8.0, 0.78 / std::max(0.02, static_cast<double>(bright)));
  }
  return exposure_s;
}

std::vector<double> times(const std::vector<double>& factors, double by) {
  std::vector<double> result;
  for (const double factor : factors) result.push_back(factor * by);
  return result;
}

}  // namespace

calibration::MeasuredMap true_map(const simulated::TrueMuseum& museum, std::size_t projector, int cell_px) {
  const Pinhole& lens = museum.installation().projectors[projector].lens;
  calibration::MeasuredMap map;
  map.width_px = lens.width_px;
  map.height_px = lens.height_px;
  map.cells_x = std::max(1, lens.width_px / cell_px);
  map.cells_y = std::max(1, lens.height_px / cell_px);
  const calibration::MapGrid grid{map.width_px, map.height_px, map.cells_x, map.cells_y};
  const Eigen::Vector3d none = Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  for (int y = 0; y <= map.cells_y; ++y) {
    for (int x = 0; x <= map.cells_x; ++x) {
      const auto direction = museum.direction_at(projector, x * grid.cell_width(), y * grid.cell_height(),
                                                 museum.installation().sweet_spot);
      map.directions.push_back(direction.value_or(none));
    }
  }
  for (int ring = 0; ring < 2; ++ring) {
    const std::vector<Eigen::Vector3d> before = map.directions;
    for (int y = 0; y <= map.cells_y; ++y) {
      for (int x = 0; x <= map.cells_x; ++x) {
        const auto node = static_cast<std::size_t>(grid.node(x, y));
        if (before[node].allFinite()) continue;
        Eigen::Vector3d sum = Eigen::Vector3d::Zero();
        for (const auto& [dx, dy] : {std::pair(1, 0), std::pair(-1, 0), std::pair(0, 1), std::pair(0, -1)}) {
          const int far_x = x + 2 * dx;
          const int far_y = y + 2 * dy;
          if (far_x < 0 || far_y < 0 || far_x > map.cells_x || far_y > map.cells_y) continue;
          const Eigen::Vector3d& near = before[static_cast<std::size_t>(grid.node(x + dx, y + dy))];
          const Eigen::Vector3d& far = before[static_cast<std::size_t>(grid.node(far_x, far_y))];
          if (near.allFinite() && far.allFinite()) sum += 2.0 * near - far;
        }
        if (sum.norm() > 0.5) map.directions[node] = sum.normalized();
      }
    }
  }
  map.sigma_px.assign(map.directions.size(), 0.1);
  return map;
}

Result<MuseumLight> photograph_light(simulated::SimulatedMuseum* museum, const MuseumLightOptions& scan) {
  MuseumLight result;
  result.input.camera_width_px = museum->camera_width_px();
  result.input.camera_height_px = museum->camera_height_px();
  result.input.code_step = 1.0 / ((1 << museum->camera_bits()) - 1);
  const Pinhole& lens = museum->truth().truth().camera.lens.pinhole();
  result.input.camera_centre_px = Eigen::Vector2d(lens.centre_u_px, lens.centre_v_px);
  for (std::size_t p = 0; p < museum->projector_count(); ++p) {
    result.input.projectors.push_back(
        {museum->installation().projectors[p].name, true_map(museum->truth(), p, scan.map_cell_px)});
  }
  const std::vector<Eigen::Vector3d> directions =
      simulated::pixel_directions(museum->truth().truth().camera.lens, kThreads);
  Stop stop(museum, scan, &result.photographs);
  std::vector<std::vector<photometry::ProjectorView>> views;
  std::vector<std::size_t> best(museum->projector_count(), 0);
  for (std::size_t s = 0; s < scan.angles_deg.size(); ++s) {
    museum->turn_to(scan.angles_deg[s] * kDegree);
    if (s == 0) {
      TRY_ASSIGN(result.white_exposure_s, white_exposure(museum, &stop));
    }
    TRY_ASSIGN(auto here, stop.views(directions));
    for (std::size_t p = 0; p < best.size(); ++p) {
      if (s > 0 && seen_cells(here[p]) > seen_cells(views[best[p]][p])) best[p] = s;
    }
    views.push_back(std::move(here));
  }
  const std::vector<double> exposures = times(scan.exposures, result.white_exposure_s);
  std::vector<double> black_exposures = exposures;
  black_exposures.push_back(std::min(2.0, scan.black_exposure * result.white_exposure_s));
  for (std::size_t s = 0; s < views.size(); ++s) {
    museum->turn_to(scan.angles_deg[s] * kDegree);
    for (photometry::ProjectorView& view : views[s]) {
      if (seen_cells(view) == 0) continue;
      TRY(stop.read({.kind = structured_light::PatternKind::kBlack}, black_exposures, &view));
      TRY(stop.read({.kind = structured_light::PatternKind::kWhite}, exposures, &view));
      if (best[view.projector] != s) continue;
      TRY_ASSIGN(const structured_light::PatternSet set,
                 structured_light::ramps(view.cells.width_px, view.cells.height_px, scan.ramp_steps,
                                         {structured_light::PatternLight::kRed, structured_light::PatternLight::kGreen,
                                          structured_light::PatternLight::kBlue}));
      for (const structured_light::PatternPicture& picture : set.pictures) {
        if (picture.level > 0.0) TRY(stop.read(picture, exposures, &view));
      }
    }
    for (photometry::ProjectorView& view : views[s]) {
      if (!view.readings.empty()) result.input.views.push_back(std::move(view));
    }
  }
  return result;
}

double response_rms(const simulated::TrueMuseum& museum, const photometry::Photometry& photometry) {
  double worst = 0.0;
  for (std::size_t p = 0; p < photometry.heads.size(); ++p) {
    for (std::size_t c = 0; c < 3; ++c) {
      const double black = museum.channel_light(p, c, 0);
      double max = 0.0;
      for (int code = 0; code < 256; ++code) max = std::max(max, museum.channel_light(p, c, code) - black);
      double sum = 0.0;
      for (int code = 0; code < 256; ++code) {
        const double truth = (museum.channel_light(p, c, code) - black) / max;
        const double error = photometry.heads[p].response.at(c).light_of(code / 255.0) - truth;
        sum += error * error / 256.0;
      }
      worst = std::max(worst, std::sqrt(sum));
    }
  }
  return worst;
}

}  // namespace cyclorama
