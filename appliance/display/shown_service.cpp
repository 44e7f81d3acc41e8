// SPDX-License-Identifier: Apache-2.0
#include "appliance/display/shown_service.h"

#include <algorithm>

#include "common/geometry/picture_place.h"
#include "common/wire/channel.h"

namespace cyclorama::display {
namespace {
constexpr std::uint32_t kMaxFactor = 16;
constexpr JpegOptions kNearlyAll{95, false};
}  // namespace

grpc::Status ShownService::GetShown(grpc::ServerContext*, const wire::ShownRequest* request, wire::ShownReply* reply) {
  reply->set_received_ns(to_nanoseconds(clock_.now()));
  if (request->factor() > kMaxFactor) return {grpc::StatusCode::INVALID_ARGUMENT, "a factor is from 1 to 16"};
  const int factor = std::max(1, static_cast<int>(request->factor()));
  const auto shown =
      history_.between(from_nanoseconds(request->from_ns()), from_nanoseconds(request->until_ns()), clock_.now());
  reply->set_known_until_ns(to_nanoseconds(shown.known_until));
  for (const ShownSince& since : shown.moments) {
    wire::ShownMoment* const moment = reply->add_moments();
    moment->set_number(since.number);
    moment->set_shown_ns(to_nanoseconds(since.at));
    moment->set_is_show(since.frame != nullptr);
    if (since.frame == nullptr || since.number <= request->known()) continue;
    if (const Status drawn = draw(since, factor, moment); !drawn) return to_grpc(drawn.error());
  }
  reply->set_answered_ns(to_nanoseconds(clock_.now()));
  return grpc::Status::OK;
}

Status ShownService::draw(const ShownSince& moment, int factor, wire::ShownMoment* reply) {
  const std::lock_guard lock(mutex_);
  if (plans_ != moment.plans || factor_ != factor) {
    samplers_.clear();
    for (const HeadPlan& plan : *moment.plans) {
      if (plan.packing || moment.frame->stacked > 1) {
        return Error(ErrorCode::kUnavailable, "the heads show two eyes' pictures; a wall of stereo is not watched");
      }
      samplers_.emplace_back(plan, factor);
    }
    plans_ = moment.plans;
    factor_ = factor;
  }
  for (std::size_t i = 0; i < samplers_.size(); ++i) {
    if (!has_same_places(moment.frame->shape, (*plans_)[i].picture)) {
      reply->set_is_show(false);
      reply->clear_heads();
      return Done{};
    }
    TRY_ASSIGN(const auto jpeg, encoder_.encode(samplers_[i].draw(*moment.frame, moment.turn_rad), kNearlyAll));
    wire::ShownHead* const head = reply->add_heads();
    head->set_projector(heads_[i]);
    head->set_jpeg(jpeg.data(), jpeg.size());
  }
  return Done{};
}

}  // namespace cyclorama::display
