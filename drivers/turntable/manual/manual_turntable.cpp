// SPDX-License-Identifier: Apache-2.0
#include "drivers/turntable/manual/manual_turntable.h"

#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>

#include "common/base/text.h"

namespace cyclorama::turntable {
namespace {
constexpr double kDegree = std::numbers::pi / 180.0;
constexpr std::size_t kMaxLineLength = 256;
}  // namespace

Result<std::string> TerminalOperator::answer(const std::string& question, std::chrono::milliseconds timeout) {
  const SteadyClock clock;
  const TimePoint deadline = clock.now() + timeout;
  const Error nobody(ErrorCode::kUnavailable, "the operator's terminal is closed");
  for (std::string_view rest = question; !rest.empty();) {
    const ssize_t count = ::write(out_fd_, rest.data(), rest.size());
    if (count > 0) rest.remove_prefix(static_cast<std::size_t>(count));
    if (count <= 0 && errno != EINTR) return nobody;
  }
  for (;;) {
    if (const std::size_t end = read_.find('\n'); end != std::string::npos) {
      std::string line = read_.substr(0, end);
      read_.erase(0, end + 1);
      if (!line.empty() && line.back() == '\r') line.pop_back();
      return line;
    }
    if (read_.size() > kMaxLineLength) read_.clear();  // No person types such a long line.
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - clock.now()).count();
    pollfd entry{in_fd_, POLLIN, 0};
    const int ready = ::poll(&entry, 1, static_cast<int>(std::clamp<std::int64_t>(left, 0, 3'600'000)));
    if (ready == 0) return Error(ErrorCode::kTimedOut, "the operator does not answer");
    if (ready < 0) {
      if (errno == EINTR) continue;
      return Error::from_errno("waiting for the operator");
    }
    std::array<char, 128> bytes{};
    const ssize_t count = ::read(in_fd_, bytes.data(), bytes.size());
    if (count > 0) read_.append(bytes.data(), static_cast<std::size_t>(count));
    if (count == 0 || (count < 0 && errno != EINTR && errno != EAGAIN)) return nobody;
  }
}

ManualTurntable::ManualTurntable(std::unique_ptr<TurntableOperator> operated_by, TurnRange range,
                                 std::chrono::milliseconds timeout)
    : Turntable(range), operator_(std::move(operated_by)), timeout_(timeout) {}

Status ManualTurntable::ask_for(const std::string& what, double angle_rad) {
  std::string question = fmt::format("{}, then press Enter (or type the angle that it stands at; q to stop): ", what);
  for (;;) {
    const auto answered = operator_->answer(question, timeout_);
    if (!answered) return answered.error();
    const std::string_view line = *answered;
    if (line.empty()) {
      angle_rad_ = angle_rad;
      return Done{};
    }
    if (line == "q" || line == "Q") return Error(ErrorCode::kUnavailable, "the operator has stopped");
    const auto degrees = parse_double(line);
    if (degrees && *degrees * kDegree >= range().min_rad && *degrees * kDegree <= range().max_rad) {
      angle_rad_ = *degrees * kDegree;
      return Done{};
    }
    question = fmt::format("'{}' is no angle from {:.0f} to {:.0f} degrees. Again: ", printable(line),
                           range().min_rad / kDegree, range().max_rad / kDegree);
  }
}

Status ManualTurntable::move_home() { return ask_for("Turn the turntable to its mark, 0 degrees", 0.0); }

Status ManualTurntable::move_to(double angle_rad) {
  const double degrees = angle_rad / kDegree;
  const char* side = std::abs(degrees) < 0.05 ? "" : degrees > 0.0 ? " to the right of the mark" : " to the left";
  return ask_for(fmt::format("Turn the turntable to {:.1f} degrees{}", std::abs(degrees), side), angle_rad);
}

}  // namespace cyclorama::turntable
