// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <list>
#include <memory>
#include <mutex>
#include <span>
#include <string>

#include "common/base/result.h"
#include "common/base/unique_fd.h"
#include "common/wire/nodes.pb.h"
#include "renderfarm/scene_distribution/file_stamp.h"
#include "renderfarm/scene_distribution/sha256.h"

namespace cyclorama::coordinator {

/// Files of light, and of pieces of it, on their way from the node that computed them to the others. They have no name
/// on the disk, so none is left behind; the nodes keep theirs, and after a restart one of them sends it again.
/// Thread-safe.
class LightFileStore {
 public:
  /// A file that is being received. Thread-bound.
  class Receipt {
   public:
    /// Appends bytes. Errors: kBusy if the file becomes larger than announced or the disk is full.
    Status add(std::span<const std::byte> bytes);
    /// Makes the file available. Errors: kInvalidArgument if the bytes do not match the version.
    Status finish();

   private:
    friend class LightFileStore;
    Receipt(LightFileStore& store, wire::LightVersion light, UniqueFd file)
        : store_(store), light_(std::move(light)), file_(std::move(file)) {}

    LightFileStore& store_;
    const wire::LightVersion light_;
    UniqueFd file_;
    std::uint64_t bytes_ = 0;
    scene_distribution::Sha256 sum_;
  };

  /// Allows a node to send this light.
  void accept(const wire::LightVersion& light);
  /// The file is not sent to any further node.
  void forget(const std::string& version);
  /// Errors: kInvalidArgument if accept() was not called for that version; kBusy if the disk gives no place.
  Result<std::unique_ptr<Receipt>> receive(const std::string& version);
  /// Opens a complete file. Errors: kNotFound if it has not been received.
  [[nodiscard]] Result<scene_distribution::StampedFile> open(const std::string& version) const;

 private:
  struct Entry {
    wire::LightVersion light;
    UniqueFd file{};  ///< Not open until the file is complete.
  };
  void keep(const std::string& version, UniqueFd file);

  mutable std::mutex mutex_;  ///< Guards the following.
  std::list<Entry> entries_;  ///< Newest first.
};

}  // namespace cyclorama::coordinator
