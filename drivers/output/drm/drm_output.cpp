// SPDX-License-Identifier: Apache-2.0
#include "drivers/output/drm/drm_output.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <optional>
#include <utility>

#include "drivers/output/drm/card_heads.h"
#include "drivers/output/drm/connector_assignment.h"
#include "drivers/output/drm/connector_watch.h"
#include "drivers/output/drm/refresh_pace.h"

namespace cyclorama::output {
namespace {

constexpr double kMaxHz = 1000.0;
constexpr double kMinHz = 0.1;
constexpr auto kMaxBackoff = std::chrono::seconds(1);
constexpr int kMaxFailures = 20;                      // Successive failures after which the output must be reopened.
constexpr int kMaxBusyFlips = 3;

/// One card and its state.
struct CardState {
  std::unique_ptr<CardHeads> heads;
  std::vector<Connector> connectors;  // Result of the last reading.
  std::vector<Connector> driven;      // The same, with what the heads' options replace.
  bool needs_light = true;
  bool has_lost_master = false;
  int failures = 0;  // Failures since the card was last lit.
  int busy_flips = 0;
  bool has_begun = false;  // False if this present() leaves the card alone.
  TimePoint retry_at{};
  int failed_readings = 0;  // Successive readings of the connectors that failed.
};

class DrmOutput final : public Output {
 public:
  DrmOutput(const DrmOptions& options, const Clock& clock)
      : options_(options), clock_(clock), pace_(options.refresh_hz, clock.now()) {
    for (const DrmHead& head : options_.heads) modes_.push_back(head.mode);
  }

  Status open() {
    for (const DrmHead& head : options_.heads) {
      TRY_ASSIGN(ConnectorPreference preferred, parse_connector_preference(head.connector));
      preferred.serial = head.serial;
      preferences_.push_back(std::move(preferred));
    }
    if (options_.cards.empty()) {
      TRY_ASSIGN(options_.cards, list_cards());
      if (options_.cards.empty())
        return Error(ErrorCode::kNotFound, "this machine has no graphics card with connectors");
    }
    for (const std::filesystem::path& path : options_.cards) {
      TRY_ASSIGN(Card card, Card::open(path));
      CardState state;
      state.heads = std::make_unique<CardHeads>(std::move(card), clock_);
      cards_.push_back(std::move(state));
    }
    TRY_ASSIGN(gpu_, GpuContext::make(cards_.front().heads->card()));
    TRY_ASSIGN(CanvasCopier copier, CanvasCopier::make(gl()));
    copier_.emplace(std::move(copier));
    for (const HeadMode& mode : modes_) {
      auto canvas = Canvas::make(gl(), mode.width_px, mode.height_px);
      if (!canvas) return std::move(canvas).error().while_doing(fmt::format("head '{}'", mode.name));
      canvases_.push_back(*std::move(canvas));
    }
    was_awake_ = is_awake();
    is_drawn_.assign(modes_.size(), false);
    shown_.resize(modes_.size());
    watch_.emplace(options_.make_probe_runner ? options_.make_probe_runner() : std::make_unique<ThreadProbeRunner>(),
                   clock_);
    // Nothing is lit yet, so nothing misses a refresh while this thread probes.
    for (CardState& card : cards_)
      TRY(take_reading(&card, card.heads->card().read_connectors([](std::uint32_t) { return true; })));
    assign_connectors_to_heads();
    return recover();
  }

  ~DrmOutput() override {
    watch_.reset();  // Ends a reading, which uses the cards.
    // Destroys GL objects and framebuffers before the context and the cards.
    for (CardState& card : cards_) card.heads->release();
    canvases_.clear();
    copier_.reset();
    gpu_.reset();
  }
  DrmOutput(const DrmOutput&) = delete;
  DrmOutput& operator=(const DrmOutput&) = delete;

  [[nodiscard]] const std::vector<HeadMode>& heads() const override { return modes_; }
  [[nodiscard]] double refresh_hz() const override { return pace_.refresh_hz(); }
  [[nodiscard]] const Gl& gl() const override { return gpu_->gl(); }
  [[nodiscard]] const std::vector<HeadShown>& shown() const override { return shown_; }

