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

/// The heads of one card. Heads of the same refresh rate flip together, in one commit; others have commits of their
/// own, so that none waits for a slower one.
///
///            light()                    draw(), paint(), flip(), wait()
///   dark ──────────────▶ settling ───▶ lit ─────────────────────────────▶ lit
///     ▲  any error: dark    │  after any failure: lose(), light() again    │
///     └─────────────────────┴──────────────────────────────────────────────┘
///
/// A modeset beside heads that show something concerns only the connectors that change, and does not block; until it
/// is complete, its heads are settling.
///
/// Invariants: 1. no two pipes (lit heads) share a connector, a CRTC or a primary plane; 2. neither the front buffer of
/// a pipe nor, while a flip is under way, the one before is drawn to. Borrows the GpuContext, the copier and the clock.
/// Thread-bound.
class CardHeads {
 public:
  CardHeads(Card card, const Clock& clock) : card_(std::move(card)), clock_(clock), waiter_(clock) {}

  [[nodiscard]] const Card& card() const { return card_; }

  /// Lights the targets' connectors, each with the best mode and depth that the card accepts together with the
  /// preceding targets, shows their canvases, and turns everything else on the card off. `connectors` are all
  /// connectors of the card. A target that the card cannot light stays dark (see is_showing()). Without targets
  /// everything goes dark (DPMS off). `may_block`: no other head of the output shows anything, so the calling thread
  /// may wait for the modeset. Errors: from errno, and those of Scanout::make(); the state of the heads is then
  /// unknown.
  Status light(const GpuContext& gpu, const CanvasCopier& copier, std::span<const Connector> connectors,
               std::span<const HeadTarget> targets, bool may_block);
  /// Declares the state of the card unknown, such as after a failed flip: the next light() sets everything anew, and
  /// waits for it.
  void lose() { is_known_ = false; }
  [[nodiscard]] bool is_known() const { return is_known_; }
  /// Returns whether light() can be called: no flip is under way that it would meet with.
  [[nodiscard]] bool can_light() const { return !is_known_ || !waiter_.is_waiting(); }
  /// Releases all buffers, as required before the GL context is destroyed. All heads go dark.
  void release();
  /// Returns whether a head is lit or settling.
  [[nodiscard]] bool is_showing(std::size_t head) const;
  [[nodiscard]] bool is_any_showing() const { return !pipes_.empty(); }
  /// Ids of the connectors of heads that are lit or settling.
  [[nodiscard]] std::vector<std::uint32_t> lit_connectors() const;
  /// Refresh rate of the fastest lit head; 0 if none is lit.
  [[nodiscard]] double refresh_hz() const;
  /// Returns the state of one head: kDark if it is not lit, kNew with the time if it began to show a picture since the
  /// last begin(), else kSame.
  [[nodiscard]] HeadShown shown(std::size_t head) const;
  /// Connector, mode, depth and projector of a head, such as "HDMI-A-1 1920x1080@60.00 10 bit EPS EB-L1755U", or
  /// "dark".
  [[nodiscard]] std::string text_of_head(std::size_t head) const;

  /// Begins a refresh: takes the events that have come, and ends modesets that are complete. Errors: kTimedOut if a
  /// flip or a modeset did not come in time; others from errno.
  Status begin();
  /// Records that a head's canvas has a new picture.
  void draw(std::size_t head);
  /// Copies the canvases of heads with a new picture to their back buffers, except those whose flip is under way; they
  /// follow later. With `holds_slower`, heads slower than `fastest_hz` wait too, so that light() can be called soon.
  void paint(const CanvasCopier& copier, double fastest_hz, bool holds_slower);
  /// Returns whether any head has been painted since the last flip().
  [[nodiscard]] bool is_painted() const;
  /// Returns whether the card can wait for the GPU by itself.
  [[nodiscard]] bool takes_fences() const;
  /// Commits all painted heads, in one atomic request for each refresh rate. The pictures are complete once `fence` is
  /// signalled; -1: they are now. Errors: from errno; EBUSY if the last flip is not complete.
  Status flip(int fence, std::chrono::milliseconds timeout);
  /// Waits for the flips of heads with this rate, and returns when the last one came; nothing if none was under way.
  /// Errors: those of begin().
  Result<std::optional<Flipped>> wait(double refresh_hz);

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
    bool is_drawn = false;     // The canvas has a picture that was not painted yet.
    bool is_painted = false;   // The back buffer has a picture that was not flipped yet.
    bool is_new = true;        // The card does not have this pipe's mode yet.
    bool is_settling = false;  // Its modeset is under way.

    [[nodiscard]] const Scanout& back() const { return buffers[1 - front]; }
    [[nodiscard]] double refresh_hz() const { return refresh_hz_of(setting.mode); }
  };

  [[nodiscard]] std::vector<Setting> settings_for(const HeadTarget& target, std::size_t plane) const;
  [[nodiscard]] std::optional<std::size_t> primary_plane_of(std::size_t crtc, std::span<const Pipe> others) const;
  Result<Pipe> make_pipe(const GpuContext& gpu, const HeadTarget& target, std::size_t crtc, std::size_t plane,
                         const Setting& setting);
  Status light_anew(const GpuContext& gpu, const CanvasCopier& copier, std::span<const Connector> connectors,
                    std::span<const HeadTarget> targets, bool may_block);
  Status commit_changes(std::span<const Connector> connectors, bool may_block);
  Status add_pipe(const GpuContext& gpu, std::span<const Connector> connectors, const HeadTarget& target,
                  std::size_t crtc);
  /// Sets up every connector, CRTC and plane except those of kept pipes, if `skips_kept`.
  [[nodiscard]] AtomicRequest set_up(std::span<const Connector> connectors, bool skips_kept) const;
  [[nodiscard]] std::uint32_t crtc_id(const Pipe& pipe) const { return card_.crtcs()[pipe.crtc].id(); }
  static void paint(const CanvasCopier& copier, Pipe* pipe);

  Card card_;
  const Clock& clock_;
  FlipWaiter waiter_;
  bool is_known_ = false;                 // The card is set up according to pipes_.
  std::vector<std::uint32_t> lit_crtcs_;  // CRTCs that the last modeset left on.
  std::vector<Pipe> pipes_;
  std::vector<Pipe> retired_;  // Earlier pipes, whose buffers the card may scan out until light() succeeds.
};

}  // namespace cyclorama::output
