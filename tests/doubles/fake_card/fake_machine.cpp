// SPDX-License-Identifier: Apache-2.0
#include "tests/doubles/fake_card/fake_machine.h"

#include <drm_fourcc.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <numeric>

#include "common/base/check.h"

namespace cyclorama {
namespace {

FakeMachine* the_machine = nullptr;

const std::vector<std::string>& property_names() {
  static const std::vector<std::string> names{"ACTIVE", "MODE_ID", "CRTC_ID", "FB_ID",       "SRC_X",      "SRC_Y",
                                              "SRC_W",  "SRC_H",   "CRTC_X",  "CRTC_Y",      "CRTC_W",     "CRTC_H",
                                              "type",   "EDID",    "max bpc", "link-status", "IN_FENCE_FD"};
  return names;
}

std::uint64_t value_of(const FakeMachine::State& state, std::uint32_t object, const std::string& name) {
  const auto found = state.find({object, FakeMachine::property_id(name)});
  return found == state.end() ? 0 : found->second;
}

std::optional<drmModeModeInfo> mode_in(const FakeMachine::CardState& card, std::uint64_t blob) {
  const auto found = card.blobs.find(static_cast<std::uint32_t>(blob));
  if (found == card.blobs.end() || found->second.size() != sizeof(drmModeModeInfo)) return std::nullopt;
  drmModeModeInfo mode;
  std::memcpy(&mode, found->second.data(), sizeof mode);
  return mode;
}

bool is_same(const std::optional<drmModeModeInfo>& a, const std::optional<drmModeModeInfo>& b) {
  if (!a || !b) return !a && !b;
  return a->clock == b->clock && a->hdisplay == b->hdisplay && a->vdisplay == b->vdisplay;
}

}  // namespace

drmModeModeInfo fake_mode(int width_px, int height_px, double refresh_hz, bool is_preferred) {
  drmModeModeInfo mode{};
  const auto u16 = [](int value) { return static_cast<std::uint16_t>(value); };
  mode.hdisplay = u16(width_px);
  mode.hsync_start = u16(width_px + 8);
  mode.hsync_end = u16(width_px + 16);
  // Wide enough that a clock in whole kHz gives small pictures the exact rate too.
  mode.htotal = u16(8 * (width_px + 40));
  mode.vdisplay = u16(height_px);
  mode.vsync_start = u16(height_px + 2);
  mode.vsync_end = u16(height_px + 4);
  mode.vtotal = u16(8 * (height_px + 14));
  mode.clock = static_cast<std::uint32_t>(refresh_hz * mode.htotal * mode.vtotal / 1000.0 + 0.5);
  mode.vrefresh = static_cast<std::uint32_t>(refresh_hz + 0.5);
  mode.type = DRM_MODE_TYPE_DRIVER | (is_preferred ? DRM_MODE_TYPE_PREFERRED : 0U);
  return mode;
}

std::vector<std::uint8_t> fake_edid(const std::string& model, int colour_bits, const std::string& serial) {
  std::vector<std::uint8_t> edid(128, 0);
  for (std::size_t i = 1; i < 7; ++i) edid[i] = 0xff;
  edid[8] = 0x0c;  // The letters "CYC" are 3, 25 and 3, with five bits each.
  edid[9] = 0x23 | 0x00;
  edid[8] = static_cast<std::uint8_t>((3 << 2) | (25 >> 3));
  edid[9] = static_cast<std::uint8_t>(((25 & 7) << 5) | 3);
  edid[10] = 0x34;
  edid[11] = 0x12;
  edid[18] = 1;
  edid[19] = 4;
  edid[20] = static_cast<std::uint8_t>(0x80 | (colour_bits == 0 ? 0 : (colour_bits / 2 - 2) << 4));
  const auto add_text = [&](std::size_t at, std::uint8_t kind, const std::string& text) {
    edid[at + 3] = kind;
    for (std::size_t i = 0; i < 13; ++i)
      edid[at + 5 + i] = static_cast<std::uint8_t>(i < text.size() ? text[i] : i == text.size() ? '\n' : ' ');
  };
  add_text(54, 0xfc, model);
  if (!serial.empty()) add_text(72, 0xff, serial);
  const unsigned sum = std::accumulate(edid.begin(), edid.end(), 0U);
  edid[127] = static_cast<std::uint8_t>(256 - sum % 256);
  return edid;
}

FakeCard three_projectors() {
  FakeCard card;
  for (std::uint32_t number = 1; number <= 3; ++number) {
    FakeConnector connector;
    connector.number = number;
    connector.modes = {fake_mode(64, 36, 60.0, true)};
    connector.edid = fake_edid("P" + std::to_string(number), 8);
    card.connectors.push_back(connector);
  }
  return card;
}

FakeMachine::FakeMachine(std::vector<FakeCard> cards, FakeClock* clock) : clock_(clock) {
  CHECK(the_machine == nullptr);
  the_machine = this;
  for (FakeCard& card : cards) {
    cards_.push_back(std::make_unique<CardState>());
    cards_.back()->card = std::move(card);
  }
}

FakeMachine::~FakeMachine() { the_machine = nullptr; }

FakeMachine& FakeMachine::the() {
  CHECK(the_machine != nullptr);
  return *the_machine;
}

FakeMachine* FakeMachine::the_or_null() { return the_machine; }

FakeConnector& FakeMachine::connector(std::size_t card, std::size_t number) {
  return cards_.at(card)->card.connectors.at(number);
}

void FakeMachine::fail(const std::string& call, int error, int passes) { fault_ = Fault{call, error, passes}; }

int FakeMachine::meet(const char* call) {
  ++calls_[call];
  if (!fault_ || fault_->call != call || fault_->passes-- > 0) return 0;
  const int error = fault_->error;
  fault_.reset();
  return error;
}

namespace {

/// Jobs whose end comes in simulated time.
class SimulatedProbeRunner final : public output::ProbeRunner {
 public:
  explicit SimulatedProbeRunner(FakeMachine* machine) : machine_(*machine) {}
  void start(std::function<void()> job) override { done_at_ = machine_.run_beside(job); }
  [[nodiscard]] bool is_idle() override { return machine_.clock().now() >= done_at_; }

