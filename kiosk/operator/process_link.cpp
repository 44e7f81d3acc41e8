// SPDX-License-Identifier: Apache-2.0
#include "kiosk/operator/process_link.h"

#include <fmt/format.h>
#include <grpcpp/client_context.h>

#include <array>
#include <utility>

#include "common/base/text.h"
#include "common/wire/channel.h"

namespace cyclorama::operations {
namespace {

constexpr auto kDeadline = std::chrono::seconds(2);

template <typename Reply, typename Call>
Result<Reply> ask(const Endpoint& endpoint, Call&& call) {
  grpc::ClientContext context;
  context.set_deadline(std::chrono::system_clock::now() + kDeadline);  // gRPC's deadlines use the system clock.
  Reply reply;
  const grpc::Status status = call(&context, &reply);
  if (!status.ok()) return from_grpc(status, fmt::format("querying {} at {}", endpoint.name, endpoint.address));
  return reply;
}

struct Absence {
  std::string_view name;
  std::string_view program;
  std::string_view meaning;
};
constexpr std::array<Absence, 6> kAbsences{{
    {"tour", "cyclorama-tour", "Nothing moves, and the wall holds its last picture."},
    {"display", "cyclorama-display", "The projectors show nothing new."},
    {"tracker", "cyclorama-tracker", "The wand is not seen; keys still steer."},
    {"projectors", "cyclorama-projectors", "No projector is switched on or off by the opening hours."},
    {"coordinator", "cyclorama-farm", "No new pictures are ray traced."},
    {"simulated-room", "cyclorama-simulated-room",
     "The picture of the wall is not made; a real wall does not need it."},
}};

}  // namespace

Result<ProcessLink> ProcessLink::make(Endpoint endpoint) {
  TRY_ASSIGN(auto channel, make_channel(endpoint.address));
  return ProcessLink(std::move(endpoint), std::move(channel));
}

ProcessLink::ProcessLink(Endpoint endpoint, std::shared_ptr<grpc::Channel> channel)
    : endpoint_(std::move(endpoint)),
      channel_(std::move(channel)),
      inspection_(wire::Inspection::NewStub(channel_)),
      tour_(wire::Tour::NewStub(channel_)) {}

Result<wire::ProcessStatus> ProcessLink::status() const {
  return ask<wire::ProcessStatus>(endpoint_, [this](grpc::ClientContext* context, wire::ProcessStatus* reply) {
    return inspection_->GetStatus(context, wire::StatusRequest(), reply);
  });
}

Result<wire::Picture> ProcessLink::picture(const std::string& name) const {
  return ask<wire::Picture>(endpoint_, [&](grpc::ClientContext* context, wire::Picture* reply) {
    wire::PictureRequest request;
    request.set_name(name);
    return inspection_->GetPicture(context, request, reply);
  });
}

Status ProcessLink::steer(const wire::SteerRequest& request) const {
  TRY(ask<wire::SteerReply>(endpoint_, [&](grpc::ClientContext* context, wire::SteerReply* reply) {
    return tour_->Steer(context, request, reply);
  }));
  return Done{};
}

Result<std::vector<ProcessLink>> make_links(const std::vector<Endpoint>& endpoints) {
  std::vector<ProcessLink> links;
  for (const Endpoint& endpoint : endpoints) {
    TRY_ASSIGN(ProcessLink link, ProcessLink::make(endpoint));
    links.push_back(std::move(link));
  }
  return links;
}

std::string away_sentence(const Endpoint& endpoint, const Error& error) {
  const std::string how = fmt::format(
      fmt::runtime(error.code() == ErrorCode::kTimedOut ? "It does not answer at {}." : "It cannot be reached at {}."),
      printable(endpoint.address));
  for (const Absence& absence : kAbsences) {
    if (absence.name != endpoint.name) continue;
    return fmt::format("{} {} ", how, absence.meaning) +
           fmt::format("See that {} runs there: systemctl status {}.", absence.program, absence.program);
  }
  return how + " See that it runs and listens there.";
}

}  // namespace cyclorama::operations
