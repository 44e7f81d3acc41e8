// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/coordinator/cost_log.h"

#include <fmt/format.h>

#include <chrono>
#include <system_error>
#include <utility>

namespace cyclorama::coordinator {
namespace {
/// Maximum number of queued frames: about two seconds of three sessions.
constexpr std::size_t kMaxWaiting = 128;
}  // namespace

Result<std::unique_ptr<CostLog>> CostLog::open(std::filesystem::path folder,
                                               std::function<void(const std::string&)> notice) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) {
    return Error(ErrorCode::kSystem,
                 fmt::format("'{}', where costs are to be recorded: {}", folder.string(), error.message()));
  }
  return std::unique_ptr<CostLog>(new CostLog(std::move(folder), std::move(notice)));
}

CostLog::CostLog(std::filesystem::path folder, std::function<void(const std::string&)> notice)
    : folder_(std::move(folder)), notice_(std::move(notice)), thread_([this] { run(); }) {}

CostLog::~CostLog() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void CostLog::add(const FrameReport& report) {
  if (!report.complete || report.refined || report.costs.empty()) return;
  const wire::View& view = report.view;
  Waiting waiting;
  waiting.session = report.session;
  waiting.size = {static_cast<int>(view.panorama().width_px()), static_cast<int>(view.panorama().height_px())};
  waiting.frame.heading_rad = view.heading_rad();
  if (view.panorama().projection() == wire::Panorama::CYLINDER) {
    waiting.frame.azimuth_span_rad = view.panorama().azimuth_span_rad();
  } else {
    waiting.frame.azimuth_span_rad = 0.0;  // A change of heading does not shift this picture.
  }
  waiting.frame.eye_m = {view.eye_m().x(), view.eye_m().y(), view.eye_m().z()};
  waiting.frame.effort = view.samples();
  waiting.costs = report.costs;
  {
    const std::lock_guard lock(mutex_);
    if (waiting_.size() >= kMaxWaiting) return;
    waiting_.push_back(std::move(waiting));
  }
  changed_.notify_all();
}

void CostLog::run() {
  for (;;) {
    Waiting frame;
    {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [this] { return stopping_ || !waiting_.empty(); });
      if (waiting_.empty()) return;
      frame = std::move(waiting_.front());
      waiting_.pop_front();
    }
    write(frame);
  }
}

void CostLog::write(const Waiting& waiting) {
  const auto [record, is_new] = records_.try_emplace(waiting.session);
  if (is_new) {
    // Every coordinator numbers its sessions from 1; the time distinguishes the records.
    const auto now =
        std::chrono::duration_cast<std::chrono::seconds>(std::chrono::system_clock::now().time_since_epoch());
    auto created = balance::CostRecorder::create(
        folder_ / fmt::format("{}-session-{}.costs", now.count(), static_cast<std::uint64_t>(waiting.session)));
    if (created) {
      record->second = std::make_unique<balance::CostRecorder>(*std::move(created));
    } else {
      notice_(created.error().message());
    }
  }
  if (record->second == nullptr) return;
  if (const Status added = record->second->add(waiting.frame, waiting.size, waiting.costs); !added) {
    notice_(added.error().message());
    record->second.reset();
  }
}

}  // namespace cyclorama::coordinator