 private:
  FakeMachine& machine_;
  TimePoint done_at_{};
};

}  // namespace

std::unique_ptr<output::ProbeRunner> FakeMachine::probe_runner() {
  return std::make_unique<SimulatedProbeRunner>(this);
}

void FakeMachine::spend(Duration time) {
  if (beside_) {
    *beside_ += time;
  } else {
    clock_->advance(time);
  }
}

TimePoint FakeMachine::run_beside(const std::function<void()>& job) {
  beside_ = Duration::zero();
  job();
  beside_until_ = clock_->now() + *beside_;
  beside_.reset();
  return beside_until_;
}

void FakeMachine::lock_connectors() {
  if (!beside_) clock_->wait_until(beside_until_);
}

bool FakeMachine::has_fences() const {
  return std::all_of(cards_.begin(), cards_.end(), [](const auto& card) { return card->card.has_fences; });
}

void FakeMachine::forget_commits(std::size_t card) {
  cards_.at(card)->events.clear();
  cards_.at(card)->flipping.clear();
}

void FakeMachine::set_master_taken(std::size_t card, bool is_taken) {
  cards_.at(card)->is_master_taken = is_taken;
  if (is_taken) cards_.at(card)->master_fd = -1;
}

FakeMachine::CardState* FakeMachine::card_of(int fd) {
  const auto found = fds_.find(fd);
  return found == fds_.end() ? nullptr : found->second;
}

FakeMachine::CardState* FakeMachine::card_at(const std::string& path) {
  for (const auto& card : cards_) {
    if (card->card.path == path) return card.get();
  }
  return nullptr;
}

void FakeMachine::opened(int fd, CardState* card) {
  fds_[fd] = card;
  if (card->master_fd < 0 && !card->is_master_taken) card->master_fd = fd;
}

void FakeMachine::closed(int fd) {
  const auto found = fds_.find(fd);
  if (found == fds_.end()) return;
  CardState& card = *found->second;
  fds_.erase(found);
  if (card.master_fd != fd) return;
  // The kernel removes the objects that the file created, and connectors that show them go dark.
  card.master_fd = -1;
  card.framebuffers.clear();
  card.imported.clear();
  card.events.clear();
  card.flipping.clear();
  card.state.clear();
}

std::optional<drmModeModeInfo> FakeMachine::mode_of(std::size_t card, std::size_t number) const {
  const CardState& state = *cards_.at(card);
  const auto connector = static_cast<std::uint32_t>(kFirstConnector + number);
  const auto crtc = static_cast<std::uint32_t>(value_of(state.state, connector, "CRTC_ID"));
  if (crtc == 0 || value_of(state.state, crtc, "ACTIVE") == 0) return std::nullopt;
  if (!state.card.connectors.at(number).is_connected) return std::nullopt;
  return mode_in(state, value_of(state.state, crtc, "MODE_ID"));
}

namespace {

const FakeMachine::Framebuffer* framebuffer_of(const FakeMachine::CardState& state, std::size_t number) {
  const auto connector = static_cast<std::uint32_t>(FakeMachine::kFirstConnector + number);
  const auto crtc = static_cast<std::uint32_t>(value_of(state.state, connector, "CRTC_ID"));
  const std::uint32_t plane = FakeMachine::kFirstPrimary + (crtc - FakeMachine::kFirstCrtc);
  const auto found = state.framebuffers.find(static_cast<std::uint32_t>(value_of(state.state, plane, "FB_ID")));
  return found == state.framebuffers.end() ? nullptr : &found->second;
}

}  // namespace

RgbImage read_buffer(const gbm_bo& buffer);  // Defined in fake_gpu.cpp.

std::optional<RgbImage> FakeMachine::wall(std::size_t card, std::size_t number) const {
  if (!mode_of(card, number)) return std::nullopt;
  const Framebuffer* const framebuffer = framebuffer_of(*cards_.at(card), number);
  if (framebuffer == nullptr || framebuffer->buffer == nullptr) return std::nullopt;
  return read_buffer(*framebuffer->buffer);
}

bool FakeMachine::is_deep(std::size_t card, std::size_t number) const {
  const Framebuffer* const framebuffer = framebuffer_of(*cards_.at(card), number);
  return framebuffer != nullptr && framebuffer->format == DRM_FORMAT_XRGB2101010;
}

int FakeMachine::commits(std::size_t card) const { return cards_.at(card)->commits; }
int FakeMachine::modesets(std::size_t card) const { return cards_.at(card)->modesets; }

const std::vector<TimePoint>& FakeMachine::shown_at(std::size_t card, std::size_t number) const {
  static const std::vector<TimePoint> kNone;
  const CardState& state = *cards_.at(card);
  const auto crtc = static_cast<std::uint32_t>(
      value_of(state.state, static_cast<std::uint32_t>(kFirstConnector + number), "CRTC_ID"));
  const auto found = state.shown_at.find(crtc);
  return found == state.shown_at.end() ? kNone : found->second;
}

std::size_t FakeMachine::held() const {
  return buffers.size() + gbm_devices + contexts + images + udev_objects + fds_.size() + shared.size();
}

std::uint32_t FakeMachine::property_id(const std::string& name) {
  const auto& names = property_names();
  const auto found = std::find(names.begin(), names.end(), name);
  CHECK(found != names.end());
  return static_cast<std::uint32_t>(1000 + (found - names.begin()));
}

std::string FakeMachine::property_name(std::uint32_t id) { return property_names().at(id - 1000); }

int FakeMachine::commit(CardState* card, const State& changes, std::uint32_t flags, void* cookie, int fd) {
  if (card->master_fd != fd) return EACCES;
  State wanted = card->state;
  std::set<std::uint32_t> touched;
  for (const auto& [key, value] : changes) {
    wanted[key] = value;
    const auto [object, property] = key;
    if (object >= kFirstCrtc && object < kFirstConnector) touched.insert(object);
  }
  for (const auto& [key, value] : changes) {
    if (key.first >= kFirstPrimary) {
      const auto crtc = static_cast<std::uint32_t>(value_of(wanted, key.first, "CRTC_ID"));
      if (crtc != 0) touched.insert(crtc);
    }
  }
  const bool allows_modeset = (flags & DRM_MODE_ATOMIC_ALLOW_MODESET) != 0;
  if (const int refused = refusal(*card, wanted, allows_modeset); refused != 0) return refused;
  if ((flags & DRM_MODE_ATOMIC_TEST_ONLY) != 0) return 0;
  const bool does_not_wait = (flags & DRM_MODE_ATOMIC_NONBLOCK) != 0;
  for (const std::uint32_t crtc : touched) {
    const auto before = card->flipping.find(crtc);
    if (before == card->flipping.end() || before->second <= clock_->now()) continue;
    if (does_not_wait) return EBUSY;
    clock_->wait_until(before->second);
  }
  const Duration takes = modeset_time(*card, wanted);
  if (!does_not_wait) clock_->advance(takes);
  const TimePoint ready = std::max(clock_->now(), fence_of(changes)) + (does_not_wait ? takes : Duration::zero());
  card->state = wanted;
  ++card->commits;
  if (allows_modeset) ++card->modesets;
  const bool has_event = (flags & DRM_MODE_PAGE_FLIP_EVENT) != 0 && meet("page flip event") == 0;
  for (const std::uint32_t crtc : touched) {
    const TimePoint due = next_vertical_blank(*card, crtc, ready);
    card->shown_at[crtc].push_back(due);
    if (!has_event) continue;
    card->events.push_back({crtc, cookie, due});
    card->flipping[crtc] = due;
  }
  return 0;
}

TimePoint FakeMachine::fence_of(const State& changes) const {
  TimePoint latest{};
  for (const auto& [key, value] : changes) {
    if (property_name(key.second) != "IN_FENCE_FD") continue;
    const auto fence = fences.find(static_cast<int>(value));
    CHECK(fence != fences.end());
    latest = std::max(latest, fence->second);
  }
  return latest;
}

/// The longest of the connectors that this commit lights or gives another mode.
Duration FakeMachine::modeset_time(const CardState& card, const State& wanted) const {
  Duration longest{};
  for (std::uint32_t i = 0; i < card.card.connectors.size(); ++i) {
    const std::uint32_t connector = kFirstConnector + i;
    const auto crtc = static_cast<std::uint32_t>(value_of(wanted, connector, "CRTC_ID"));
    if (crtc == 0 || value_of(wanted, crtc, "ACTIVE") == 0) continue;
    const bool is_kept =
        value_of(card.state, connector, "CRTC_ID") == crtc && value_of(card.state, crtc, "ACTIVE") != 0 &&
        is_same(mode_in(card, value_of(card.state, crtc, "MODE_ID")), mode_in(card, value_of(wanted, crtc, "MODE_ID")));
    if (!is_kept) longest = std::max(longest, card.card.connectors[i].modeset_time);
  }
  return longest;
}

TimePoint FakeMachine::next_vertical_blank(const CardState& card, std::uint32_t crtc, TimePoint after) const {
  const auto mode = mode_in(card, value_of(card.state, crtc, "MODE_ID"));
  if (!card.card.has_raster || !mode || mode->vrefresh == 0) return after;
  const std::int64_t period_ns = (1'000'000'000 + mode->vrefresh / 2) / mode->vrefresh;
  return from_nanoseconds((to_nanoseconds(after) / period_ns + 1) * period_ns);
}

/// Makes the checks of the kernel's drm_atomic_check_only() for the errors that our driver could make.
int FakeMachine::refusal(const CardState& card, const State& wanted, bool allows_modeset) const {
  bool is_modeset = false;
  for (std::uint32_t i = 0; i < card.card.crtcs; ++i) {
    const std::uint32_t crtc = kFirstCrtc + i;
    is_modeset |= value_of(card.state, crtc, "ACTIVE") != value_of(wanted, crtc, "ACTIVE");
    is_modeset |= !is_same(mode_in(card, value_of(card.state, crtc, "MODE_ID")),
                           mode_in(card, value_of(wanted, crtc, "MODE_ID")));
  }
  for (std::uint32_t i = 0; i < card.card.connectors.size(); ++i) {
    is_modeset |=
        value_of(card.state, kFirstConnector + i, "CRTC_ID") != value_of(wanted, kFirstConnector + i, "CRTC_ID");
  }
  if (is_modeset && !allows_modeset) return EINVAL;
  if (const int refused = refusal_of_modes(card, wanted); refused != 0) return refused;
  return refusal_of_planes(card, wanted);
}

int FakeMachine::refusal_of_modes(const CardState& card, const State& wanted) const {
  std::uint64_t clock_khz = 0;
  for (std::uint32_t i = 0; i < card.card.crtcs; ++i) {
    const std::uint32_t crtc = kFirstCrtc + i;
    const auto mode = mode_in(card, value_of(wanted, crtc, "MODE_ID"));
    const bool is_active = value_of(wanted, crtc, "ACTIVE") != 0;
    std::size_t connectors = 0;
    for (std::size_t c = 0; c < card.card.connectors.size(); ++c) {
      if (value_of(wanted, static_cast<std::uint32_t>(kFirstConnector + c), "CRTC_ID") != crtc) continue;
      ++connectors;
      const FakeConnector& connector = card.card.connectors[c];
      if ((connector.possible_crtcs >> i & 1U) == 0 || !mode) return EINVAL;
      const bool is_offered = std::any_of(connector.modes.begin(), connector.modes.end(),
                                          [&](const drmModeModeInfo& m) { return is_same(m, mode); });
      if (!is_offered && mode->hdisplay != 1024) return EINVAL;
    }
    if (is_active != mode.has_value() || is_active != (connectors == 1)) return EINVAL;
    if (is_active) clock_khz += mode->clock;
  }
  return card.card.max_clock_khz != 0 && clock_khz > card.card.max_clock_khz ? ENOSPC : 0;
}

int FakeMachine::refusal_of_planes(const CardState& card, const State& wanted) const {
  for (std::uint32_t i = 0; i < card.card.crtcs; ++i) {
    const std::uint32_t plane = kFirstPrimary + i;
    const std::uint64_t crtc = value_of(wanted, plane, "CRTC_ID");
    const auto fb = card.framebuffers.find(static_cast<std::uint32_t>(value_of(wanted, plane, "FB_ID")));
    const bool has_fb = fb != card.framebuffers.end();
    if (has_fb != (crtc != 0) || (crtc != 0 && crtc != kFirstCrtc + i)) return EINVAL;
    if (value_of(wanted, kFirstCrtc + i, "ACTIVE") == 0) continue;
    const auto mode = mode_in(card, value_of(wanted, kFirstCrtc + i, "MODE_ID"));
    if (!has_fb || !mode) return EINVAL;
    if (fb->second.format == DRM_FORMAT_XRGB2101010 && !card.card.can_be_deep) return EINVAL;
    if (value_of(wanted, plane, "SRC_W") >> 16 > fb->second.width) return ENOSPC;
    if (value_of(wanted, plane, "CRTC_W") != mode->hdisplay || value_of(wanted, plane, "CRTC_H") != mode->vdisplay)
      return EINVAL;
    if (value_of(wanted, kFirstCursor + i, "FB_ID") != 0) return EINVAL;
  }
  return 0;
}

}  // namespace cyclorama
