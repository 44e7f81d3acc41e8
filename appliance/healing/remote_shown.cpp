// SPDX-License-Identifier: Apache-2.0
#include "appliance/healing/remote_shown.h"

#include <fmt/format.h>

#include <algorithm>

#include "appliance/healing/estimator/exposure_timing.h"
#include "common/base/clock_offset.h"
#include "common/image/jpeg.h"
#include "common/wire/channel.h"
#include "common/wire/show.grpc.pb.h"

namespace cyclorama::healing {
namespace {

constexpr Duration kAnswerTimeout = std::chrono::seconds(2);
constexpr Duration kRetryAfter = std::chrono::milliseconds(15);
constexpr int kMaxRequests = 20;      // A third of a second: some refreshes of any projector.
constexpr int kMaxFirstRequests = 8;  // Attempts to measure the clock offset; at least one should be fast enough.
// Margins around an exposure: pictures of earlier and later times are compared too, and a camera's clock may be wrong.
constexpr Duration kShownBefore = kTimeDoubt + std::chrono::milliseconds(100);
constexpr Duration kShownAfter = kTimeDoubt + std::chrono::milliseconds(40);
constexpr Duration kSureEnough = kTimeDoubt / 2;

}  // namespace

class RemoteShown::Display {
 public:
  struct Head {
    std::string name;
    std::size_t projector;
    int width_px;
    int height_px;
  };
  static Result<std::unique_ptr<Display>> open(const std::string& address, int factor, std::vector<Head> heads,
                                               const Clock& clock) {
    TRY_ASSIGN(std::shared_ptr<grpc::Channel> channel, make_channel(address));
    return std::unique_ptr<Display>(new Display(address, factor, std::move(heads), std::move(channel), clock));
  }

  Status between(TimePoint opened, TimePoint closed, Duration latency, Shown* ret_shown) {
    // The first requests, which are empty, measure the clock offset: without it the display's times cannot be
    // converted.
    for (int asks = 0; asks < kMaxFirstRequests && !is_sure(); ++asks) TRY(ask(TimePoint{}, TimePoint{}));
    const TimePoint from = opened - latency - kShownBefore;
    const TimePoint until = closed - latency + kShownAfter;
    for (int asks = 0;; ++asks) {
      TRY(ask(from, until));
      if (has_begun_anew()) {
        known_ = 0;
        TRY(ask(from, until));
      }
      if (from_nanoseconds(reply_.known_until_ns()) >= to_theirs(until)) break;
      if (asks == kMaxRequests) {
        return Error(ErrorCode::kTimedOut, fmt::format("the display at {} does not refresh; see its state", address_));
      }
      std::this_thread::sleep_for(kRetryAfter);
    }
    const bool is_told =
        !reply_.moments().empty() && from_nanoseconds(reply_.moments(0).shown_ns()) <= to_theirs(opened - latency);
    ret_shown->is_show = ret_shown->is_show && is_told && is_sure();
    for (const wire::ShownMoment& moment : reply_.moments()) {
      ret_shown->is_show = ret_shown->is_show && moment.is_show();
      if (!moment.is_show() || moment.number() <= known_) continue;
      TRY(take(moment, latency, ret_shown));
    }
    if (!reply_.moments().empty()) {
      const std::uint64_t last = reply_.moments(reply_.moments_size() - 1).number();
      const TimePoint known_until = std::min(from_nanoseconds(reply_.known_until_ns()) - ahead(), until) + latency;
      for (const Head& head : heads_) ret_shown->until.push_back({head.projector, known_until, last});
    }
    return Done{};
  }

 private:
  Display(std::string address, int factor, std::vector<Head> heads, std::shared_ptr<grpc::Channel> channel,
          const Clock& clock)
      : address_(std::move(address)),
        factor_(factor),
        heads_(std::move(heads)),
        channel_(std::move(channel)),
        stub_(wire::ShownPictures::NewStub(channel_)),
        clock_(clock) {}