  [[nodiscard]] std::string kind() const override {
    std::string text = "DRM";
    for (const CardState& card : cards_) text += " " + card.heads->card().path().string();
    for (std::size_t head = 0; head < modes_.size(); ++head)
      text += fmt::format("; {}: {}", modes_[head].name, text_of_head(head));
    return text;
  }

  Status wait_for_refresh() override {
    if (gpu_->is_lost()) return lost("the graphics processor was reset");
    notice_sleep();
    TRY(notice_connectors());
    TRY(recover());
    clock_.wait_until(pace_.begin_at());
    begun_at_ = clock_.now();
    return Done{};
  }

  Status draw_to(std::size_t head) override {
    CHECK(head < canvases_.size());
    gl().BindFramebuffer(GL_FRAMEBUFFER, canvases_[head].framebuffer());
    gl().Viewport(0, 0, modes_[head].width_px, modes_[head].height_px);
    is_drawn_[head] = true;
    return Done{};
  }

  Result<Presented> present() override {
    for (CardState& card : cards_) {
      card.has_begun = true;
      if (auto begun = card.heads->begin(); !begun) {
        card.has_begun = false;
        TRY(take_failure(&card, std::move(begun).error()));
      }
      for (std::size_t head = 0; head < modes_.size(); ++head) {
        if (is_drawn_[head]) card.heads->draw(head);
      }
      if (card.has_begun) card.heads->paint(*copier_, pace_.refresh_hz(), card.needs_light);
    }
    is_drawn_.assign(is_drawn_.size(), false);
    const std::optional<GpuFence> fence = end_drawing();
    TRY(gl().check("presenting"));
    if (!fence) pace_.drawn(clock_.now() - begun_at_);
    TRY_ASSIGN(std::optional<Flipped> shown, flip(fence ? fence->fd() : -1));
    if (fence && shown) notice_end_of_drawing(*fence);
    if (!shown) {
      clock_.wait_until(pace_.next_at());
      shown = Flipped{clock_.now(), false};
    }
    set_rate();
    pace_.shown(shown->at, shown->has_vblank);
    for (std::size_t head = 0; head < modes_.size(); ++head) shown_[head] = shown_on_its_card(head);
    return Presented{pace_.number(), pace_.shown_at()};
  }

 private:
  static Error lost(std::string_view why) { return Error(ErrorCode::kUnavailable, fmt::format("DRM: {}", why)); }

  [[nodiscard]] bool is_awake() const { return options_.is_awake == nullptr || *options_.is_awake; }

  [[nodiscard]] HeadShown shown_on_its_card(std::size_t head) const {
    for (const CardState& card : cards_) {
      if (card.heads->is_showing(head)) return card.heads->shown(head);
    }
    return {};
  }

  /// Returns the fence for which the commits must wait; nothing if the pictures are complete, because this waited for
  /// the GPU: a card or the driver has no fences.
  std::optional<GpuFence> end_drawing() {
    const auto takes_fences = [](const CardState& card) { return card.heads->takes_fences(); };
    if (uses_fences_ && std::all_of(cards_.begin(), cards_.end(), takes_fences)) {
      if (auto fence = gpu_->fence()) return fence;
    }
    gl().Finish();
    return std::nullopt;
  }

  /// Commits what was painted, and waits for the heads that set the pace. Returns when the last of them showed its
  /// picture; nothing if none did.
  Result<std::optional<Flipped>> flip(int fence) {
    for (CardState& card : cards_) {
      if (!card.has_begun || !card.heads->is_painted()) continue;
      auto flipped = card.heads->flip(fence, options_.flip_timeout);
      if (!flipped) TRY(take_failure(&card, std::move(flipped).error()));
    }
    std::optional<Flipped> last;
    for (CardState& card : cards_) {
      auto flipped = card.heads->wait(pace_.refresh_hz());
      if (!flipped) {
        TRY(take_failure(&card, std::move(flipped).error()));
        continue;
      }
      if (!*flipped) continue;
      card.busy_flips = 0;
      if (!last || last->at < (*flipped)->at) last = **flipped;
    }
    return last;
  }

  /// The GPU works on after the commands were issued, so the drawing time follows from the fence.
  void notice_end_of_drawing(const GpuFence& fence) {
    const std::optional<TimePoint> reached = fence.reached_at();
    uses_fences_ = reached.has_value();
    if (reached) pace_.drawn(*reached - begun_at_);
  }

