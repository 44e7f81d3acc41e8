// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "common/base/clock.h"
#include "common/http/answer_buffer.h"
#include "common/http/http_channel.h"

namespace cyclorama {

/// Deadlines and sizes of one connection.
struct ConnectionLimits {
  std::size_t max_head_bytes = std::size_t{16} * 1024;
  std::size_t max_body_bytes = 4096;
  Duration request_within = std::chrono::seconds(10);  ///< TLS handshake and whole request.
  Duration answer_within = std::chrono::seconds(30);   ///< For the client to take what is ready, at most 1 MiB.
  Duration idle = std::chrono::seconds(5);             ///< Between an answer's end and the next request's first byte.
  Duration last_bytes = std::chrono::seconds(2);       ///< For a refused client to read why.
};

/// The state of one client's connection, which never blocks:
///
///     handshake ─▶ reading ─▶ answering ─▶ ending ─▶ closed
///                     ▲           │
///                     └───────────┘ the connection is kept
///
/// A request leaves it only when it is whole, so that a slow client occupies no thread. Thread-bound to the loop.
class HttpConnection {
 public:
  /// `limits` is borrowed. `peer` is the client's address.
  HttpConnection(HttpChannel channel, std::string peer, const ConnectionLimits& limits, TimePoint now);
  ~HttpConnection();
  HttpConnection(const HttpConnection&) = delete;
  HttpConnection& operator=(const HttpConnection&) = delete;

  /// Proceeds as far as the socket allows. Returns true when a request is whole: then take_request() is to be called.
  bool proceed(TimePoint now);
  /// Returns the whole request, and expects its answer in `answer`.
  std::string take_request(std::shared_ptr<AnswerBuffer> answer);
  /// Ends the connection with the answer for an HTTP status that refuses the request.
  void refuse(int status, TimePoint now);

  [[nodiscard]] bool is_closed(TimePoint now) const { return state_ == State::kClosed || now >= deadline_; }
  /// A worker has its request, or the answer is being sent.
  [[nodiscard]] bool is_answering() const { return state_ == State::kAnswering; }
  /// The client has not taken its answer, and the worker waits for that.
  [[nodiscard]] bool is_stuck() const { return answer_ != nullptr && !sending_.empty() && answer_->is_full(); }
  [[nodiscard]] const std::string& peer() const { return peer_; }
  [[nodiscard]] TimePoint deadline() const { return deadline_; }
  [[nodiscard]] int fd() const { return channel_.fd(); }
  /// Events for poll(2).
  [[nodiscard]] short events() const;

 private:
  enum class State { kHandshake, kReading, kAnswering, kEnding, kClosed };
  bool read(TimePoint now);
  void send(TimePoint now);
  void drain();
  void end(TimePoint now);
  /// Notes for which event the channel waits. Returns true if it is done.
  bool is_done(HttpChannel::Progress progress);

  HttpChannel channel_;
  const std::string peer_;
  const ConnectionLimits& limits_;
  State state_ = State::kHandshake;
  TimePoint deadline_;
  bool wants_output_ = false;
  bool is_idle_ = false;           ///< Kept, and nothing of the next request has arrived.
  std::string received_;           ///< Not yet handed to a worker.
  std::string sending_;            ///< Taken from the answer, and not yet sent.
  std::size_t request_bytes_ = 0;  ///< Length of the whole request at the front of `received_`.
  bool must_end_ = false;          ///< The rest of the request is left out, so the connection cannot be kept.
  std::shared_ptr<AnswerBuffer> answer_;
};

}  // namespace cyclorama
