// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "common/wire/tls.h"
#include "common/wire/updates.pb.h"

namespace grpc {
class Channel;
}  // namespace grpc

namespace cyclorama::client {

/// Reads versions of an appliance's image from a farm. Verifies nothing: the caller must check the signature.
/// Thread-bound.
class UpdateClient {
 public:
  /// Receives the pieces of a file, in order. An error ends the transfer.
  using Sink = std::function<Status(std::span<const std::byte>)>;

  /// Makes a client, which does not connect yet. Errors: those of make_channel().
  static Result<UpdateClient> make(const std::vector<std::string>& coordinators, const std::optional<TlsFiles>& tls);

  /// Returns the offer of the first coordinator that answers; read() then uses this coordinator. Blocks for at most 10
  /// s per coordinator. Errors: kUnavailable or kTimedOut if none answers; kNotFound if the farm has no such image or
  /// is too old for updates; kInvalidArgument if it grants this museum no updates.
  Result<wire::UpdateOffer> offer(const std::string& image);
  /// Reads from `offset` to the end of the file, but for at most two minutes; call again for the rest. Precondition:
  /// offer() succeeded. Errors: those of `sink` and of offer(); kTimedOut if nothing arrived within two minutes.
  Status read(const std::string& image, const std::string& sha256, std::uint64_t offset, const Sink& sink);

 private:
  explicit UpdateClient(std::vector<std::shared_ptr<grpc::Channel>> channels) : channels_(std::move(channels)) {}

  std::vector<std::shared_ptr<grpc::Channel>> channels_;
  std::shared_ptr<grpc::Channel> answered_;
};

}  // namespace cyclorama::client