  [[nodiscard]] std::string text_of_head(std::size_t head) const {
    for (const CardState& card : cards_) {
      if (card.heads->is_showing(head)) return card.heads->text_of_head(head);
    }
    return connectors_.empty() || !connectors_[head] ? "no connector yet" : connectors_[head]->connector + " is dark";
  }

  /// Records that the card must be lit again; the delay depends on the number of failures. Errors: kUnavailable if only
  /// a new output helps.
  Status take_failure(CardState* card, Error error) {
    if (is_card_lost(error)) return lost(error.message());
    if (error.errno_value() == EBUSY && !card->needs_light && ++card->busy_flips <= kMaxBusyFlips) return Done{};
    card->needs_light = true;
    card->heads->lose();
    watch_->ask(clock_.now());  // The connectors may be the reason.
    card->has_lost_master = is_master_lost(error);
    // Another program may hold the card for any length of time; that does not count as a failure.
    if (!card->has_lost_master && ++card->failures > kMaxFailures) return lost(error.message());
    card->retry_at = clock_.now() + backoff(card->failures);
    return Done{};
  }

  void notice_sleep() {
    const bool awake = is_awake();
    if (awake == was_awake_) return;
    was_awake_ = awake;
    for (CardState& card : cards_) card.needs_light = true;
    if (awake) watch_->ask(clock_.now());
  }

  /// Has the connectors read if something may have changed, and takes in what was read.
  Status notice_connectors() {
    if (was_awake_) {
      std::vector<WatchedCard> watched;
      for (const CardState& card : cards_) watched.push_back({&card.heads->card(), card.heads->lit_connectors()});
      watch_->step(is_any_dark(), std::move(watched));
    }
    auto read = watch_->take();
    if (!read) return Done{};
    for (std::size_t i = 0; i < cards_.size(); ++i) TRY(take_reading(&cards_[i], std::move((*read)[i])));
    assign_connectors_to_heads();
    for (CardState& card : cards_) {
      // Connected but dark heads are retried, too, since new modes of other heads may have freed bandwidth.
      if (has_dark(card)) card.needs_light = true;
    }
    return Done{};
  }

  /// Errors: kUnavailable if only a new output helps.
  Status take_reading(CardState* card, Result<std::vector<Connector>> read) {
    if (!read) {
      if (is_card_lost(read.error())) return lost(read.error().message());
      watch_->ask(clock_.now() + backoff(++card->failed_readings));
      return Done{};
    }
    card->failed_readings = 0;
    const bool is_same = std::equal(read->begin(), read->end(), card->connectors.begin(), card->connectors.end(),
                                    [](const Connector& a, const Connector& b) { return a.is_same_as(b); });
    if (!is_same) card->needs_light = true;
    card->connectors = *std::move(read);
    return Done{};
  }

  [[nodiscard]] Duration backoff(int failures) const {
    return std::min<Duration>(kMaxBackoff, (pace_.next_at() - pace_.shown_at()) * (failures / 3));
  }

  [[nodiscard]] bool has_dark(const CardState& card) const {
    for (std::size_t head = 0; head < modes_.size(); ++head) {
      const Connector* const connector = connector_of(head, card);
      if (connector != nullptr && connector->is_connected && !card.heads->is_showing(head)) return true;
    }
    return false;
  }

  [[nodiscard]] bool is_any_dark() const {
    for (std::size_t head = 0; head < modes_.size(); ++head) {
      const auto shows = [&](const CardState& card) { return card.heads->is_showing(head); };
      if (std::none_of(cards_.begin(), cards_.end(), shows)) return true;
    }
    return false;
  }

  /// Returns null if the head's connector is not on this card.
  [[nodiscard]] const Connector* connector_of(std::size_t head, const CardState& card) const {
    if (connectors_.empty() || !connectors_[head] || &cards_[connectors_[head]->card] != &card) return nullptr;
    const auto found = std::find_if(card.driven.begin(), card.driven.end(),
                                    [&](const Connector& c) { return c.name == connectors_[head]->connector; });
    return found == card.driven.end() ? nullptr : &*found;
  }

