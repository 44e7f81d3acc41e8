// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "drivers/output/drm/atomic_request.h"
#include "drivers/output/drm/canvas.h"
#include "drivers/output/drm/flip_waiter.h"
#include "drivers/output/drm/mode_choice.h"
#include "drivers/output/drm/scanout.h"
#include "drivers/output/output.h"

namespace cyclorama::output {

/// A head to be shown on one of a card's connectors. Borrows the canvas.
struct HeadTarget {
  std::size_t head = 0;
  const Connector* connector = nullptr;
  const Canvas* canvas = nullptr;
  Rotation rotation = Rotation::kNone;
  double refresh_hz = 60.0;
};

/// The heads of one card; they are lit together and flipped together.
///
///            light()                     paint(), flip(), wait()
///   dark ───────────────▶ lit ─────────────────────────────────▶ lit
///     ▲  any error: dark   │  after any failure: light() again
///     └────────────────────┘
///
/// Invariants: 1. no two pipes (lit heads) share a connector, a CRTC or a primary plane; 2. the front buffer of a pipe
/// is never drawn to. Borrows the GpuContext, the copier and the clock. Thread-bound.
class CardHeads {
 public:
  CardHeads(Card card, const Clock& clock) : card_(std::move(card)), waiter_(clock) {}

  [[nodiscard]] const Card& card() const { return card_; }

  /// Lights the targets' connectors, each with the best mode and depth that the card accepts together with the
  /// preceding targets, shows their canvases, and turns everything else on the card off. `connectors` are all
  /// connectors of the card. A target that the card cannot light stays dark (see is_showing()). Without targets
  /// everything goes dark (DPMS off). Errors: from errno, and those of Scanout::make(); the state of the heads is then
  /// unknown.
  Status light(const GpuContext& gpu, const CanvasCopier& copier, std::span<const Connector> connectors,
               std::span<const HeadTarget> targets);
  /// Releases all buffers, as required before the GL context is destroyed. All heads go dark.
  void release();
  [[nodiscard]] bool is_showing(std::size_t head) const;
  /// Refresh rate of the slowest head; 0 if none is lit.
  [[nodiscard]] double refresh_hz() const;
  /// Returns the state of one head and the time at which it began to show the commit of the last wait(). The state is
  /// kDark if the head is not lit, kSame if that commit did not include it.
  [[nodiscard]] HeadShown shown(std::size_t head) const;
  /// Connector, mode, depth and projector of a head, such as "HDMI-A-1 1920x1080@60.00 10 bit EPS EB-L1755U", or
  /// "dark".
  [[nodiscard]] std::string text_of_head(std::size_t head) const;

  /// Draws a head's canvas to its back buffer if the head is lit. The GL commands must have finished before flip().
  void paint(const CanvasCopier& copier, std::size_t head);
  /// Returns whether any head has been painted since the last flip().
  [[nodiscard]] bool is_painted() const;
  /// Commits all painted heads in one atomic request. Errors: from errno; EBUSY if the last flip is not complete.
  Status flip();
  [[nodiscard]] bool is_flipping() const { return waiter_.is_waiting(); }
  /// Errors: those of FlipWaiter::wait(). Precondition: is_flipping().
  Result<Flipped> wait(std::chrono::milliseconds timeout);

 private:
  /// A mode and depth to try.
  struct Setting {
    drmModeModeInfo mode{};
    bool is_deep = false;
  };
  struct Pipe {
    HeadTarget target;
    std::string connector_text;
    std::uint32_t connector_id = 0;
    std::size_t crtc = 0;
    std::size_t plane = 0;
    Setting setting;
    ModeBlob mode;
    std::array<Scanout, 2> buffers;
    std::size_t front = 0;
    bool is_painted = false;

    [[nodiscard]] const Scanout& back() const { return buffers[1 - front]; }
  };

  [[nodiscard]] std::vector<Setting> settings_for(const HeadTarget& target, std::size_t plane) const;
  [[nodiscard]] std::optional<std::size_t> primary_plane_of(std::size_t crtc, std::span<const Pipe> others) const;
  Result<Pipe> make_pipe(const GpuContext& gpu, const HeadTarget& target, std::size_t crtc, std::size_t plane,
                         const Setting& setting);
  Status light_anew(const GpuContext& gpu, const CanvasCopier& copier, std::span<const Connector> connectors,
                    std::span<const HeadTarget> targets);
  Status add_pipe(const GpuContext& gpu, std::span<const Connector> connectors, const HeadTarget& target,
                  std::size_t crtc);
  [[nodiscard]] AtomicRequest whole_card(std::span<const Connector> connectors, std::span<const Pipe> pipes) const;
  static void paint(const CanvasCopier& copier, Pipe* pipe);

  Card card_;
  FlipWaiter waiter_;
  std::vector<Pipe> pipes_;
  std::vector<Pipe> retired_;  // Earlier pipes, whose buffers the card may scan out until light() succeeds.
};

}  // namespace cyclorama::output
