// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <utility>

namespace cyclorama {

/// Maximum number of frames that are requested but not finished: one is rendered while the other crosses the network.
/// More would only make pictures older.
inline constexpr std::size_t kFramesInFlight = 2;

/// Requests for frames. At most kFramesInFlight are in flight; of the other requests, only the newest waits.
///
///   put() ──► waiting (one, newest wins) ──send()──► in flight ──finish() or skip_before()──► forgotten
///                 ▲                                      │
///                 └───────── lose(): the newest ─────────┘
///
/// Request numbers are unique and increase. Used by the tour, the farm's client and the coordinator. Thread-bound.
template <typename Request>
class FrameWindow {
 public:
  /// Stores `request` as the waiting request. Returns true if it replaced another one.
  bool put(std::uint64_t number, Request request) {
    const bool dropped = waiting_.has_value();
    waiting_.emplace(number, std::move(request));
    return dropped;
  }
  /// Puts the waiting request in flight and returns it; null if none waits or there is no room. The pointer is valid
  /// until the next call that changes the window.
  const Request* send() {
    if (!is_sendable()) return nullptr;
    in_flight_.push_back(*std::exchange(waiting_, std::nullopt));
    return &in_flight_.back().request;
  }
  /// Puts a request in flight directly, without waiting.
  void add(std::uint64_t number, Request request) { in_flight_.emplace_back(number, std::move(request)); }

  /// Returns the request in flight with that number, or null. The pointer is valid until the next call that changes the
  /// window.
  [[nodiscard]] const Request* find(std::uint64_t number) const {
    const auto found = std::ranges::find(in_flight_, number, &Numbered::number);
    return found == in_flight_.end() ? nullptr : &found->request;
  }
  /// Drops requests in flight with smaller numbers, whose frames will never come. Returns how many were dropped.
  std::size_t skip_before(std::uint64_t number) {
    return std::erase_if(in_flight_, [&](const Numbered& one) { return one.number < number; });
  }
  /// Removes the request with that number, whose frame has ended, and returns it; empty if it was not in flight.
  std::optional<Request> finish(std::uint64_t number) {
    const auto found = std::ranges::find(in_flight_, number, &Numbered::number);
    if (found == in_flight_.end()) return std::nullopt;
    Request request = std::move(found->request);
    in_flight_.erase(found);
    return request;
  }
  /// Drops all requests in flight, because the connection was lost. The newest of them waits again, unless a newer
  /// request waits already.
  void lose() {
    if (!waiting_ && !in_flight_.empty()) waiting_ = std::move(in_flight_.back());
    in_flight_.clear();
  }

  [[nodiscard]] std::size_t in_flight() const { return in_flight_.size(); }
  [[nodiscard]] bool has_room() const { return in_flight_.size() < kFramesInFlight; }
  [[nodiscard]] bool is_waiting() const { return waiting_.has_value(); }
  [[nodiscard]] bool is_sendable() const { return waiting_ && has_room(); }

 private:
  struct Numbered {
    Numbered(std::uint64_t its_number, Request its_request) : number(its_number), request(std::move(its_request)) {}
    std::uint64_t number;
    Request request;
  };
  std::optional<Numbered> waiting_;
  std::deque<Numbered> in_flight_;  ///< Oldest first.
};

}  // namespace cyclorama