  /// Applies a head's own EDID to its connector.
  void replace_edid(std::size_t head) {
    const DrmHead& options = options_.heads[head];
    if (!options.edid || !connectors_[head]) return;
    for (Connector& connector : cards_[connectors_[head]->card].driven) {
      if (connector.name != connectors_[head]->connector) continue;
      connector.is_connected = connector.is_connected || options.is_always_connected;
      connector.edid = options.edid;
      connector.edid_fault.clear();
      connector.modes = modes_of(options.edid->timings);
    }
  }

  Status recover() {
    for (CardState& card : cards_) {
      if (!card.needs_light || clock_.now() < card.retry_at || !card.heads->can_light()) continue;
      if (card.has_lost_master) {
        // The errno is that of a lost master, even if become_master() failed for another reason.
        if (!card.heads->card().become_master()) {
          TRY(take_failure(&card, kms_error(-EACCES, "waiting for the card")));
          continue;
        }
        card.has_lost_master = false;
      }
      const bool is_any_showing =
          std::any_of(cards_.begin(), cards_.end(), [](const CardState& c) { return c.heads->is_any_showing(); });
      auto lit = card.heads->light(*gpu_, *copier_, card.driven, targets_of(card), !is_any_showing);
      if (!lit) {
        TRY(take_failure(&card, std::move(lit).error()));
        continue;
      }
      card.needs_light = false;
      card.failures = 0;
      card.busy_flips = 0;
    }
    set_rate();
    return Done{};
  }

  /// Considers all connectors of all cards, connected or not.
  void assign_connectors_to_heads() {
    std::vector<AvailableConnector> seen;
    for (std::size_t i = 0; i < cards_.size(); ++i) {
      for (const Connector& connector : cards_[i].connectors)
        seen.push_back({{i, connector.name}, connector.is_connected, connector.edid ? connector.edid->serial : ""});
    }
    auto assigned = assign_connectors(preferences_, seen, connectors_);
    if (assigned != connectors_) {
      for (CardState& card : cards_) card.needs_light = true;
    }
    connectors_ = std::move(assigned);
    for (CardState& card : cards_) card.driven = card.connectors;
    for (std::size_t head = 0; head < modes_.size(); ++head) replace_edid(head);
  }

  [[nodiscard]] std::vector<HeadTarget> targets_of(const CardState& card) const {
    std::vector<HeadTarget> targets;
    if (!was_awake_) return targets;
    for (std::size_t head = 0; head < modes_.size(); ++head) {
      const Connector* const connector = connector_of(head, card);
      if (connector == nullptr || !connector->is_connected) continue;
      targets.push_back({head, connector, &canvases_[head], options_.heads[head].rotation, options_.refresh_hz});
    }
    return targets;
  }

  void set_rate() {
    double fastest = 0.0;
    for (const CardState& card : cards_) fastest = std::max(fastest, card.heads->refresh_hz());
    pace_.set_rate(fastest == 0.0 ? options_.refresh_hz : fastest);
  }

  DrmOptions options_;
  const Clock& clock_;
  std::vector<HeadMode> modes_;
  std::vector<ConnectorPreference> preferences_;
  std::vector<std::optional<ConnectorId>> connectors_;
  std::vector<CardState> cards_;
  std::unique_ptr<GpuContext> gpu_;
  std::optional<CanvasCopier> copier_;
  std::vector<Canvas> canvases_;
  std::vector<bool> is_drawn_;
  std::vector<HeadShown> shown_;
  std::optional<ConnectorWatch> watch_;
  bool uses_fences_ = true;  // False once the driver's fences did not tell when they were reached.
  bool was_awake_ = true;
  RefreshPace pace_;
  TimePoint begun_at_{};
};

}  // namespace

Result<std::unique_ptr<Output>> open_drm_output(const DrmOptions& options, const Clock& clock) {
  if (options.heads.empty()) return Error(ErrorCode::kInvalidArgument, "an output needs at least one head");
  if (!(options.refresh_hz >= kMinHz && options.refresh_hz <= kMaxHz)) {
    return Error(ErrorCode::kInvalidArgument,
                 fmt::format("a refresh rate of {} Hz; it must be {} to {}", options.refresh_hz, kMinHz, kMaxHz));
  }
  auto output = std::make_unique<DrmOutput>(options, clock);
  TRY(output->open());
  return std::unique_ptr<Output>(std::move(output));
}

}  // namespace cyclorama::output
