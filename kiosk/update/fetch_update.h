// SPDX-License-Identifier: Apache-2.0
/// Fetches a new version from the farm and verifies it; it is then installed like one from a USB stick.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

#include "common/base/clock.h"
#include "common/base/result.h"
#include "renderfarm/client/update_client.h"

namespace cyclorama::update {

struct UpdateLimits {
  std::uint64_t max_file_bytes = std::uint64_t{1} << 30;  ///< Limit of one file: the size of its partition.
  std::uint64_t max_bytes = std::uint64_t{1536} << 20;    ///< Limit of all files together.
  /// Disk space that stays free for the journal and the settings.
  std::uint64_t keep_free_bytes = std::uint64_t{256} << 20;
};

struct FetchOrder {
  std::string image;    ///< "cyclorama-museum".
  std::string version;  ///< The running version.
  /// Newest version that was already installed or failed to start; only newer ones are fetched.
  std::string not_again{};
  std::filesystem::path key{};     ///< Public key for the signature of versions.
  std::filesystem::path folder{};  ///< Folder that collects the files.
  UpdateLimits limits{};
  Duration retry_after = std::chrono::seconds(10);
  int retries = 30;  ///< Number of retries for temporary failures: a farm that is away or busy.
};

struct FetchOutcome {
  enum class Kind {
    kNothing,  ///< Nothing newer is available; the sentence names the farm's version.
    kReady,    ///< `folder` contains the whole version.
    kLater,    ///< `go_on` returned false; the parts that have arrived stay.
  };
  Kind kind = Kind::kNothing;
  std::string version{};  ///< The farm's version; empty: none.
  std::string sentence{};
};

/// Resumes an interrupted download. Calls `go_on` for every piece. Blocks.
///
/// Errors: kBadData if the version is not signed with our key, damaged, or not the announced one: nothing of it is
/// used; kInvalidArgument if it exceeds the limits, or the farm has none for this museum; kSystem if the disk is full
/// or broken; kUnavailable, kTimedOut or kBusy if the farm is away: the parts that have arrived stay.
Result<FetchOutcome> fetch_update(const FetchOrder& order, client::UpdateClient* farm,
                                  const std::function<bool()>& go_on);

}  // namespace cyclorama::update
