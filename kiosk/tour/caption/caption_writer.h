// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "kiosk/tour/caption/caption_script.h"

namespace cyclorama::tour {

/// Writes a stop's captions on the wall, each at its time. Its thread `captions` sets them, so that the walk never waits
/// for letters; it begins with the first script and sleeps while nothing changes. Thread-safe.
class CaptionWriter {
 public:
  /// `send` is called on the thread `captions` whenever something else is to be written, or nothing.
  using Send = std::function<void(wire::Caption)>;
  explicit CaptionWriter(Send send) : send_(std::move(send)) {}
  ~CaptionWriter();
  CaptionWriter(const CaptionWriter&) = delete;
  CaptionWriter& operator=(const CaptionWriter&) = delete;

  /// Replaces what is written; nothing: the wall is cleared.
  void write(std::optional<CaptionScript> script);
  /// Ends the thread. Idempotent.
  void stop();
  /// Returns why the newest script is not written; empty: it is.
  [[nodiscard]] std::string trouble() const;

 private:
  void run();
  void clear();

  const Send send_;
  mutable std::mutex mutex_;  ///< Guards the following.
  std::condition_variable changed_;
  std::optional<CaptionScript> script_;
  bool is_new_ = false;
  bool is_stopping_ = false;
  std::string trouble_;
  std::thread captions_;
  bool is_written_ = false;  ///< Thread `captions` only: something is on the wall.
};

}  // namespace cyclorama::tour
