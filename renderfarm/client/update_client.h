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

namespace cyclorama {

/// What a farm has of an appliance's image. Nothing of it is believed here: who asks checks the signature.
/// Thread-bound.
class UpdateClient {
 public:
  /// Pieces of a file, in order; an error ends it.
  using Sink = std::function<Status(std::span<const std::byte>)>;

  /// Does not dial yet. Errors as make_channel().
  static Result<UpdateClient> make(const std::vector<std::string>& heads, const std::optional<TlsFiles>& tls);

  /// Of the first head that answers; open for it from then on. kUnavailable, kTimedOut  none does.     Else what it
  /// answers: kNotFound  it has no such image, or is too old to hand any out.     kInvalidArgument  it gives this
  /// museum none.     Blocks for 10 s a head at most.
  Result<wire::UpdateOffer> offer(const std::string& image);
  /// From `offset` on until the file's end, or for two minutes: whoever wants the rest asks again. Precondition:
  /// offer() was answered. Errors of `sink`, and as offer(); kTimedOut  nothing came for two minutes.
  Status read(const std::string& image, const std::string& sha256, std::uint64_t offset, const Sink& sink);

 private:
  explicit UpdateClient(std::vector<std::shared_ptr<grpc::Channel>> channels) : channels_(std::move(channels)) {}

  std::vector<std::shared_ptr<grpc::Channel>> channels_;
  std::shared_ptr<grpc::Channel> answered_;
};

}  // namespace cyclorama
