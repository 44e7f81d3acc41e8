// SPDX-License-Identifier: Apache-2.0
#include "drivers/turntable/serial/serial_turntable.h"

#include <fmt/format.h>

#include <cmath>

namespace cyclorama::turntable {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr double kDegree = std::numbers::pi / 180.0;

}  // namespace

SerialTurntable::SerialTurntable(SerialPort port, const SerialTurntableOptions& options)
    : Turntable(options.range), port_(std::move(port)), options_(options), id_("serial:" + options.device.string()) {}

Status SerialTurntable::check(const SerialTurntableOptions& o) {
  const auto refuse = [](const char* what) { return Error(ErrorCode::kInvalidArgument, what); };
  if (o.axis < 'A' || o.axis > 'Z') return refuse("a turntable's axis is one upper-case letter");
  if (!(std::abs(o.units_per_turn) >= 1.0 && std::abs(o.units_per_turn) <= 1e6))
    return refuse("a turntable has 1 to 1000000 units per turn");
  if (!(o.range.min_rad <= 0.0 && o.range.max_rad >= 0.0 && o.range.max_rad - o.range.min_rad <= 4.0 * kTurn))
    return refuse("a turntable's range holds 0, where its home is, and four turns at most");
  if (!(o.speed_rad_s > 1e-3 && o.speed_rad_s < 100.0)) return refuse("a turntable's speed is 0.001 to 100 rad/s");
  if (!(o.tolerance_rad > 0.0)) return refuse("a turntable's tolerance is above 0");
  return Done{};
}

Result<std::unique_ptr<Turntable>> SerialTurntable::open(const SerialTurntableOptions& options) {
  TRY(check(options));
  TRY_ASSIGN(SerialPort port, SerialPort::open(options.device, options.baud));
  std::unique_ptr<SerialTurntable> turntable(new SerialTurntable(std::move(port), options));
  if (auto awake = turntable->wake(); !awake)
    return std::move(awake).error().while_doing(fmt::format("turntable '{}'", turntable->id_));
  return std::unique_ptr<Turntable>(std::move(turntable));
}

Status SerialTurntable::wake() {
  // A controller that resets when its line is opened sends a greeting and may lose the first command, so the command is
  // sent twice.
  const auto half = options_.answer_timeout / 2;
  if (say("G90", half)) return Done{};
  return say("G90", options_.answer_timeout);
}

Status SerialTurntable::say(std::string_view command, std::chrono::milliseconds timeout,
                            std::optional<double>* ret_position) {
  using Kind = gcode::Answer::Kind;
  constexpr int kMaxResends = 3;
  const SteadyClock clock;
  const TimePoint last = clock.now() + timeout;
  int resends = 0;
  port_.forget_input();  // A late answer to an abandoned command would be taken for the answer to this one.
  TRY(port_.write_line(command, last));
  TimePoint answer_deadline = std::min(last, clock.now() + options_.answer_timeout);
  if (command == "M400" || command.starts_with("G28"))
    answer_deadline = last;  // Not every firmware reports that it is busy.
  for (;;) {
    TRY_ASSIGN(const std::string line, port_.read_line(answer_deadline));
    const gcode::Answer answer = gcode::parse_answer(line, options_.axis);
    switch (answer.kind) {
      case Kind::kOk:
        return Done{};
      case Kind::kPosition:
        if (ret_position != nullptr) *ret_position = answer.position;
        break;
      case Kind::kBusy:
        answer_deadline = std::min(last, clock.now() + options_.answer_timeout);
        break;
      case Kind::kError:
        return Error(ErrorCode::kBadData, fmt::format("it answers '{}' to {}", answer.text, command));
      case Kind::kRestart:
        return Error(ErrorCode::kTimedOut, "it was reset and has lost its position; look at its power supply");
      case Kind::kResend:
        if (++resends > kMaxResends)
          return Error(ErrorCode::kBadData, "it does not get lines whole; look at the cable and the baud rate");
        TRY(port_.write_line(command, last));
        break;
      case Kind::kChatter:
        break;
    }
  }
}

Status SerialTurntable::find_step() {
  port_.forget_input();
  const TimePoint deadline = SteadyClock().now() + options_.answer_timeout;
  TRY(port_.write_line("M114", deadline));
  bool has_position = false;
  for (;;) {
    auto line = port_.read_line(deadline);
    if (!line) return std::move(line).error();
    const gcode::Answer::Kind kind = gcode::parse_answer(*line, options_.axis).kind;
    if (kind == gcode::Answer::Kind::kPosition) has_position = true;
    if (kind == gcode::Answer::Kind::kOk && has_position) return Done{};
  }
}

Status SerialTurntable::move_home() {
  TRY(find_step());
  TRY(say("G90", options_.answer_timeout));
  TRY(say(gcode::home_command(options_.axis), options_.home_timeout));
  last_angle_rad_ = 0.0;
  // The home switch may be beside 0: G28 finds the switch, then the axis moves to 0.
  return move_to(0.0);
}

Status SerialTurntable::move_to(double angle_rad) {
  const double units_per_rad = options_.units_per_turn / kTurn;
  const double speed = options_.speed_rad_s * std::abs(units_per_rad) * 60.0;
  TRY(say(gcode::go_command(options_.axis, angle_rad * units_per_rad, speed), options_.answer_timeout));
  // Twice the nominal time, to allow for acceleration and slow controllers.
  const double way_s = 2.0 * std::abs(angle_rad - last_angle_rad_) / options_.speed_rad_s;
  TRY(say("M400", options_.answer_timeout + std::chrono::milliseconds(std::lround(1e3 * way_s))));
  TRY_ASSIGN(const double stands, ask_angle());
  if (!(std::abs(stands - angle_rad) <= options_.tolerance_rad)) {
    return Error(ErrorCode::kTimedOut,
                 fmt::format("it stands at {:.2f} degrees instead of {:.2f}: it is blocked or has "
                             "slipped",
                             stands / kDegree, angle_rad / kDegree));
  }
  last_angle_rad_ = angle_rad;
  return Done{};
}

Result<double> SerialTurntable::ask_angle() {
  std::optional<double> position;
  TRY(say("M114", options_.answer_timeout, &position));
  if (!position) {
    return Error(ErrorCode::kBadData,
                 fmt::format("it does not say where axis {} is; is that its letter?", options_.axis));
  }
  return *position * kTurn / options_.units_per_turn;
}

}  // namespace cyclorama::turntable
