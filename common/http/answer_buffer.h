// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <string>
#include <string_view>

namespace cyclorama {

/// An answer on its way from the worker that writes it to the loop that sends it. A worker waits only for a client that
/// has not taken the previous kMaxBytes. Thread-safe.
class AnswerBuffer {
 public:
  static constexpr std::size_t kMaxBytes = std::size_t{1} << 20;

  /// `wake` is called, by the worker, when there is something to send.
  explicit AnswerBuffer(std::function<void()> wake) : wake_(std::move(wake)) {}

  /// Worker: adds bytes. Waits while the buffer is full: the loop closes a connection whose client takes too
  /// long. Returns false if the connection is closed.
  bool append(std::string_view bytes);
  /// Worker: the answer is complete.
  void finish(bool closes_connection);

  /// Loop: returns everything that waits.
  std::string take();
  /// Loop: the connection is closed.
  void close();
  [[nodiscard]] bool is_full() const;
  [[nodiscard]] bool is_finished() const;
  /// Meaningful once it is finished.
  [[nodiscard]] bool closes_connection() const;

 private:
  const std::function<void()> wake_;
  mutable std::mutex mutex_;  ///< Guards the following.
  std::condition_variable taken_;
  std::string bytes_;
  bool is_finished_ = false;
  bool closes_connection_ = false;
  bool is_closed_ = false;
};

}  // namespace cyclorama
