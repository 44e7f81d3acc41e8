// SPDX-License-Identifier: Apache-2.0
#include "drivers/devices/make_turntable.h"

#include <fmt/format.h>

#include <optional>
#include <utility>

#include "common/base/text.h"
#include "drivers/devices/device_line.h"
#include "drivers/turntable/manual/manual_turntable.h"
#include "drivers/turntable/serial/serial_turntable.h"

namespace cyclorama::devices {
namespace {

using turntable::SerialTurntable;
using turntable::SerialTurntableOptions;

constexpr double kDegree = std::numbers::pi / 180.0;

Error refuse(std::string_view spec, std::string_view what) {
  return Error(ErrorCode::kInvalidArgument, fmt::format("turntable '{}': {}", printable(spec, 200), what));
}

/// Returns whether `key` is known and its value is valid.
bool take(std::string_view key, std::string_view value, SerialTurntableOptions* ret) {
  if (key == "axis") {
    if (value.size() != 1) return false;
    ret->axis = value[0];
    return true;
  }
  const auto number = parse_double(value);
  if (!number) return false;
  if (key == "baud") {
    if (!(*number >= 1.0 && *number <= 1e7)) return false;
    ret->baud = static_cast<int>(*number);
  } else if (key == "units_per_turn") {
    ret->units_per_turn = *number;
  } else if (key == "degrees_per_second") {
    ret->speed_rad_s = *number * kDegree;
  } else if (key == "min_deg") {
    ret->range.min_rad = *number * kDegree;
  } else if (key == "max_deg") {
    ret->range.max_rad = *number * kDegree;
  } else {
    return false;
  }
  return true;
}

/// Returns the current name of an option whose former name is `key`; empty for any other key.
std::string_view renamed_to(std::string_view key) {
  if (key == "least_deg") return "min_deg";  // Renamed.
  if (key == "most_deg") return "max_deg";   // Renamed.
  return {};
}

/// Parses the line; returns no options for a manual turntable.
Result<std::optional<SerialTurntableOptions>> parse(std::string_view spec) {
  std::string_view rest = spec;
  const std::string_view kind = cut(&rest, ':');
  if (kind == "manual" && rest.empty()) return std::optional<SerialTurntableOptions>();
  if (kind != "serial") return refuse(spec, "no such kind of turntable; the kinds are serial:DEVICE and manual");
  SerialTurntableOptions options;
  options.device = std::string(cut(&rest, '?'));
  if (options.device.empty()) return refuse(spec, "names no device; write serial:/dev/serial/by-id/...");
  while (!rest.empty()) {
    std::string_view value = cut(&rest, '&');
    const std::string_view key = cut(&value, '=');
    if (const std::string_view renamed = renamed_to(key); !renamed.empty()) {
      return refuse(spec, fmt::format("'{}' is now called '{}'; rename it", key, renamed));
    }
    if (!take(key, value, &options)) {
      return refuse(spec, fmt::format("'{}' is wrong; the options are baud, axis (one letter), units_per_turn, "
                                      "degrees_per_second, min_deg and max_deg",
                                      printable(key)));
    }
  }
  return std::optional(std::move(options));
}

}  // namespace

Status check_turntable(std::string_view spec) {
  TRY_ASSIGN(const std::optional<SerialTurntableOptions> options, parse(spec));
  return options ? SerialTurntable::check(*options) : Status(Done{});
}

Result<std::unique_ptr<turntable::Turntable>> make_turntable(
    std::string_view spec, std::unique_ptr<turntable::TurntableOperator> operated_by) {
  TRY_ASSIGN(const std::optional<SerialTurntableOptions> options, parse(spec));
  if (options) return SerialTurntable::open(*options);
  return std::unique_ptr<turntable::Turntable>(std::make_unique<turntable::ManualTurntable>(std::move(operated_by)));
}

}  // namespace cyclorama::devices
