// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mutex>
#include <stop_token>
#include <string>
#include <thread>

#include "common/base/result.h"

namespace cyclorama::operations {

/// Lets one projector blink, so that people see which one has a name, while the others are dark. Thread-safe. Threads:
/// one while a projector blinks.
class Blinker {
 public:
  /// `display` is the display's address.
  explicit Blinker(std::string display) : display_(std::move(display)) {}
  ~Blinker();
  Blinker(const Blinker&) = delete;
  Blinker& operator=(const Blinker&) = delete;

  /// Replaces a projector that blinks now. The size is that of its picture. Errors: kNotFound without a display.
  Status blink(const std::string& projector, int width_px, int height_px);
  /// Returns the reason why the last one did not blink; empty: it did, or does.
  [[nodiscard]] std::string trouble() const;
  /// Returns the name of the projector that blinks now; empty: none does.
  [[nodiscard]] std::string now() const;

 private:
  void run(const std::stop_token& stop, const std::string& projector, const std::string& white);

  const std::string display_;
  std::mutex ordering_;       ///< Guards the thread.
  mutable std::mutex mutex_;  ///< Guards the texts.
  std::string now_;
  std::string trouble_;
  std::jthread thread_;  ///< The last member, so that it ends first.
};

}  // namespace cyclorama::operations
