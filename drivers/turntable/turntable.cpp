// SPDX-License-Identifier: Apache-2.0
#include "drivers/turntable/turntable.h"

#include <fmt/format.h>

#include <numbers>

namespace cyclorama::turntable {
namespace {
constexpr double kDegree = std::numbers::pi / 180.0;
}

Error Turntable::failed(Error error) {
  state_ = error.code() == ErrorCode::kUnavailable ? State::kFailed : State::kUnhomed;
  return std::move(error).while_doing(fmt::format("turntable '{}'", id()));
}

Status Turntable::refuse_unless_ready() const {
  if (state_ == State::kFailed) {
    return Error(ErrorCode::kUnavailable, fmt::format("turntable '{}' is gone; plug it in and open it again", id()));
  }
  if (state_ == State::kUnhomed) {
    return Error(ErrorCode::kInvalidArgument,
                 fmt::format("turntable '{}' does not know its angle; home it first", id()));
  }
  return Done{};
}

Status Turntable::home() {
  if (state_ == State::kFailed) return refuse_unless_ready();
  state_ = State::kUnhomed;
  if (auto moved = move_home(); !moved) return failed(std::move(moved).error());
  state_ = State::kReady;
  return Done{};
}

Status Turntable::turn_to(double angle_rad) {
  TRY(refuse_unless_ready());
  if (!(angle_rad >= range_.min_rad && angle_rad <= range_.max_rad)) {
    return Error(ErrorCode::kInvalidArgument,
                 fmt::format("turntable '{}' turns from {:.1f} to {:.1f} degrees and not to {:.1f}", id(),
                             range_.min_rad / kDegree, range_.max_rad / kDegree, angle_rad / kDegree));
  }
  if (auto moved = move_to(angle_rad); !moved) return failed(std::move(moved).error());
  return Done{};
}

Result<double> Turntable::angle() {
  TRY(refuse_unless_ready());
  auto asked = ask_angle();
  if (!asked) return failed(std::move(asked).error());
  return asked;
}

}  // namespace cyclorama::turntable
