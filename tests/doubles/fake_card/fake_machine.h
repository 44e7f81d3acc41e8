// SPDX-License-Identifier: Apache-2.0
/// Graphics cards described as data, in place of libdrm, GBM, EGL on GBM and udev. A program that links fake_card gets
/// them instead of the machine's (by the linker's --wrap). GL is real but has no surface, so a connector's picture
/// consists of real pixels.
///
///   FakeClock clock;
///   FakeMachine machine({three_projectors()}, &clock);
///   auto output = open_drm_output(...);
///   machine.fail("drmModeGetResources", EIO);       // Fails the next call, once.
///   machine.wall(0, 1)                              // Picture of card 0's second connector; nothing if dark.
#pragma once

#include <xf86drmMode.h>

#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "common/image/image.h"
#include "drivers/output/drm/probe_runner.h"
#include "tests/doubles/fake_clock.h"

struct gbm_bo {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::uint32_t format = 0;
  std::uint32_t handle = 0;
  unsigned renderbuffer = 0;  ///< Renderbuffer into which GL draws this buffer.
};

namespace cyclorama {

/// Returns a progressive mode with much blanking.
drmModeModeInfo fake_mode(int width_px, int height_px, double refresh_hz, bool is_preferred = false);
/// Returns a complete EDID 1.4 base block without timings; `colour_bits` is 0, 6, 8, ... 16.
std::vector<std::uint8_t> fake_edid(const std::string& model, int colour_bits, const std::string& serial = {});

struct FakeConnector {
  std::uint32_t type = DRM_MODE_CONNECTOR_HDMIA;
  std::uint32_t number = 1;
  bool is_connected = true;
  std::vector<drmModeModeInfo> modes;
  std::vector<std::uint8_t> edid;
  std::uint32_t possible_crtcs = 0xff;
  std::uint64_t max_bpc = 0;  ///< 0 if the driver does not have this property.
  bool has_hot_plug = true;   ///< False: the kernel takes it for disconnected, whatever is plugged in.
  std::optional<bool> known_connected{};  ///< State found by the kernel's last probe.
  Duration probe_time{};                  ///< Duration of a real probe: DDC over the cable.
  Duration modeset_time{};                ///< Duration of a commit that lights it or changes its mode.
};

struct FakeCard {
  std::string path = "/dev/dri/card0";
  std::size_t crtcs = 3;
  std::vector<FakeConnector> connectors;
  /// Upper bound of the sum of all modes' clocks, as memory bandwidth imposes; 0 for none.
  std::uint64_t max_clock_khz = 0;
  bool can_be_deep = true;  ///< True if planes support 10 bits.
  bool has_raster = true;   ///< False for virtual cards, on which flips happen immediately.
  bool has_fences = false;  ///< True if commits can wait for the GPU (IN_FENCE_FD), and EGL makes such fences.
};
/// Returns a card with three connected projectors of 64x36 pixels at 60 Hz: HDMI-A-1 to -3, 8 bits.
FakeCard three_projectors();

/// The whole fake machine, as long as this object exists. Only one may exist at a time. Bound to the output's thread.
class FakeMachine {
 public:
  FakeMachine(std::vector<FakeCard> cards, FakeClock* clock);
  ~FakeMachine();
  FakeMachine(const FakeMachine&) = delete;
  FakeMachine& operator=(const FakeMachine&) = delete;

  /// Returns a connector, which may be changed at any time; hot_plug() notifies the driver of the change.
  FakeConnector& connector(std::size_t card, std::size_t number);
  void hot_plug() { ++hot_plugs; }
  /// Lets `passes` calls of this name succeed and makes the next one fail with this errno. "page flip event" suppresses
  /// an event instead. Commits are named "drmModeAtomicCommit (test)", "(modeset)" and "(flip)".
  void fail(const std::string& call, int error, int passes = 0);
  /// Returns true if the fault that was set has occurred.
  [[nodiscard]] bool was_fault_met() const { return !fault_; }
  /// Completes every commit that is under way, without its events.
  void forget_commits(std::size_t card);
  /// Simulates another program that takes or releases the card.
  void set_master_taken(std::size_t card, bool is_taken);
  /// Loses all contents of the GPU, as after a hang.
  void reset_gpu() { is_gpu_reset = true; }
  /// Returns the picture that a connector scans out at present, with rows from the top; nothing if there is no signal.
  /// A GL context must be current.
  [[nodiscard]] std::optional<RgbImage> wall(std::size_t card, std::size_t number) const;
  /// Returns the mode of a connector; nothing if it is dark.
  [[nodiscard]] std::optional<drmModeModeInfo> mode_of(std::size_t card, std::size_t number) const;
  [[nodiscard]] bool is_deep(std::size_t card, std::size_t number) const;
  /// Return the number of commits except tests, and how many of these may have darkened a screen.
  [[nodiscard]] int commits(std::size_t card) const;
  [[nodiscard]] int modesets(std::size_t card) const;
  /// Returns the times at which a connector began to show a new picture.
  [[nodiscard]] const std::vector<TimePoint>& shown_at(std::size_t card, std::size_t number) const;
  /// Returns what runs probes beside the calling thread, in simulated time: while a job takes its time, the calling
  /// thread goes on, unless it makes a call that needs the kernel's lock on the connectors.
  [[nodiscard]] std::unique_ptr<output::ProbeRunner> probe_runner();
  /// Lets the GPU take this long from each glFlush() or glFinish() on.
  void set_render_time(Duration time) { render_time_ = time; }
  /// Returns the number of calls of each wrapped function.
  [[nodiscard]] const std::map<std::string, int>& calls() const { return calls_; }
  /// Returns the number of buffers, images, contexts and files that are still held.
  [[nodiscard]] std::size_t held() const;

