// SPDX-License-Identifier: Apache-2.0
#include "appliance/tracker/interchange/osc_pose.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>

namespace cyclorama::tracker {
namespace {

constexpr std::string_view kPose = "/cyclorama/pose";
constexpr std::string_view kLost = "/cyclorama/lost";
constexpr std::string_view kSteer = "/cyclorama/steer";
constexpr std::string_view kStop = "/cyclorama/stop";
constexpr std::string_view kCaptions = "/cyclorama/captions";
constexpr std::size_t kPoseArguments = 10;
constexpr std::size_t kLostArguments = 3;

/// Returns every argument as a number; empty if any of them is not a number.
std::vector<double> numbers_of(const OscMessage& message) {
  std::vector<double> numbers;
  for (std::size_t i = 0; i < message.arguments.size(); ++i) {
    const std::optional<double> number = message.number(i);
    if (!number) return {};
    numbers.push_back(*number);
  }
  return numbers;
}

/// Returns an argument as an integer. Integers are not converted to double, whose precision a time in nanoseconds
/// exceeds.
std::optional<std::int64_t> whole(const OscMessage& message, std::size_t index) {
  if (const auto* const value = std::get_if<std::int64_t>(&message.arguments[index])) return *value;
  if (const auto* const value = std::get_if<std::int32_t>(&message.arguments[index])) return *value;
  const auto value = message.number(index);
  constexpr double kMaxMilliseconds = 9e15;
  if (!value || !(std::abs(*value) <= kMaxMilliseconds)) return std::nullopt;
  return static_cast<std::int64_t>(*value);
}

}  // namespace

OscMessage to_osc(const PoseReport& report) {
  OscMessage message{std::string(report.found ? kPose : kLost),
                     {report.sensor, static_cast<std::int64_t>(report.sequence), report.time_ns}};
  if (!report.found) return message;
  for (const double value : report.position_m) message.arguments.emplace_back(value);
  for (const double value : report.rotation) message.arguments.emplace_back(value);
  return message;
}

std::optional<PoseReport> pose_from_osc(const OscMessage& message) {
  const bool found = message.address == kPose;
  if (!found && message.address != kLost) return std::nullopt;
  const std::vector<double> numbers = numbers_of(message);
  if (numbers.size() != (found ? kPoseArguments : kLostArguments)) return std::nullopt;
  const auto sensor = whole(message, 0);
  const auto sequence = whole(message, 1);
  const auto time_ns = whole(message, 2);
  if (!sensor || !sequence || !time_ns || *sensor < std::numeric_limits<std::int32_t>::min() ||
      *sensor > std::numeric_limits<std::int32_t>::max())
    return std::nullopt;
  PoseReport report;
  report.sensor = static_cast<std::int32_t>(*sensor);
  report.sequence = static_cast<std::uint64_t>(*sequence);
  report.time_ns = *time_ns;
  report.found = found;
  if (!found) return report;
  std::copy_n(numbers.begin() + 3, report.position_m.size(), report.position_m.begin());
  std::copy_n(numbers.begin() + 6, report.rotation.size(), report.rotation.begin());
  return report;
}

std::optional<OscStop> stop_from_osc(const OscMessage& message) {
  if (message.address != kStop || message.arguments.size() != 1) return std::nullopt;
  if (const auto* const name = std::get_if<std::string>(&message.arguments.front())) return *name;
  const auto step = message.number(0);
  if (!step || (*step != 1.0 && *step != -1.0)) return std::nullopt;
  return static_cast<int>(*step);
}

std::optional<OscCaptions> captions_from_osc(const OscMessage& message) {
  constexpr std::size_t kMaxLanguages = 2;
  if (message.address != kCaptions || message.arguments.size() > kMaxLanguages) return std::nullopt;
  if (message.arguments.size() == 1 && message.number(0) == 1.0) return OscCaptions{};
  OscCaptions captions{std::vector<std::string>()};
  for (const auto& argument : message.arguments) {
    const auto* const tag = std::get_if<std::string>(&argument);
    if (tag == nullptr) return std::nullopt;
    captions.languages->push_back(*tag);
  }
  return captions;
}

std::optional<std::array<double, 3>> steer_from_osc(const OscMessage& message) {
  if (message.address != kSteer) return std::nullopt;
  const std::vector<double> numbers = numbers_of(message);
  std::array<double, 3> command{};
  if (numbers.size() != command.size()) return std::nullopt;
  for (std::size_t i = 0; i < command.size(); ++i) {
    if (std::isnan(numbers[i])) return std::nullopt;
    command[i] = std::clamp(numbers[i], -1.0, 1.0);
  }
  return command;
}

}  // namespace cyclorama::tracker
