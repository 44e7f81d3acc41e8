// SPDX-License-Identifier: Apache-2.0
#include "appliance/photometry/ramp_blocks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <string>

namespace cyclorama::photometry {
namespace {

constexpr std::size_t kCellsPerProjector = 90;
constexpr int kMinPixels = 12;
/// Noise of a camera pixel with a read noise of 8 electrons and a full well of 10000, typical of machine vision.
constexpr double kReadNoise = 1e-3;
constexpr double kShotNoise = 1e-4;
/// Variation of lamps and shutters between photographs of the same light, which averaging over pixels does not reduce.
constexpr double kFloor = 1e-4;
/// Light below these fractions of the camera's full scale, or of the projector's brightest light, counts as none.
constexpr double kNoLight = 0.004;
constexpr double kNoShare = 0.02;

constexpr std::array<const char*, 4> kNames = {"red", "green", "blue", "white"};

int index_of(structured_light::PatternLight light) {
  switch (light) {
    case structured_light::PatternLight::kRed:
      return 0;
    case structured_light::PatternLight::kGreen:
      return 1;
    case structured_light::PatternLight::kBlue:
      return 2;
    case structured_light::PatternLight::kAll:
      return 3;
  }
  return 3;
}

bool has_ramps(const ProjectorView& view) {
  std::array<bool, 3> has_full{};
  std::array<bool, 3> has_between{};
  for (const LightReading& reading : view.readings) {
    const auto light = static_cast<std::size_t>(index_of(reading.light));
    if (light > 2) continue;
    has_full.at(light) |= reading.level == 1.0;
    has_between.at(light) |= reading.level > 0.0 && reading.level < 1.0;
  }
  return std::ranges::all_of(has_full, [](bool b) { return b; }) &&
         std::ranges::all_of(has_between, [](bool b) { return b; });
}

/// Brightness of a view in its best pair of photographs, full light and black at the same exposure.
struct Brightness {
  /// Per light: mean code above black, in the camera channel with the strongest signal.
  std::array<double, 4> light{};
  bool is_all_clipped = true;
};

double mean_code(const ProjectorView& view, const LightReading& reading, std::size_t channel, double* clipped) {
  double sum = 0.0;
  int pixels = 0;
  int lost = 0;
  for (std::size_t i = 0; i < reading.codes.size(); ++i) {
    const int n = view.cells.cells[i].pixels;
    if (n == 0) continue;
    if (reading.codes[i].is_clipped.at(channel)) {
      lost += n;
      continue;
    }
    sum += n * static_cast<double>(reading.codes[i].code.at(channel));
    pixels += n;
  }
  *clipped = lost + pixels > 0 ? static_cast<double>(lost) / (lost + pixels) : 1.0;
  return pixels > 0 ? sum / pixels : 0.0;
}

/// Returns the largest increase in code that each light causes.
Brightness brightness_of(const ProjectorView& view) {
  Brightness result;
  for (const LightReading& full : view.readings) {
    if (full.level != 1.0) continue;
    for (const LightReading& black : view.readings) {
      if (black.level != 0.0 || std::abs(black.exposure_s / full.exposure_s - 1.0) > 1e-9) continue;
      for (std::size_t k = 0; k < 3; ++k) {
        double clipped = 0.0;
        double clipped_black = 0.0;
        const double gain = mean_code(view, full, k, &clipped) - mean_code(view, black, k, &clipped_black);
        if (clipped > 0.5 || clipped_black > 0.5) continue;
        result.is_all_clipped = false;
        double& light = result.light.at(static_cast<std::size_t>(index_of(full.light)));
        light = std::max(light, gain);
      }
    }
  }
  return result;
}

Status check_lights(const ProjectorView& view, const std::string& name) {
  const Brightness brightness = brightness_of(view);
  if (brightness.is_all_clipped) {
    return Error(ErrorCode::kBadData,
                 fmt::format("projector '{}': no photograph of its full light can be compared with one of its black of "
                             "the same exposure; shorten the exposure or close the iris, and photograph both",
                             name));
  }
  const double max = std::max({brightness.light[0], brightness.light[1], brightness.light[2]});
  if (!(max > kNoLight)) {
    return Error(
        ErrorCode::kBadData,
        fmt::format("projector '{}' gives no light that the camera sees; look whether its lamp and its shutter "
                    "are open, or lengthen the exposure",
                    name));
  }
  for (std::size_t light = 0; light < 3; ++light) {
    if (brightness.light.at(light) > std::max(kNoLight, kNoShare * max)) continue;
    return Error(ErrorCode::kBadData,
                 fmt::format("projector '{}' gives no {} light; look after its cable, its picture mode and its {} "
                             "channel, then calibrate again",
                             name, kNames.at(light), kNames.at(light)));
  }
  return Done{};
}

/// Returns at most `max` cells, evenly spaced in the order of brightness.
std::vector<std::size_t> chosen_cells(const ProjectorView& view, std::size_t max) {
  const LightReading* reference = nullptr;
  for (const LightReading& reading : view.readings) {
    const bool is_full = reading.level == 1.0 && index_of(reading.light) == 1;
    if (is_full && (reference == nullptr || reading.exposure_s < reference->exposure_s)) reference = &reading;
  }
  std::vector<std::pair<float, std::size_t>> seen;
  for (std::size_t i = 0; i < view.cells.cells.size(); ++i) {
    if (view.cells.cells[i].pixels < kMinPixels) continue;
    seen.emplace_back(reference != nullptr ? reference->codes[i].code[1] : 0.0f, i);
  }
  std::ranges::sort(seen);
  std::vector<std::size_t> chosen;
  const std::size_t count = std::min(max, seen.size());
  for (std::size_t i = 0; i < count; ++i) chosen.push_back(seen[i * seen.size() / count].second);
  return chosen;
}

RampBlock block_of(const ProjectorView& view, std::size_t cell, std::size_t channel, const RampProblem& problem,
                   double min_exposure_s, double code_step) {
  RampBlock block;
  block.projector = view.projector;
  for (const LightReading& reading : view.readings) {
    const CellCode& code = reading.codes[cell];
    if (code.is_clipped.at(channel)) continue;
    RampReading r;
    r.code = static_cast<double>(code.code.at(channel));
    r.exposure = reading.exposure_s / min_exposure_s;
    r.sigma = code_sigma(code, channel, view.cells.cells[cell].pixels, code_step);
    if (reading.level > 0.0) {
      r.light = index_of(reading.light);
      const auto light = static_cast<std::size_t>(r.light);
      block.has_light.at(light) = true;
      if (reading.level < 1.0) {
        const auto& levels = problem.levels[view.projector].at(light);
        const auto at = std::ranges::lower_bound(levels, reading.level) - levels.begin();
        r.unknown = problem.first_unknown[view.projector].at(light) + static_cast<int>(at);
      }
    }
    block.readings.push_back(r);
  }
  return block;
}

/// True if the lit readings include exposures that differ by more than 5 %. Otherwise the camera's response cannot be
/// separated from the projectors'.
bool has_two_exposures(const std::vector<const ProjectorView*>& views) {
  std::set<double> exposures;
  for (const ProjectorView* view : views) {
    for (const LightReading& reading : view->readings) {
      if (reading.level > 0.0) exposures.insert(reading.exposure_s);
    }
  }
  return exposures.size() >= 2 && *exposures.rbegin() > 1.05 * *exposures.begin();
}

}  // namespace

double code_sigma(const CellCode& code, std::size_t channel, int pixels, double code_step) {
  const double n = std::max(pixels, 1);
  const double noise = (kReadNoise * kReadNoise + kShotNoise * static_cast<double>(code.code.at(channel))) / n;
  const double spread_steps = static_cast<double>(code.spread.at(channel)) / code_step;
  const double pi = std::numbers::pi;
  const double rounding = code_step / pi * std::exp(-2.0 * pi * pi * spread_steps * spread_steps);
  return std::sqrt(noise + rounding * rounding + kFloor * kFloor);
}

Result<RampProblem> ramp_problem(const PhotometryInput& input) {
  RampProblem problem;
  problem.levels.resize(input.projectors.size());
  problem.first_unknown.resize(input.projectors.size());
  std::vector<const ProjectorView*> views;
  std::vector<std::size_t> views_of(input.projectors.size(), 0);
  for (const ProjectorView& view : input.views) {
    if (!has_ramps(view)) continue;
    views.push_back(&view);
    ++views_of[view.projector];
  }
  double min_exposure_s = 0.0;
  for (const ProjectorView* view : views) {
    TRY(check_lights(*view, input.projectors[view->projector].name));
    for (const LightReading& reading : view->readings) {
      if (min_exposure_s == 0.0 || reading.exposure_s < min_exposure_s) min_exposure_s = reading.exposure_s;
      if (!(reading.level > 0.0 && reading.level < 1.0)) continue;
      auto& levels = problem.levels[view->projector].at(static_cast<std::size_t>(index_of(reading.light)));
      const auto at = std::ranges::lower_bound(levels, reading.level);
      if (at == levels.end() || *at != reading.level) levels.insert(at, reading.level);
    }
  }
  for (std::size_t i = 0; i < input.projectors.size(); ++i) {
    if (views_of[i] == 0) {
      return Error(ErrorCode::kInvalidArgument,
                   fmt::format("projector '{}': there is no ramp of its red, green and blue, up to full; photograph "
                               "one where the camera sees it best",
                               input.projectors[i].name));
    }
    for (std::size_t light = 0; light < 4; ++light) {
      problem.first_unknown[i].at(light) = problem.unknowns;
      problem.unknowns += static_cast<int>(problem.levels[i].at(light).size());
    }
  }
  if (!has_two_exposures(views)) {
    return Error(ErrorCode::kInvalidArgument,
                 "all ramps have one exposure, so the camera's own curve cannot be told from the projectors'; "
                 "photograph them with a second one, twice or three times as long");
  }
  const std::size_t channels = input.has_colour ? 3 : 1;
  for (const ProjectorView* view : views) {
    for (const std::size_t cell : chosen_cells(*view, kCellsPerProjector / views_of[view->projector] + 1)) {
      for (std::size_t k = 0; k < channels; ++k) {
        RampBlock block = block_of(*view, cell, k, problem, min_exposure_s, input.code_step);
        if (block.readings.size() >= 8) problem.blocks.push_back(std::move(block));
      }
    }
  }
  if (problem.blocks.empty()) {
    return Error(ErrorCode::kBadData,
                 "no part of the ramps was seen well; look whether the patterns of the same stop were decoded");
  }
  return problem;
}

}  // namespace cyclorama::photometry
