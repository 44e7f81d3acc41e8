// SPDX-License-Identifier: Apache-2.0
#include "kiosk/operator/blinker.h"

#include <grpcpp/client_context.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <utility>
#include <vector>

#include "common/base/text.h"
#include "common/image/png.h"
#include "common/wire/calibration.grpc.pb.h"
#include "common/wire/channel.h"

namespace cyclorama::operations {
namespace {

constexpr int kBlinks = 12;
constexpr auto kBlinkPeriod = std::chrono::milliseconds(500);
constexpr auto kBlinkDeadline = std::chrono::seconds(30);

}  // namespace

Blinker::~Blinker() {
  thread_.request_stop();
  if (thread_.joinable()) thread_.join();
}

Status Blinker::blink(const std::string& projector, int width_px, int height_px) {
  if (display_.empty()) return Error(ErrorCode::kNotFound, "no display is watched, so no projector can blink");
  RgbImage picture(width_px, height_px);
  for (int y = 0; y < height_px; ++y) std::fill_n(picture.at(0, y), 3 * width_px, std::uint8_t{255});
  TRY_ASSIGN(const std::vector<std::byte> png, encode_png(picture));
  const std::lock_guard ordering(ordering_);
  thread_.request_stop();
  if (thread_.joinable()) thread_.join();
  {
    const std::lock_guard lock(mutex_);
    now_ = projector;
    trouble_.clear();
  }
  thread_ = std::jthread([this, projector, white = std::string(reinterpret_cast<const char*>(png.data()), png.size())](
                             const std::stop_token& stop) { run(stop, projector, white); });
  return Done{};
}

void Blinker::run(const std::stop_token& stop, const std::string& projector, const std::string& white) {
  std::string trouble;
  if (const auto channel = make_channel(display_)) {
    const auto stub = wire::PatternScreen::NewStub(*channel);
    grpc::ClientContext context;
    context.set_deadline(std::chrono::system_clock::now() + kBlinkDeadline);
    const std::stop_callback cancel(stop, [&context] { context.TryCancel(); });
    const auto stream = stub->ShowPatterns(&context);
    std::mutex waiting;
    std::condition_variable_any pause;
    wire::PatternShown shown;
    bool is_shown = true;
    for (int i = 0; is_shown && i < kBlinks && !stop.stop_requested(); ++i) {
      wire::PatternRequest request;
      request.set_number(static_cast<std::uint32_t>(i + 1));
      wire::HeadPattern* const head = request.add_heads();
      head->set_projector(projector);
      if (i % 2 == 0) head->set_png(white);
      is_shown = stream->Write(request) && stream->Read(&shown);
      std::unique_lock lock(waiting);
      pause.wait_for(lock, stop, kBlinkPeriod, [] { return false; });
    }
    stream->WritesDone();
    while (stream->Read(&shown)) {
    }
    const grpc::Status status = stream->Finish();
    if (!is_shown && !stop.stop_requested() && !status.ok())
      trouble = printable(from_grpc(status, "letting a projector blink").message(), 300);
  } else {
    trouble = channel.error().message();
  }
  const std::lock_guard lock(mutex_);
  now_.clear();
  trouble_ = trouble;
}

std::string Blinker::trouble() const {
  const std::lock_guard lock(mutex_);
  return trouble_;
}

std::string Blinker::now() const {
  const std::lock_guard lock(mutex_);
  return now_;
}

}  // namespace cyclorama::operations
