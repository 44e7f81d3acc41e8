// SPDX-License-Identifier: Apache-2.0
#include "common/wire/inspection_service.h"

#include <utility>

#include "common/image/jpeg.h"

namespace cyclorama {
namespace {
constexpr auto kWatchedFor = std::chrono::seconds(3);
constexpr JpegOptions kPageJpeg{92, false};
}  // namespace

InspectionService::InspectionService(std::string process)
    : process_(std::move(process)), started_at_(SteadyClock().now()) {}

void InspectionService::set_state(std::string sentence, bool healthy) {
  const std::lock_guard lock(mutex_);
  state_ = std::move(sentence);
  healthy_ = healthy;
}

void InspectionService::add_stage_time(const std::string& stage, Duration duration) {
  const std::lock_guard lock(mutex_);
  stages_.try_emplace(stage).first->second.add(to_milliseconds(duration));
}

void InspectionService::set_gauge(const std::string& name, double value) {
  const std::lock_guard lock(mutex_);
  gauges_[name] = value;
}

void InspectionService::count(const std::string& name, double increment) {
  const std::lock_guard lock(mutex_);
  gauges_[name] += increment;
}

void InspectionService::set_fact(const std::string& name, std::string value) {
  const std::lock_guard lock(mutex_);
  facts_[name] = std::move(value);
}

void InspectionService::set_table(wire::Table table) {
  const std::lock_guard lock(mutex_);
  std::string name = table.name();
  tables_[std::move(name)] = std::move(table);
}

void InspectionService::set_picture(const std::string& name, std::shared_ptr<const RgbImage> picture) {
  const std::lock_guard lock(mutex_);
  pictures_[name].newest = std::move(picture);
}

bool InspectionService::is_watched(const std::string& picture) {
  const std::lock_guard lock(mutex_);
  const TimePoint asked_at = pictures_[picture].asked_at;
  return asked_at != TimePoint{} && SteadyClock().now() - asked_at < kWatchedFor;
}

wire::ProcessStatus InspectionService::status() const {
  wire::ProcessStatus status;
  const std::lock_guard lock(mutex_);
  status.set_process(process_);
  status.set_version(CYCLORAMA_VERSION);
  status.set_uptime_s(to_seconds(SteadyClock().now() - started_at_));
  status.set_state(state_);
  status.set_healthy(healthy_);
  for (const auto& [name, times] : stages_) {
    wire::Stage* const stage = status.add_stages();
    stage->set_name(name);
    stage->set_count(times.count());
    stage->set_p50_ms(times.at(0.50));
    stage->set_p95_ms(times.at(0.95));
    stage->set_p99_ms(times.at(0.99));
  }
  for (const auto& [name, value] : gauges_) {
    wire::Gauge* const gauge = status.add_gauges();
    gauge->set_name(name);
    gauge->set_value(value);
  }
  for (const auto& [name, value] : facts_) {
    wire::Fact* const fact = status.add_facts();
    fact->set_name(name);
    fact->set_value(value);
  }
  for (const auto& [name, table] : tables_) *status.add_tables() = table;
  for (const auto& [name, picture] : pictures_) status.add_pictures(name);
  return status;
}

grpc::Status InspectionService::GetStatus(grpc::ServerContext*, const wire::StatusRequest*,
                                          wire::ProcessStatus* reply) {
  *reply = status();
  return grpc::Status::OK;
}

grpc::Status InspectionService::GetPicture(grpc::ServerContext*, const wire::PictureRequest* request,
                                           wire::Picture* reply) {
  std::shared_ptr<const RgbImage> picture;
  {
    const std::lock_guard lock(mutex_);
    const auto found = pictures_.find(request->name());
    if (found != pictures_.end()) {
      found->second.asked_at = SteadyClock().now();
      picture = found->second.newest;
    }
  }
  if (picture == nullptr) return {grpc::StatusCode::NOT_FOUND, "no such picture yet: '" + request->name() + "'"};
  const auto jpeg = JpegEncoder().encode(*picture, kPageJpeg);
  if (!jpeg) return {grpc::StatusCode::INTERNAL, jpeg.error().message()};
  reply->set_jpeg(jpeg->data(), jpeg->size());
  reply->set_width_px(static_cast<std::uint32_t>(picture->width()));
  reply->set_height_px(static_cast<std::uint32_t>(picture->height()));
  return grpc::Status::OK;
}

}  // namespace cyclorama
