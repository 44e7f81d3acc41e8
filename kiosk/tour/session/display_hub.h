// SPDX-License-Identifier: Apache-2.0
/// The connected displays: what is sent to each of them, and which picture they need together.
#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "common/geometry/projection.h"
#include "kiosk/tour/session/outbox.h"

namespace cyclorama::tour {

/// The server's end of one display's Show stream. Thread-safe; no call blocks or calls back.
class DisplayLink {
 public:
  virtual ~DisplayLink() = default;
  /// `show_at` is null to show the heading at once.
  virtual void send_heading(const wire::Heading& heading, const wire::ShowAt* show_at) = 0;
  /// Returns the number of the frame that this display loses because it is too slow, if it loses one.
  virtual std::optional<std::uint64_t> send(const SharedShowMessage& message) = 0;
  virtual void send_caption(const SharedShowMessage& caption) = 0;
  virtual void close(const Error& reason) = 0;

 protected:
  DisplayLink() = default;
  DisplayLink(const DisplayLink&) = default;
  DisplayLink& operator=(const DisplayLink&) = default;
};

/// Pixels of a display's projectors for each radian of the wall; 0: unknown.
struct PixelDensity {
  double min_px_per_rad = 0.0;
  double max_px_per_rad = 0.0;
};

/// The connected displays. All of them share one object for each message; only references are copied. Thread-safe.
class DisplayHub {
 public:
  static constexpr std::size_t kMaxDisplays = 32;

  /// Adds a display and sends it the newest heading at once, so that its stream starts with a heading, and what is
  /// written on the wall. Errors: kBusy if
  /// kMaxDisplays have joined; kUnavailable if close() was called; kInvalidArgument if its wall needs another kind of
  /// picture, or a picture for other eyes, than the displays that have joined.
  Status join(const std::shared_ptr<DisplayLink>& link, std::string name, const Projection& wanted,
              const PixelDensity& density = {});
  /// Idempotent.
  void leave(const DisplayLink* link);

  void send_heading(const wire::Heading& heading, const wire::ShowAt* show_at);
  /// Replaces what is written on the wall. Precondition: the message has a caption.
  void send_caption(const SharedShowMessage& caption);
  /// Returns how many displays lost a whole frame because they are slow.
  std::size_t send(const SharedShowMessage& message);
  /// Returns the projection that covers all displays; nothing without displays.
  [[nodiscard]] std::optional<Projection> wanted() const;
  /// Returns the coarsest and the finest of all projectors whose density is known.
  [[nodiscard]] PixelDensity density() const;
  [[nodiscard]] std::size_t count() const;
  /// Ends all streams, and refuses later ones.
  void close(const Error& reason);

 private:
  struct Member {
    std::shared_ptr<DisplayLink> link;
    std::string name;
    Projection wanted;
    PixelDensity density;
  };
  mutable std::mutex mutex_;  ///< Guards the following.
  std::vector<Member> members_;
  wire::Heading heading_;      ///< Newest; without an eye before the first scene.
  SharedShowMessage caption_;  ///< Newest; null before the first.
  std::optional<Error> closed_;
};

}  // namespace cyclorama::tour
