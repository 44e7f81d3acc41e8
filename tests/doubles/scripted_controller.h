// SPDX-License-Identifier: Apache-2.0
/// A motor controller at the other end of a pseudo-terminal. It answers as Marlin's firmware does, or as a script
/// determines.
#pragma once

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <stdlib.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "common/base/check.h"
#include "common/base/unique_fd.h"
#include "drivers/turntable/serial/gcode.h"

namespace cyclorama {

/// Answers from its construction. Thread-safe.
class ScriptedController {
 public:
  /// Replaces the regular answer by a text, by silence (an empty text), or by a closed line.
  struct Fault {
    std::optional<std::string> says = std::nullopt;
    bool hangs_up = false;
  };
  /// Called for each line. `number` counts the lines from 0. Returns nothing for the regular answer.
  using Script = std::function<std::optional<Fault>(std::size_t number, const std::string& line)>;

  explicit ScriptedController(Script script = {}) : script_(std::move(script)) {
    master_.reset(::posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC));
    CHECK(master_.is_open() && ::grantpt(master_.get()) == 0 && ::unlockpt(master_.get()) == 0);
    std::array<char, 128> name{};
    CHECK(::ptsname_r(master_.get(), name.data(), name.size()) == 0);
    device_ = name.data();
    // Keeps the terminal open, so that it does not hang up before the program opens it. cfmakeraw() disables echo.
    held_.reset(::open(device_.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC));
    CHECK(held_.is_open());
    termios settings{};
    ::tcgetattr(held_.get(), &settings);
    ::cfmakeraw(&settings);
    ::tcsetattr(held_.get(), TCSANOW, &settings);
    thread_ = std::jthread([this](const std::stop_token& stop) { serve(stop); });
  }

  [[nodiscard]] const std::string& device() const { return device_; }
  [[nodiscard]] std::vector<std::string> heard() const {
    const std::lock_guard lock(mutex_);
    return heard_;
  }
  /// Returns the position in units of the axis.
  [[nodiscard]] double position() const { return position_; }
  /// Blocks the turntable, so that it does not move, or releases it.
  void block(bool is_blocked) { is_blocked_ = is_blocked; }

 private:
  void serve(const std::stop_token& stop) {
    gcode::LineCutter lines;
    while (!stop.stop_requested()) {
      pollfd entry{master_.get(), POLLIN, 0};
      if (::poll(&entry, 1, 5) <= 0) continue;
      std::array<char, 256> bytes{};
      const ssize_t count = ::read(master_.get(), bytes.data(), bytes.size());
      if (count <= 0) return;
      lines.add({bytes.data(), static_cast<std::size_t>(count)});
      while (const auto line = lines.next()) {
        if (!answer(*line)) return;
      }
    }
  }

  bool answer(const std::string& line) {
    std::size_t number = 0;
    {
      const std::lock_guard lock(mutex_);
      number = heard_.size();
      heard_.push_back(line);
    }
    const auto fault = script_ ? script_(number, line) : std::nullopt;
    if (fault && fault->hangs_up) {
      held_.reset();
      master_.reset();
      return false;
    }
    write(fault && fault->says ? *fault->says : well(line));
    return true;
  }

  std::string well(const std::string& line) {
    if (line.starts_with("G28") && !is_blocked_) position_ = 0.0;
    if (line.starts_with("G0 ") && !is_blocked_) position_ = std::strtod(line.c_str() + 4, nullptr);
    if (line.starts_with("G28")) return "echo:busy: processing\nok\n";
    if (line == "M114")
      return fmt::format("X:{:.2f} Y:0.00 Z:0.00 E:0.00 Count X:{:.0f} Y:0 Z:0\nok\n", position_.load(),
                         80.0 * position_.load());
    return "ok P15 B3\n";
  }

  void write(std::string_view text) {
    while (!text.empty()) {
      const ssize_t count = ::write(master_.get(), text.data(), text.size());
      if (count <= 0) return;
      text.remove_prefix(static_cast<std::size_t>(count));
    }
  }

  Script script_;
  std::string device_;
  UniqueFd master_;
  UniqueFd held_;
  std::atomic<double> position_{17.0};
  std::atomic<bool> is_blocked_{false};
  mutable std::mutex mutex_;
  std::vector<std::string> heard_;
  std::jthread thread_;
};

}  // namespace cyclorama
