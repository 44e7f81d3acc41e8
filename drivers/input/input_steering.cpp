// SPDX-License-Identifier: Apache-2.0
#include "drivers/input/input_steering.h"

#include <linux/input-event-codes.h>

#include <algorithm>
#include <cmath>

namespace cyclorama::input {
namespace {

constexpr double kDead = 0.15;      // Dead zone, as a fraction of a stick's travel: worn sticks rest off centre.
constexpr double kCapFull = 350.0;  // Value that 3D mice report at full deflection of the cap.
constexpr double kCapDead = 0.08;
constexpr std::int32_t kPress = 1;  // 2 repeats a key that is held.

/// Returns 0 up to `dead`, then a gentle increase.
double gentle(double deflection, double dead) {
  const double u = std::clamp((std::abs(deflection) - dead) / (1.0 - dead), 0.0, 1.0);
  return std::copysign(u * u * (3.0 - 2.0 * u), deflection);
}

bool has(const InputDescription& description, std::initializer_list<int> axes) {
  return std::all_of(axes.begin(), axes.end(), [&](int axis) { return description.absolute.contains(axis); });
}

struct StepKeys {
  int next;
  int previous;
  int language;
};
StepKeys step_keys(InputKind kind) {
  switch (kind) {
    case InputKind::kGamepad:
      return {BTN_TR, BTN_TL, BTN_NORTH};
    case InputKind::kKeyboard:
      return {KEY_PAGEDOWN, KEY_PAGEUP, KEY_L};
    case InputKind::kSpaceMouse:
      break;
  }
  return {BTN_1, BTN_0, KEY_RESERVED};
}

}  // namespace

std::optional<InputKind> kind_of(const InputDescription& description) {
  const auto& keys = description.keys;
  if (has(description, {ABS_X, ABS_Y, ABS_RX}) && (keys.contains(BTN_GAMEPAD) || keys.contains(BTN_JOYSTICK)))
    return InputKind::kGamepad;
  const bool relative_cap = description.relative.contains(REL_RX) && description.relative.contains(REL_RZ);
  if (relative_cap || has(description, {ABS_X, ABS_Y, ABS_Z, ABS_RX, ABS_RY, ABS_RZ})) return InputKind::kSpaceMouse;
  if (keys.contains(KEY_UP) && keys.contains(KEY_LEFT) && keys.contains(KEY_W)) return InputKind::kKeyboard;
  if (keys.contains(KEY_F1) || keys.contains(KEY_HELP)) return InputKind::kKeyboard;
  return std::nullopt;
}

const char* to_text(InputKind kind) {
  switch (kind) {
    case InputKind::kGamepad:
      return "gamepad";
    case InputKind::kKeyboard:
      return "keyboard";
    case InputKind::kSpaceMouse:
      break;
  }
  return "3D mouse";
}

void InputSteering::take(const InputEvent& event, TimePoint at) {
  switch (event.type) {
    case EV_KEY:
      if (event.value == 0) pressed_.erase(event.code);
      if (event.value == kPress && (event.code == KEY_F1 || event.code == KEY_HELP)) ++help_presses_;
      if (event.value != 0 && description_.keys.contains(event.code)) {
        const bool is_new = pressed_.insert(event.code).second;
        if (is_new && event.code == step_keys(kind_).next) ++steps_;
        if (is_new && event.code == step_keys(kind_).previous) --steps_;
        if (is_new && event.code == step_keys(kind_).language) ++languages_;
      }
      break;
    case EV_ABS:
      if (description_.absolute.contains(event.code)) absolute_[event.code] = event.value;
      break;
    case EV_REL:
      if (description_.relative.contains(event.code)) relative_[event.code] = {event.value, at};
      break;
    default:
      break;
  }
}

double InputSteering::stick(int code) const {
  const auto at = absolute_.find(code);
  const auto range = description_.absolute.find(code);
  if (at == absolute_.end() || range == description_.absolute.end()) return 0.0;
  const double half = 0.5 * (double{1} * range->second.max - range->second.min);
  if (!(half > 0.0)) return 0.0;
  return gentle((at->second - (range->second.min + half)) / half, kDead);
}

double InputSteering::cap(int relative, int absolute, TimePoint now) const {
  if (const auto moved = relative_.find(relative); moved != relative_.end()) {
    const bool held = now - moved->second.at <= kRelativeHeld;
    return held ? gentle(std::clamp(moved->second.value / kCapFull, -1.0, 1.0), kCapDead) : 0.0;
  }
  const auto at = absolute_.find(absolute);
  const auto range = description_.absolute.find(absolute);
  if (at == absolute_.end() || range == description_.absolute.end()) return 0.0;
  // The rest position is 0, even if the limits are asymmetric.
  const double full = std::max({std::abs(double{1} * range->second.min), std::abs(double{1} * range->second.max), 1.0});
  return gentle(std::clamp(at->second / full, -1.0, 1.0), kCapDead);
}

double InputSteering::keys(std::initializer_list<int> forth, std::initializer_list<int> back) const {
  const auto any = [&](std::initializer_list<int> codes) {
    return std::any_of(codes.begin(), codes.end(), [&](int code) { return pressed_.contains(code); });
  };
  return (any(forth) ? 1.0 : 0.0) - (any(back) ? 1.0 : 0.0);
}

InputCommand InputSteering::command(TimePoint now) const {
  switch (kind_) {
    case InputKind::kGamepad:
      return {-stick(ABS_Y), stick(ABS_X), stick(ABS_RX)};
    case InputKind::kKeyboard:
      return {keys({KEY_UP, KEY_W}, {KEY_DOWN, KEY_S}), keys({KEY_D}, {KEY_A}),
              keys({KEY_RIGHT, KEY_E}, {KEY_LEFT, KEY_Q})};
    case InputKind::kSpaceMouse:
      break;
  }
  return {-cap(REL_Y, ABS_Y, now), cap(REL_X, ABS_X, now), cap(REL_RZ, ABS_RZ, now)};
}

}  // namespace cyclorama::input
