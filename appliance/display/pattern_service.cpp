// SPDX-License-Identifier: Apache-2.0
#include "appliance/display/pattern_service.h"

#include <fmt/format.h>

#include <algorithm>
#include <span>

#include "common/base/text.h"
#include "common/image/png.h"
#include "common/wire/channel.h"

namespace cyclorama::display {
namespace {

constexpr auto kLookAtCall = std::chrono::milliseconds(50);  // Maximum delay until a cancelled call is noticed.
constexpr auto kForTheShow = std::chrono::seconds(2);        // Timeout for the show to return when the call ends.

Error wrong(const std::string& message) { return Error(ErrorCode::kInvalidArgument, message); }

Result<std::shared_ptr<const RgbaImage>> picture_of(const std::string& png, const output::HeadMode& head) {
  const std::size_t max_px = static_cast<std::size_t>(head.width_px) * static_cast<std::size_t>(head.height_px);
  auto decoded = decode_png(std::as_bytes(std::span(png)), max_px);
  if (!decoded) {
    return wrong(fmt::format("projector '{}': {}; send a PNG of {}x{} pixels", head.name, decoded.error().message(),
                             head.width_px, head.height_px));
  }
  if (decoded->width() != head.width_px || decoded->height() != head.height_px) {
    return wrong(fmt::format("projector '{}': a picture of {}x{} pixels, but it has {}x{}", head.name, decoded->width(),
                             decoded->height(), head.width_px, head.height_px));
  }
  return std::shared_ptr<const RgbaImage>(std::make_shared<RgbaImage>(*std::move(decoded)));
}

}  // namespace

void PatternService::tend() {
  mailbox_.replaced.take();
  PatternsShown shown;
  const bool has_news = mailbox_.shown.take(&shown);
  if (!has_news && !is_open_) return;
  const std::lock_guard lock(mutex_);
  if (waiting_ != nullptr && SteadyClock().now() > waits_since_ + idle_) waiting_->TryCancel();
  if (!has_news) return;
  shown_ = shown;
  changed_.notify_all();
}

void PatternService::stop() {
  const std::lock_guard lock(mutex_);
  stops_ = true;
  changed_.notify_all();
}

grpc::Status PatternService::ShowPatterns(grpc::ServerContext* context, Stream* stream) {
  if (is_open_.exchange(true)) {
    return {grpc::StatusCode::FAILED_PRECONDITION,
            "another calibration shows its patterns; wait for its end, or cancel it"};
  }
  const grpc::Status end = serve(context, stream);
  const std::uint64_t back = put_notice();
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, kForTheShow, [&] { return shown_.order >= back || stops_; });
  is_open_ = false;
  return end;
}

grpc::Status PatternService::serve(grpc::ServerContext* context, Stream* stream) {
  std::vector<PatternWall::Head> heads(heads_.size());
  put(true, heads);
  wire::PatternRequest order;
  while (read(context, stream, &order)) {
    if (const Status taken = take(order, &heads); !taken) return to_grpc(taken.error());
    const Result<TimePoint> shown = wait_for(put(true, heads), *context);
    if (!shown) return to_grpc(shown.error());
    wire::PatternShown answer;
    answer.set_number(order.number());
    answer.set_shown_ns(to_nanoseconds(*shown));
    if (!stream->Write(answer)) break;
  }
  return grpc::Status::OK;
}

bool PatternService::read(grpc::ServerContext* context, Stream* stream, wire::PatternRequest* ret) {
  {
    const std::lock_guard lock(mutex_);
    waiting_ = context;
    waits_since_ = SteadyClock().now();
  }
  const bool has_order = stream->Read(ret);
  const std::lock_guard lock(mutex_);
  waiting_ = nullptr;
  return has_order;
}

/// Takes either the whole request or nothing.
Status PatternService::take(const wire::PatternRequest& order, std::vector<PatternWall::Head>* heads) const {
  std::vector<PatternWall::Head> next = *heads;
  for (PatternWall::Head& head : next) head.is_awaited = false;
  for (const wire::HeadPattern& pattern : order.heads()) {
    const auto mode = std::ranges::find(heads_, pattern.projector(), &output::HeadMode::name);
    if (mode == heads_.end()) {
      return wrong(
          fmt::format("projector '{}' is not one of this display's; use a [[projector]]'s name of its "
                      "installation.toml",
                      printable(pattern.projector())));
    }
    PatternWall::Head& head = next[static_cast<std::size_t>(mode - heads_.begin())];
    if (head.is_awaited) return wrong(fmt::format("projector '{}' twice in one order", mode->name));
    head = {nullptr, true};
    if (pattern.png().empty()) continue;
    TRY_ASSIGN(head.picture, picture_of(pattern.png(), *mode));
  }
  *heads = std::move(next);
  return Done{};
}

void PatternService::set_notice(const std::vector<std::shared_ptr<const RgbaImage>>& pictures) {
  const std::lock_guard lock(putting_);
  notice_.clear();
  for (const auto& picture : pictures) notice_.push_back({picture, false});
  has_notice_ = !notice_.empty();
  if (!is_stream_putting_) put_locked(has_notice_, notice_);
}

std::uint64_t PatternService::put(bool is_open, std::vector<PatternWall::Head> heads) {
  const std::lock_guard lock(putting_);
  is_stream_putting_ = true;
  return put_locked(is_open, std::move(heads));
}

/// Shows the notice, or the show again, after a stream of patterns has ended.
std::uint64_t PatternService::put_notice() {
  const std::lock_guard lock(putting_);
  is_stream_putting_ = false;
  return put_locked(has_notice_, notice_);
}

std::uint64_t PatternService::put_locked(bool is_open, std::vector<PatternWall::Head> heads) {
  if (heads.empty()) heads.resize(heads_.size());
  auto wall = std::make_unique<PatternWall>();
  wall->order = ++order_;
  wall->is_open = is_open;
  wall->heads = std::move(heads);
  mailbox_.wanted.put(std::move(wall));
  return order_;
}

Result<TimePoint> PatternService::wait_for(std::uint64_t order, const grpc::ServerContext& context) {
  const TimePoint deadline = SteadyClock().now() + timeout_;
  std::unique_lock lock(mutex_);
  while (shown_.order < order || shown_.lacking != 0) {
    if (context.IsCancelled()) return Error(ErrorCode::kUnavailable, "the call was cancelled");
    if (stops_) return Error(ErrorCode::kUnavailable, "the display stops");
    if (SteadyClock().now() < deadline) {
      changed_.wait_for(lock, kLookAtCall);
      continue;
    }
    if (shown_.order < order) return Error(ErrorCode::kUnavailable, "the display's output was lost; see its state");
    std::string names;
    for (std::size_t i = 0; i < heads_.size() && i < 64; ++i) {
      if ((shown_.lacking >> i & 1) != 0) names += fmt::format("{}'{}'", names.empty() ? "" : ", ", heads_[i].name);
    }
    return Error(ErrorCode::kUnavailable,
                 fmt::format("projector {} shows nothing; see whether it is on and connected", names));
  }
  return shown_.at;
}

}  // namespace cyclorama::display
