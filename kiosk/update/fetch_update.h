// SPDX-License-Identifier: Apache-2.0
/// From the farm to a whole, verified version on this computer's disk, which then goes the way of one from a stick.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

#include "common/base/clock.h"
#include "common/base/result.h"
#include "renderfarm/client/update_client.h"

namespace cyclorama {

struct UpdateLimits {
  std::uint64_t largest_bytes = std::uint64_t{1} << 30;      ///< Of one file: what its partition holds.
  std::uint64_t most_bytes = std::uint64_t{1536} << 20;      ///< Of all.
  std::uint64_t keep_free_bytes = std::uint64_t{256} << 20;  ///< On the disk, for journal and settings.
};

struct FetchOrder {
  std::string image;               ///< "cyclorama-museum".
  std::string version;             ///< That runs.
  std::string not_again{};         ///< Newest that was here already, or did not start well; nothing older is fetched.
  std::filesystem::path key{};     ///< The public half of the key that signs versions.
  std::filesystem::path folder{};  ///< Where they come together.
  UpdateLimits limits{};
  Duration retry_after = std::chrono::seconds(10);
  int retries = 30;  ///< Of what may pass: a farm that is away or busy.
};

struct FetchOutcome {
  enum class Kind {
    kNothing,  ///< There is nothing newer; the sentence says what there is.
    kReady,    ///< `folder` holds it whole.
    kLater,    ///< `go_on` said no; what has come stays.
  };
  Kind kind = Kind::kNothing;
  std::string version{};  ///< That the farm has; empty: none.
  std::string sentence{};
};

/// Goes on where it was cut. `go_on` is asked with every piece. Blocks.
///
/// kBadData  not signed by us, damaged, or not what was announced: no byte of it is used.     kInvalidArgument  it is
/// larger than a version may be, or the farm gives this museum none.     kSystem  the disk is full or broken.
/// kUnavailable, kTimedOut, kBusy  the farm is away; what has come stays.
Result<FetchOutcome> fetch_update(const FetchOrder& order, UpdateClient* farm, const std::function<bool()>& go_on);

}  // namespace cyclorama