  /// Returns the display's clock minus this computer's clock.
  [[nodiscard]] Duration ahead() const {
    const ClockReading reading = offset_.reading(clock_.now());
    return std::chrono::nanoseconds(reading.is_known ? static_cast<std::int64_t>(reading.offset_ns) : 0);
  }
  [[nodiscard]] bool is_sure() const {
    const ClockReading reading = offset_.reading(clock_.now());
    return reading.is_known && reading.error <= kSureEnough;
  }
  /// True if the display was restarted and counts from 1 again; its earlier pictures are unknown in that case.
  [[nodiscard]] bool has_begun_anew() const {
    return !reply_.moments().empty() && reply_.moments(reply_.moments_size() - 1).number() < known_;
  }
  [[nodiscard]] TimePoint to_theirs(TimePoint ours) const { return ours + ahead(); }

  Status ask(TimePoint from, TimePoint until) {
    wire::ShownRequest request;
    request.set_from_ns(to_nanoseconds(to_theirs(from)));
    request.set_until_ns(to_nanoseconds(to_theirs(until)));
    request.set_factor(static_cast<std::uint32_t>(factor_));
    request.set_known(known_);
    grpc::ClientContext context;
    context.set_deadline(std::chrono::system_clock::now() + kAnswerTimeout);
    context.set_wait_for_ready(false);
    reply_.Clear();
    const TimePoint asked = clock_.now();
    const grpc::Status status = stub_->GetShown(&context, request, &reply_);
    const TimePoint answered = clock_.now();
    if (!status.ok()) return from_grpc(status, fmt::format("asking the display at {} what it shows", address_));
    // The display's processing time is not part of the network's delay.
    offset_.add({asked, reply_.received_ns(), reply_.answered_ns(), answered});
    return Done{};
  }

  Status take(const wire::ShownMoment& moment, Duration latency, Shown* ret_shown) {
    if (moment.heads().empty()) return Done{};
    const TimePoint lit_at = from_nanoseconds(moment.shown_ns()) - ahead() + latency;
    for (const wire::ShownHead& head : moment.heads()) {
      const auto known = std::ranges::find(heads_, head.projector(), &Head::name);
      if (known == heads_.end()) continue;  // The head belongs to another calibrator.
      RgbImage picture(known->width_px, known->height_px);
      const auto bytes = std::as_bytes(std::span(head.jpeg()));
      TRY(decoder_.decode_into(bytes, picture.data().data(), picture.width(), picture.height(),
                               3 * static_cast<std::size_t>(picture.width())));
      ret_shown->pictures.push_back(
          {known->projector, lit_at, std::make_shared<const RgbImage>(std::move(picture)), moment.number()});
    }
    known_ = moment.number();
    return Done{};
  }

  std::string address_;
  int factor_;
  std::vector<Head> heads_;
  std::shared_ptr<grpc::Channel> channel_;
  std::unique_ptr<wire::ShownPictures::Stub> stub_;
  const Clock& clock_;
  ClockOffset offset_;
  std::uint64_t known_ = 0;
  wire::ShownReply reply_;
  JpegDecoder decoder_;
};

RemoteShown::RemoteShown(Duration latency, const Clock& clock) : latency_(latency), clock_(clock) {}
RemoteShown::~RemoteShown() = default;

Result<std::unique_ptr<RemoteShown>> RemoteShown::open(const std::vector<InstalledProjector>& projectors,
                                                       const std::vector<scan::PatternDisplay>& displays, int factor,
                                                       Duration latency, const Clock& clock) {
  std::vector<std::vector<Display::Head>> heads(displays.size());
  for (std::size_t i = 0; i < projectors.size(); ++i) {
    TRY_ASSIGN(const std::size_t display, scan::display_of(projectors[i].name, displays));
    const Pinhole& lens = projectors[i].lens;
    heads[display].push_back({projectors[i].name, i, lens.width_px / factor, lens.height_px / factor});
  }
  std::unique_ptr<RemoteShown> shown(new RemoteShown(latency, clock));
  for (std::size_t d = 0; d < displays.size(); ++d) {
    TRY_ASSIGN(auto display, Display::open(displays[d].address, factor, std::move(heads[d]), clock));
    shown->displays_.push_back(std::move(display));
  }
  return shown;
}

Result<RemoteShown::Shown> RemoteShown::between(TimePoint opened, TimePoint closed) {
  Shown shown;
  for (const auto& display : displays_) TRY(display->between(opened, closed, latency_, &shown));
  return shown;
}

}  // namespace cyclorama::healing
