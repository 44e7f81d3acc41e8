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

/// A head that shall be shown on one of a card's connectors. Borrows the canvas.
struct HeadTarget {
  std::size_t head = 0;
  const Connector* connector = nullptr;
  const Canvas* canvas = nullptr;
  Rotation rotation = Rotation::kNone;
  double refresh_hz = 60.0;
};

/// The heads of one card: lit together, flipped together.
///
///            light()                     paint(), flip(), wait()
///   dark ───────────────▶ lit ─────────────────────────────────▶ lit
///     ▲  any error: dark   │  whatever fails: light() again
///     └────────────────────┘
///
/// Invariants: 1. each pipe has a connector, a CRTC and a primary plane that no other has. 2. What a pipe's front
/// buffer holds is not drawn to. Borrows the GpuContext, the copier and the clock. Thread-bound.
class CardHeads {
 public:
  CardHeads(Card card, const Clock& clock) : card_(std::move(card)), waiter_(clock) {}

  [[nodiscard]] const Card& card() const { return card_; }

  /// Lights the targets' connectors, each with the best mode and depth that the card takes beside those before it,
  /// shows their canvases, and turns everything else on the card off. `connectors` are all that the card has. A target
  /// that the card cannot light stays dark; is_showing() tells. Without targets everything goes dark (DPMS off). Errors
  /// as errno says, and those of Scanout::make(): then nothing is known of what is lit.
  Status light(const GpuContext& gpu, const CanvasCopier& copier, std::span<const Connector> connectors,
               std::span<const HeadTarget> targets);
  /// Lets go of all buffers, before the GL context dies. What was lit goes dark.
  void release();
  [[nodiscard]] bool is_showing(std::size_t head) const;
  /// Of the slowest head; 0 when none is lit.
  [[nodiscard]] double refresh_hz() const;
  /// Of one head, and when it began to show what the last wait() was for. kDark when it is not lit, kSame when that
  /// commit was not about it.
  [[nodiscard]] HeadShown shown(std::size_t head) const;
  /// "HDMI-A-1 1920x1080@60.00 10 bit EPS EB-L1755U": what a head is shown with; "dark" else.
  [[nodiscard]] std::string text_of_head(std::size_t head) const;

  /// Draws a head's canvas to its back buffer, if it is lit. The GL commands must have finished before flip().
  void paint(const CanvasCopier& copier, std::size_t head);
  /// Whether there is something for flip().
  [[nodiscard]] bool is_painted() const;
  /// Hands all that is painted to the card in one commit. Errors as errno says; EBUSY: the last flip is not done.
  Status flip();
  [[nodiscard]] bool is_flipping() const { return waiter_.is_waiting(); }
  /// Errors of FlipWaiter::wait(). Precondition: is_flipping().
  Result<Flipped> wait(std::chrono::milliseconds timeout);

 private:
  /// A mode and depth that may be tried.
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
  std::vector<Pipe> retired_;  // While a light() has not succeeded, the card may still scan these out.
};

}  // namespace cyclorama::output
