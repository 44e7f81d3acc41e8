// SPDX-License-Identifier: Apache-2.0
#include "appliance/scan/remote_pattern_screen.h"

#include <fmt/format.h>

#include <algorithm>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <thread>

#include "common/image/png.h"
#include "common/wire/calibration.grpc.pb.h"
#include "common/wire/channel.h"

namespace cyclorama::scan {
namespace {
/// Must exceed the time for decoding a PNG of some megabytes and a refresh, and the ten seconds after which a display
/// reports a missing head.
constexpr Duration kAnswerTimeout = std::chrono::seconds(15);
}  // namespace

/// The stream of one display. A blocking read has no deadline, so a watchdog thread cancels a call that takes too long.
class RemotePatternScreen::Stream {
 public:
  static Result<std::unique_ptr<Stream>> open(const std::string& address) {
    TRY_ASSIGN(std::shared_ptr<grpc::Channel> channel, make_channel(address));
    std::unique_ptr<Stream> stream(new Stream(address, std::move(channel)));
    return stream;
  }
  ~Stream() {
    if (status_) return;  // The stream has already ended.
    // The end of the stream makes the display restore its previous picture.
    stream_->WritesDone();
    set_deadline(clock_.now() + kAnswerTimeout);
    wire::PatternShown ignored;
    while (stream_->Read(&ignored)) {
    }
    static_cast<void>(stream_->Finish());
  }
  Stream(const Stream&) = delete;
  Stream& operator=(const Stream&) = delete;

  Status order(const std::string& projector, std::string png) {
    wire::PatternRequest order;
    order.set_number(++number_);
    wire::HeadPattern* head = order.add_heads();
    head->set_projector(projector);
    head->set_png(std::move(png));
    if (is_over_) return lost();
    set_deadline(clock_.now() + kAnswerTimeout);
    wire::PatternShown shown;
    bool is_shown = stream_->Write(order);
    while (is_shown && (is_shown = stream_->Read(&shown)) && shown.number() != number_) {
    }
    set_deadline(std::nullopt);
    if (is_shown) return Done{};
    is_over_ = true;
    return lost();
  }

 private:
  Stream(std::string address, std::shared_ptr<grpc::Channel> channel)
      : address_(std::move(address)),
        channel_(std::move(channel)),
        stub_(wire::PatternScreen::NewStub(channel_)),
        stream_(stub_->ShowPatterns(&context_)),
        watch_([this](std::stop_token stop) { cancel_when_late(std::move(stop)); }) {}

  void set_deadline(std::optional<TimePoint> deadline) {
    const std::lock_guard lock(mutex_);
    deadline_ = deadline;
    changed_.notify_all();
  }
  void cancel_when_late(std::stop_token stop) {
    std::unique_lock lock(mutex_);
    while (!stop.stop_requested()) {
      if (!deadline_) {
        changed_.wait(lock, stop, [this] { return deadline_.has_value(); });
        continue;
      }
      const TimePoint deadline = *deadline_;
      const bool has_changed = changed_.wait_until(lock, stop, deadline, [&] { return deadline_ != deadline; });
      if (has_changed || stop.stop_requested()) continue;
      is_late_ = true;
      deadline_.reset();
      context_.TryCancel();
    }
  }
  Error lost() {
    {
      const std::lock_guard lock(mutex_);
      if (is_late_) {
        return {ErrorCode::kTimedOut, fmt::format("the display at {} does not show a pattern within {:.0f} s; "
                                                  "look whether it runs, then resume",
                                                  address_, to_seconds(kAnswerTimeout))};
      }
    }
    if (!status_) {
      status_ = finish_after_read(context_, [this] { return stream_->Finish(); });
    }
    const std::string doing = fmt::format("showing patterns on the display at {}", address_);
    if (status_->ok())
      return {ErrorCode::kUnavailable, doing + ": it ended the patterns; look whether it runs, then resume"};
    if (status_->error_code() == grpc::StatusCode::FAILED_PRECONDITION) {
      return Error(ErrorCode::kBusy, status_->error_message()).while_doing(doing);
    }
    return from_grpc(*status_, doing);
  }

  SteadyClock clock_;
  std::string address_;
  std::shared_ptr<grpc::Channel> channel_;
  std::unique_ptr<wire::PatternScreen::Stub> stub_;
  grpc::ClientContext context_;
  std::unique_ptr<grpc::ClientReaderWriter<wire::PatternRequest, wire::PatternShown>> stream_;
  std::uint32_t number_ = 0;
  bool is_over_ = false;
  std::optional<grpc::Status> status_;

  std::mutex mutex_;
  std::condition_variable_any changed_;
  std::optional<TimePoint> deadline_;
  bool is_late_ = false;
  std::jthread watch_;  // Last member, since it uses all the others.
};

RemotePatternScreen::RemotePatternScreen(std::vector<Head> heads, std::vector<std::unique_ptr<Stream>> streams,
                                         std::chrono::milliseconds settle)
    : heads_(std::move(heads)), streams_(std::move(streams)), settle_(settle) {}
RemotePatternScreen::~RemotePatternScreen() = default;

Result<std::unique_ptr<RemotePatternScreen>> RemotePatternScreen::open(
    const std::vector<InstalledProjector>& projectors, const std::vector<PatternDisplay>& displays,
    std::chrono::milliseconds settle) {
  std::vector<Head> heads;
  for (const InstalledProjector& projector : projectors) {
    TRY_ASSIGN(const std::size_t display, display_of(projector.name, displays));
    heads.push_back({projector.name, projector.lens.width_px, projector.lens.height_px, display});
  }
  std::vector<std::unique_ptr<Stream>> streams;
  for (const PatternDisplay& display : displays) {
    TRY_ASSIGN(std::unique_ptr<Stream> stream, Stream::open(display.address));
    streams.push_back(std::move(stream));
  }
  std::unique_ptr<RemotePatternScreen> screen(new RemotePatternScreen(std::move(heads), std::move(streams), settle));
  for (std::size_t i = 0; i < screen->heads_.size(); ++i) TRY(screen->show(i, RgbImage()));
  return screen;
}

Status RemotePatternScreen::show(std::size_t projector, const RgbImage& picture) {
  if (projector >= heads_.size()) {
    return Error(ErrorCode::kInvalidArgument, fmt::format("there is no projector {}", projector));
  }
  const Head& head = heads_[projector];
  std::string png;
  if (!picture.empty()) {
    if (picture.width() != head.width_px || picture.height() != head.height_px) {
      return Error(ErrorCode::kInvalidArgument,
                   fmt::format("a picture of {}x{} for projector '{}', which has {}x{}", picture.width(),
                               picture.height(), head.name, head.width_px, head.height_px));
    }
    TRY_ASSIGN(const std::vector<std::byte> bytes, encode_png(picture));
    png.assign(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  }
  TRY(streams_[head.display]->order(head.name, std::move(png)));
  // Waits for the projector's electronics, which do not report when the picture is lit.
  std::this_thread::sleep_for(settle_);
  return Done{};
}

}  // namespace cyclorama::scan
