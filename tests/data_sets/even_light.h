// SPDX-License-Identifier: Apache-2.0
/// Readings of uniformly lit projectors without photographs, with configurable curves, noise and disturbances.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "appliance/photometry/inverse_map.h"
#include "appliance/photometry/photometry_input.h"

namespace cyclorama {

/// A projector on a wall at infinity: its pixels are directions, rotated by `pan_rad` to the right.
inline calibration::MeasuredMap far_map(int width_px, int height_px, double field_rad, double pan_rad,
                                        int cell_px = 20) {
  calibration::MeasuredMap map;
  map.width_px = width_px;
  map.height_px = height_px;
  map.cells_x = width_px / cell_px;
  map.cells_y = height_px / cell_px;
  const double focal = 0.5 * width_px / std::tan(0.5 * field_rad);
  for (int y = 0; y <= map.cells_y; ++y) {
    for (int x = 0; x <= map.cells_x; ++x) {
      const double right = (static_cast<double>(x) * width_px / map.cells_x - 0.5 * width_px) / focal;
      const double up = -(static_cast<double>(y) * height_px / map.cells_y - 0.5 * height_px) / focal;
      const double cosine = std::cos(pan_rad);
      const double sine = std::sin(pan_rad);
      map.directions.push_back(Eigen::Vector3d(cosine * right + sine, up, sine * right - cosine).normalized());
    }
  }
  map.sigma_px.assign(map.directions.size(), 0.1);
  return map;
}

using Curve = std::function<double(double)>;

struct EvenLight {
  std::array<Curve, 3> projector = {[](double x) { return std::pow(x, 2.2); },
                                    [](double x) { return std::pow(x, 2.2); },
                                    [](double x) { return std::pow(x, 2.2); }};
  Curve camera = [](double light) { return light; };  ///< Code for light as a fraction of full scale.
  double pedestal = 0.01;
  double brightness = 0.24;  ///< Brightness of each light in the camera's own channel at the first exposure.
  double black_level = 5e-4;
  double ambient = 2e-3;
  double noise = 0.0;  ///< Standard deviation of a cell's mean.
  int bits = 0;        ///< 0: codes are not rounded.
  int steps = 17;
  std::vector<double> exposures{1.0, 3.0};
  std::vector<double> black_exposures{1.0, 3.0, 32.0};
  std::array<double, 3> channel_light{1.0, 1.0, 1.0};
  double disturbed = 0.0;  ///< Fraction of the readings that are disturbed, as by a passer-by.
  unsigned seed = 1;
};

/// Gain at a position in a projector's picture, 0 to 1 in each dimension; brighter in the centre.
inline double gain_at(double u, double v) { return 1.0 - 0.8 * ((u - 0.5) * (u - 0.5) + (v - 0.5) * (v - 0.5)); }

/// Adds a view of a projector of 12 * 8 cells with its ramps. The others show black, with their black level.
inline void add_view(const std::vector<EvenLight>& lights, std::size_t projector, photometry::PhotometryInput* input) {
  const EvenLight& light = lights[projector];
  const calibration::MeasuredMap& map = input->projectors[projector].map;
  photometry::ProjectorView view;
  view.projector = projector;
  view.cells.width_px = map.width_px;
  view.cells.height_px = map.height_px;
  view.cells.cells_x = 12;
  view.cells.cells_y = 8;
  view.cells.cell_of = Image<std::int32_t, 1>(input->camera_width_px, input->camera_height_px, -1);
  std::vector<double> gains;
  std::vector<std::array<double, 3>> leaks;  // Black levels of the others, per channel.
  std::vector<photometry::InverseMap> inverses;
  for (const photometry::PhotometricProjector& other : input->projectors)
    inverses.push_back(*photometry::InverseMap::make(other.map));
  for (int y = 0; y < 8; ++y) {
    for (int x = 0; x < 12; ++x) {
      const double u = (x + 0.5) / 12.0;
      const double v = (y + 0.5) / 8.0;
      photometry::CameraCells::Cell cell;
      cell.pixels = 100;
      cell.projector_px = {u * map.width_px, v * map.height_px};
      cell.camera_px = {(0.1 + 0.8 * u) * input->camera_width_px, (0.1 + 0.8 * v) * input->camera_height_px};
      view.cells.cells.push_back(cell);
      gains.push_back(gain_at(u, v));
      leaks.push_back({});
      for (std::size_t p = 0; p < lights.size(); ++p) {
        const auto direction = map.direction_at(cell.projector_px);
        const auto pixel = p == projector || !direction ? std::nullopt : inverses[p].pixel_at(*direction);
        if (!pixel) continue;
        const double gain = gain_at(pixel->x() / map.width_px, pixel->y() / map.height_px);
        for (std::size_t c = 0; c < 3; ++c)
          leaks.back().at(c) += gain * lights[p].brightness * lights[p].channel_light.at(c) * lights[p].black_level;
      }
    }
  }
  std::mt19937 random(light.seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> even;
  const auto read = [&](structured_light::PatternLight which, double level, double exposure) {
    photometry::LightReading reading;
    reading.light = which;
    reading.level = level;
    reading.exposure_s = 0.02 * exposure;
    for (std::size_t cell = 0; cell < gains.size(); ++cell) {
      const double gain = gains[cell];
      photometry::CellCode code;
      const double shade = even(random) < light.disturbed ? 0.5 : 1.0;
      for (std::size_t k = 0; k < 3; ++k) {
        double seen = light.ambient;
        for (std::size_t c = 0; c < 3; ++c) {
          const bool is_on = which == structured_light::PatternLight::kAll ||
                             (which == structured_light::PatternLight::kRed && c == 0) ||
                             (which == structured_light::PatternLight::kGreen && c == 1) ||
                             (which == structured_light::PatternLight::kBlue && c == 2);
          const double share = (k == c ? 1.0 : 0.1) * light.brightness * light.channel_light.at(c);
          const double shone = is_on ? light.projector.at(c)(level) : 0.0;
          seen += gain * share * (light.black_level + (1.0 - light.black_level) * shone) +
                  (k == c ? 1.0 : 0.1) * leaks[cell].at(c);
        }
        double value = light.camera(std::min(1.0, shade * seen * exposure + light.pedestal));
        value += light.noise * normal(random);
        const double steps = light.bits > 0 ? (1 << light.bits) - 1 : 0;
        if (light.bits > 0) value = std::round(value * steps) / steps;
        code.code.at(k) = static_cast<float>(std::clamp(value, 0.0, 1.0));
        code.spread.at(k) = static_cast<float>(light.noise * 10.0);
        code.is_clipped.at(k) = value > 0.98;
      }
      reading.codes.push_back(code);
    }
    view.readings.push_back(std::move(reading));
  };
  for (const double exposure : light.black_exposures) read(structured_light::PatternLight::kAll, 0.0, exposure);
  for (const double exposure : light.exposures) {
    read(structured_light::PatternLight::kAll, 1.0, exposure);
    for (const structured_light::PatternLight which :
         {structured_light::PatternLight::kRed, structured_light::PatternLight::kGreen,
          structured_light::PatternLight::kBlue}) {
      for (int i = 1; i < light.steps; ++i)
        read(which, photometry::as_shown(static_cast<double>(i) / (light.steps - 1)), exposure);
    }
  }
  input->views.push_back(std::move(view));
}

/// Input for one projector, or for two side by side whose pictures overlap by 10 of 40 degrees.
inline photometry::PhotometryInput even_light(const std::vector<EvenLight>& lights) {
  photometry::PhotometryInput input;
  input.camera_width_px = 400;
  input.camera_height_px = 300;
  input.code_step = 1.0 / 4095.0;
  constexpr double kDegree = std::numbers::pi / 180.0;
  for (std::size_t p = 0; p < lights.size(); ++p) {
    const double pan = 30.0 * kDegree * (static_cast<double>(p) - 0.5 * static_cast<double>(lights.size() - 1));
    input.projectors.push_back({p == 0 ? "left" : "right", far_map(320, 200, 40.0 * kDegree, pan)});
    if (lights[p].bits > 0) input.code_step = 1.0 / ((1 << lights[p].bits) - 1);
  }
  for (std::size_t p = 0; p < lights.size(); ++p) add_view(lights, p, &input);
  return input;
}

}  // namespace cyclorama