  // The members below are for the wrapped calls only.

  using State = std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint64_t>;  // (object, property) -> value.
  struct Framebuffer {
    const gbm_bo* buffer = nullptr;
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    std::uint32_t format = 0;
  };
  struct FlipEvent {
    std::uint32_t crtc = 0;
    void* cookie = nullptr;
    TimePoint due{};
  };
  struct CardState {
    FakeCard card;
    State state;
    std::map<std::uint32_t, std::vector<std::uint8_t>> blobs;
    std::map<std::uint32_t, Framebuffer> framebuffers;
    std::map<std::uint32_t, const gbm_bo*> imported;
    std::vector<FlipEvent> events;
    std::map<std::uint32_t, TimePoint> flipping;  // CRTCs with a commit that is not complete, and its end.
    std::map<std::uint32_t, std::vector<TimePoint>> shown_at;
    int master_fd = -1;
    bool is_master_taken = false;
    int commits = 0;
    int modesets = 0;
  };

  static FakeMachine& the();
  static FakeMachine* the_or_null();
  /// Returns the errno with which this call must fail; 0 if it must succeed.
  int meet(const char* call);
  [[nodiscard]] CardState* card_of(int fd);
  [[nodiscard]] CardState* card_at(const std::string& path);
  [[nodiscard]] FakeClock& clock() { return *clock_; }
  void opened(int fd, CardState* card);
  void closed(int fd);
  /// Lets time pass on the calling thread, as a slow call does.
  void spend(Duration time);
  /// Lets a job run beside the calling thread; its calls let no time pass there. Returns when it ends.
  TimePoint run_beside(const std::function<void()>& job);
  /// Waits as a call does that needs the kernel's lock on the connectors.
  void lock_connectors();
  void flush_gpu() { rendered_at = clock_->now() + render_time_; }
  [[nodiscard]] bool has_fences() const;
  /// Returns a new object number, like those that the kernel assigns.
  std::uint32_t next_id() { return ++last_id_; }
  int commit(CardState* card, const State& changes, std::uint32_t flags, void* cookie, int fd);

  static std::uint32_t property_id(const std::string& name);
  static std::string property_name(std::uint32_t id);
  static constexpr std::uint32_t kFirstCrtc = 100;
  static constexpr std::uint32_t kFirstConnector = 200;
  static constexpr std::uint32_t kFirstPrimary = 300;
  static constexpr std::uint32_t kFirstCursor = 350;

  int hot_plugs = 0;
  bool is_gpu_reset = false;
  unsigned sequence = 0;
  std::set<gbm_bo*> buffers;
  std::size_t gbm_devices = 0;
  std::size_t contexts = 0;
  std::size_t images = 0;
  std::size_t udev_objects = 0;
  std::map<int, gbm_bo*> shared;
  std::map<int, TimePoint> fences;
  TimePoint rendered_at{};

 private:
  struct Fault {
    std::string call;
    int error = 0;
    int passes = 0;
  };
  [[nodiscard]] TimePoint fence_of(const State& changes) const;
  [[nodiscard]] Duration modeset_time(const CardState& card, const State& wanted) const;
  [[nodiscard]] TimePoint next_vertical_blank(const CardState& card, std::uint32_t crtc, TimePoint after) const;
  [[nodiscard]] int refusal(const CardState& card, const State& wanted, bool allows_modeset) const;
  [[nodiscard]] int refusal_of_planes(const CardState& card, const State& wanted) const;
  [[nodiscard]] int refusal_of_modes(const CardState& card, const State& wanted) const;

  std::vector<std::unique_ptr<CardState>> cards_;
  std::map<int, CardState*> fds_;
  FakeClock* clock_;
  Duration render_time_{};
  std::optional<Duration> beside_;  // Time that the job beside has taken, while it runs.
  TimePoint beside_until_{};
  std::optional<Fault> fault_;
  std::map<std::string, int> calls_;
  std::uint32_t last_id_ = 5000;
};

}  // namespace cyclorama
