// SPDX-License-Identifier: Apache-2.0
/// All displays that are dialled in: what goes to each of them, and which picture they want together.
#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "common/geometry/projection.h"
#include "kiosk/tour/session/outbox.h"

namespace cyclorama {

/// One display's end of a Show stream. Thread-safe; neither call blocks or calls back.
class DisplayLink {
 public:
  virtual ~DisplayLink() = default;
  /// `show_at`: null for at once.
  virtual void send_heading(double heading_rad, std::int64_t shutter_ns, const wire::ShowAt* show_at) = 0;
  /// The number of the frame that this display loses by it, if it is too slow.
  virtual std::optional<std::uint64_t> send(const SharedShowMessage& message) = 0;
  virtual void close(const Error& reason) = 0;

 protected:
  DisplayLink() = default;
  DisplayLink(const DisplayLink&) = default;
  DisplayLink& operator=(const DisplayLink&) = default;
};

/// Sends one message object to all displays; only references are copied here. Thread-safe.
class DisplayHub {
 public:
  static constexpr std::size_t kMostDisplays = 32;

  /// The newest heading is sent to it at once, so that its stream starts with one.
  /// kBusy  kMostDisplays are there.     kUnavailable  close() was called.     kInvalidArgument  its wall wants another
  /// kind of picture than those that are here, or one for other eyes.
  Status join(const std::shared_ptr<DisplayLink>& link, std::string name, const Projection& wanted);
  /// Idempotent.
  void leave(const DisplayLink* link);

  void send_heading(double heading_rad, std::int64_t shutter_ns, const wire::ShowAt* show_at);
  /// How many displays lost a whole frame by it, being slow.
  std::size_t send(const SharedShowMessage& message);
  /// What all displays want; nothing without displays.
  [[nodiscard]] std::optional<Projection> wanted() const;
  [[nodiscard]] std::size_t count() const;
  /// Ends all streams, now and later.
  void close(const Error& reason);

 private:
  struct Member {
    std::shared_ptr<DisplayLink> link;
    std::string name;
    Projection wanted;
  };
  mutable std::mutex mutex_;  ///< Guards the following.
  std::vector<Member> members_;
  double heading_rad_ = 0.0;
  std::int64_t shutter_ns_ = 0;
  std::optional<Error> closed_;
};

}  // namespace cyclorama
