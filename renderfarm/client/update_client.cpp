// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/client/update_client.h"

#include <grpcpp/client_context.h>

#include <chrono>

#include "common/wire/channel.h"
#include "common/wire/updates.grpc.pb.h"

namespace cyclorama::client {
namespace {

constexpr auto kOfferDeadline = std::chrono::seconds(10);
constexpr auto kReadDeadline = std::chrono::minutes(2);

/// Returns the error for a gRPC status. A coordinator without this service is too old for updates.
Error said_by(const grpc::Status& status) {
  if (status.error_code() == grpc::StatusCode::UNIMPLEMENTED) {
    return Error(ErrorCode::kNotFound, "this farm provides no updates");
  }
  return from_grpc(status, "requesting updates from the farm");
}

}  // namespace

Result<UpdateClient> UpdateClient::make(const std::vector<std::string>& coordinators,
                                        const std::optional<TlsFiles>& tls) {
  if (coordinators.empty()) return Error(ErrorCode::kInvalidArgument, "no address of a farm is given");
  std::vector<std::shared_ptr<grpc::Channel>> channels;
  for (const std::string& coordinator : coordinators) {
    TRY_ASSIGN(auto channel, make_channel(coordinator, tls));
    channels.push_back(std::move(channel));
  }
  return UpdateClient(std::move(channels));
}

Result<wire::UpdateOffer> UpdateClient::offer(const std::string& image) {
  wire::OfferUpdateRequest request;
  request.set_image(image);
  grpc::Status status;
  for (const auto& channel : channels_) {
    grpc::ClientContext context;
    context.set_deadline(std::chrono::system_clock::now() + kOfferDeadline);
    wire::UpdateOffer offer;
    status = wire::Updates::NewStub(channel)->Offer(&context, request, &offer);
    answered_ = channel;
    if (status.ok()) return offer;
    const bool is_away = status.error_code() == grpc::StatusCode::UNAVAILABLE ||
                         status.error_code() == grpc::StatusCode::DEADLINE_EXCEEDED;
    if (!is_away) break;
  }
  return said_by(status);
}

Status UpdateClient::read(const std::string& image, const std::string& sha256, std::uint64_t offset, const Sink& sink) {
  CHECK(answered_ != nullptr);
  grpc::ClientContext context;
  context.set_deadline(std::chrono::system_clock::now() + kReadDeadline);
  wire::FetchUpdateRequest request;
  request.set_image(image);
  request.set_sha256(sha256);
  request.set_offset(offset);
  const auto stub = wire::Updates::NewStub(answered_);
  const auto stream = stub->Fetch(&context, request);
  Status fine = Done{};
  bool has_come = false;
  wire::FileChunk chunk;
  while (fine && stream->Read(&chunk)) {
    has_come = has_come || !chunk.data().empty();
    fine = chunk.offset() == offset ? sink(std::as_bytes(std::span(chunk.data())))
                                    : Error(ErrorCode::kBadData, "the farm sent its pieces out of order");
    offset += chunk.data().size();
  }
  if (!fine) context.TryCancel();
  const grpc::Status status = finish_after_read(context, [&] { return stream->Finish(); });
  if (!fine) return fine;
  if (status.ok() || (has_come && status.error_code() == grpc::StatusCode::DEADLINE_EXCEEDED)) return Done{};
  return said_by(status);
}

}  // namespace cyclorama::client
