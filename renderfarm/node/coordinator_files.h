// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <string>

#include "common/base/result.h"
#include "common/wire/nodes.grpc.pb.h"
#include "renderfarm/scene_distribution/scene_cache.h"
#include "renderfarm/scene_distribution/scene_files.h"

namespace grpc {
class Channel;
}  // namespace grpc

namespace cyclorama::node {

class CallWatch;

/// The coordinator as a source of files, and as the store for light that this node computed. Each call blocks; it is
/// aborted when `cancelled` returns true or the coordinator is silent for a minute. Thread-bound.
class CoordinatorFiles final : public scene_distribution::FileSource {
 public:
  /// `cancelled` is called often, also from another thread, and must outlive this object.
  CoordinatorFiles(const std::shared_ptr<grpc::Channel>& channel, const std::function<bool()>& cancelled);
  ~CoordinatorFiles() override;
  CoordinatorFiles(const CoordinatorFiles&) = delete;
  CoordinatorFiles& operator=(const CoordinatorFiles&) = delete;

  /// Returns the files of the scene with this digest.
  Result<scene_distribution::SceneFiles> list(const std::string& digest);
  Status read(const std::string& sha256, std::uint64_t offset, const Sink& sink) override;
  /// Returns a whole file of at most `max_bytes`. Errors: the coordinator's; kBadData if the bytes do not match
  /// `sha256`.
  Result<std::vector<std::byte>> whole(const std::string& sha256, std::uint64_t max_bytes);
  /// Sends light that the coordinator requested.
  Status store_light(const std::string& version, std::span<const std::byte> file);

 private:
  const std::unique_ptr<wire::Nodes::Stub> stub_;
  const std::unique_ptr<CallWatch> watch_;
};

}  // namespace cyclorama::node
