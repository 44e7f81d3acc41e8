// SPDX-License-Identifier: Apache-2.0
#include "appliance/structured_light/pattern_set.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <locale>
#include <sstream>

#include "common/base/text.h"

namespace cyclorama::structured_light {
namespace {

constexpr int kMaxPx = 16384;
constexpr std::array kKinds = {"white", "black", "bit", "phase", "level"};
constexpr std::array kAxes = {"column", "row"};
constexpr std::array kLights = {"all", "red", "green", "blue"};
constexpr std::size_t kMaxPictures = 4096;

Error bad(const std::string& message) { return {ErrorCode::kInvalidArgument, message}; }

Status check_size(int width_px, int height_px) {
  if (width_px < 1 || width_px > kMaxPx || height_px < 1 || height_px > kMaxPx) {
    return bad("a projector's picture is 1 to 16384 pixels each way, not " + std::to_string(width_px) + "x" +
               std::to_string(height_px));
  }
  return Done{};
}

void add_axis(PatternAxis axis, int pixels, const PatternChoice& choice, std::vector<PatternPicture>* pictures) {
  for (int bit = bits_for(pixels) - 1; bit >= choice.finest_bit; --bit) {
    for (const bool is_inverse : {false, true}) {
      pictures->push_back({.kind = PatternKind::kBit, .axis = axis, .bit = bit, .is_inverse = is_inverse});
    }
  }
  for (int step = 0; step < choice.phase_steps; ++step) {
    pictures->push_back({.kind = PatternKind::kPhase, .axis = axis, .step = step});
  }
}

template <std::size_t N>
int place_of(const std::array<const char*, N>& names, const std::string& name) {
  for (std::size_t i = 0; i < N; ++i) {
    if (name == names[i]) return static_cast<int>(i);
  }
  return -1;
}

/// Parses a picture's line: "kind axis bit pattern|inverse step level light".
Result<PatternPicture> read_picture(std::istringstream* words) {
  std::string kind, axis, bit, inverse, step, level, light, more;
  *words >> kind >> axis >> bit >> inverse >> step >> level >> light;
  const int kind_place = place_of(kKinds, kind);
  const int axis_position = place_of(kAxes, axis);
  const int light_place = place_of(kLights, light);
  const auto bit_value = parse_integer(bit);
  const auto step_value = parse_integer(step);
  const auto level_value = parse_double(level);
  if (kind_place < 0 || axis_position < 0 || light_place < 0 || (inverse != "pattern" && inverse != "inverse") ||
      (*words >> more) || !bit_value || *bit_value < 0 || *bit_value > 13 || !step_value || *step_value < 0 ||
      *step_value > 255 || !level_value || !(*level_value >= 0.0 && *level_value <= 1.0)) {
    return Error(ErrorCode::kBadData, "expected 'KIND AXIS BIT pattern|inverse STEP LEVEL LIGHT'");
  }
  return PatternPicture{.kind = static_cast<PatternKind>(kind_place),
                        .axis = static_cast<PatternAxis>(axis_position),
                        .bit = static_cast<int>(*bit_value),
                        .is_inverse = inverse == "inverse",
                        .step = static_cast<int>(*step_value),
                        .level = *level_value,
                        .light = static_cast<PatternLight>(light_place)};
}

/// Parses the first line: "patterns 1 WIDTHxHEIGHT base BIT phase PERIOD STEPS".
Result<PatternSet> read_head(const std::string& line) {
  std::istringstream words(line);
  std::string magic, version, width, height, base_word, base, phase_word, period, steps, more;
  words >> magic >> version >> width >> height >> base_word >> base >> phase_word >> period >> steps;
  const auto width_value = parse_integer(width);
  const auto height_value = parse_integer(height);
  const auto base_value = parse_integer(base);
  const auto period_value = parse_double(period);
  const auto steps_value = parse_integer(steps);
  if (magic != "patterns" || version != "1" || base_word != "base" || phase_word != "phase" || (words >> more) ||
      !width_value || *width_value < 1 || *width_value > kMaxPx || !height_value || *height_value < 1 ||
      *height_value > kMaxPx || !base_value || *base_value < -1 || *base_value > 13 || !period_value ||
      !(*period_value >= 0.0 && *period_value <= kMaxPx) || !steps_value || *steps_value < 0 || *steps_value > 256) {
    return Error(ErrorCode::kBadData, "line 1: expected 'patterns 1 WIDTH HEIGHT base BIT phase PERIOD STEPS'");
  }
  PatternSet set;
  set.width_px = static_cast<int>(*width_value);
  set.height_px = static_cast<int>(*height_value);
  set.base_bit = static_cast<int>(*base_value);
  set.phase_period_px = *period_value;
  set.phase_steps = static_cast<int>(*steps_value);
  return set;
}

}  // namespace

int bits_for(int pixels) {
  int bits = 1;
  while ((1 << bits) < pixels) ++bits;
  return bits;
}

Result<PatternSet> structured_light(const PatternChoice& choice) {
  TRY(check_size(choice.width_px, choice.height_px));
  const int bits = std::min(bits_for(choice.width_px), bits_for(choice.height_px));
  if (choice.finest_bit < 0 || choice.finest_bit >= bits) {
    return bad("finest_bit is 0 to " + std::to_string(bits - 1) + " for this projector, not " +
               std::to_string(choice.finest_bit));
  }
  if (choice.base_bit != -1 && (choice.base_bit < choice.finest_bit || choice.base_bit >= bits)) {
    return bad("base_bit is -1, or one of the bits shown, not " + std::to_string(choice.base_bit));
  }
  const bool has_phases = choice.phase_steps != 0 || choice.phase_period_px != 0.0;
  const int stripe = 2 << choice.finest_bit;
  if (has_phases && (choice.phase_steps < 3 || choice.phase_steps > 256 || !(choice.phase_period_px >= 2.0 * stripe) ||
                     !(choice.phase_period_px <= kMaxPx))) {
    // The bits must distinguish periods, and their position is uncertain by a stripe.
    return bad("phases need 3 to 256 steps, and a period of " + std::to_string(2 * stripe) + " to 16384 pixels");
  }
  PatternSet set;
  set.width_px = choice.width_px;
  set.height_px = choice.height_px;
  set.base_bit = choice.base_bit;
  set.phase_period_px = choice.phase_period_px;
  set.phase_steps = choice.phase_steps;
  set.pictures.push_back({.kind = PatternKind::kWhite});
  set.pictures.push_back({.kind = PatternKind::kBlack, .level = 0.0});
  add_axis(PatternAxis::kColumns, choice.width_px, choice, &set.pictures);
  add_axis(PatternAxis::kRows, choice.height_px, choice, &set.pictures);
  return set;
}

Result<PatternSet> ramps(int width_px, int height_px, int steps, const std::vector<PatternLight>& lights) {
  TRY(check_size(width_px, height_px));
  if (steps < 2 || steps > 256) return bad("a ramp has 2 to 256 steps, not " + std::to_string(steps));
  PatternSet set;
  set.width_px = width_px;
  set.height_px = height_px;
  for (const PatternLight light : lights) {
    for (int i = 0; i < steps; ++i) {
      set.pictures.push_back(
          {.kind = PatternKind::kLevel, .level = static_cast<double>(i) / (steps - 1), .light = light});
    }
  }
  return set;
}

std::string name_of(const PatternPicture& picture) {
  const std::string axis = kAxes.at(static_cast<std::size_t>(picture.axis));
  switch (picture.kind) {
    case PatternKind::kWhite:
      return "white";
    case PatternKind::kBlack:
      return "black";
    case PatternKind::kBit:
      return axis + " bit " + std::to_string(picture.bit) + (picture.is_inverse ? ", inverse" : "");
    case PatternKind::kPhase:
      return axis + " phase " + std::to_string(picture.step);
    case PatternKind::kLevel:
      return std::string(kLights.at(static_cast<std::size_t>(picture.light))) + " at " +
             std::to_string(std::lround(100.0 * picture.level)) + " %";
  }
  return "";
}

std::string to_text(const PatternSet& set) {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text.precision(17);
  text << "patterns 1 " << set.width_px << ' ' << set.height_px << " base " << set.base_bit << " phase "
       << set.phase_period_px << ' ' << set.phase_steps << '\n';
  for (const PatternPicture& picture : set.pictures) {
    text << kKinds.at(static_cast<std::size_t>(picture.kind)) << ' ' << kAxes.at(static_cast<std::size_t>(picture.axis))
         << ' ' << picture.bit << ' ' << (picture.is_inverse ? "inverse" : "pattern") << ' ' << picture.step << ' '
         << picture.level << ' ' << kLights.at(static_cast<std::size_t>(picture.light)) << '\n';
  }
  return text.str();
}

Result<PatternSet> read_pattern_set(const std::string& text) {
  std::istringstream lines(text);
  std::string line;
  std::getline(lines, line);
  TRY_ASSIGN(PatternSet set, read_head(line));
  for (int number = 2; std::getline(lines, line); ++number) {
    std::istringstream words(line);
    auto picture = read_picture(&words);
    if (!picture) return std::move(picture).error().while_doing("line " + std::to_string(number));
    // A phase without a period cannot be drawn.
    if (picture->kind == PatternKind::kPhase && (set.phase_steps < 3 || !(set.phase_period_px >= 4.0))) {
      return Error(ErrorCode::kBadData,
                   "line " + std::to_string(number) + ": a phase, but line 1 has no period and steps");
    }
    if (set.pictures.size() == kMaxPictures) return Error(ErrorCode::kBadData, "more than 4096 pictures");
    set.pictures.push_back(*picture);
  }
  return set;
}

}  // namespace cyclorama::structured_light
