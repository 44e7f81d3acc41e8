// SPDX-License-Identifier: Apache-2.0
#include "kiosk/update/fetch_update.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "common/update/update_manifest.h"
#include "kiosk/update/update_folder.h"
#include "kiosk/update/update_signature.h"

namespace cyclorama::update {
namespace {

constexpr Duration kLook = std::chrono::milliseconds(50);

bool may_pass(const Error& error) {
  return error.code() == ErrorCode::kUnavailable || error.code() == ErrorCode::kTimedOut ||
         error.code() == ErrorCode::kBusy;
}

class Fetch {
 public:
  Fetch(const FetchOrder& order, client::UpdateClient* farm, const std::function<bool()>& go_on)
      : order_(order), farm_(*farm), go_on_(go_on), retries_(order.retries) {}

  Result<FetchOutcome> run() {
    auto offer = farm_.offer(order_.image);
    while (!offer && may_pass(offer.error()) && wait()) offer = farm_.offer(order_.image);
    if (!offer && offer.error().code() == ErrorCode::kNotFound) return nothing(offer.error().message());
    if (!offer && is_cut_) return FetchOutcome{FetchOutcome::Kind::kLater, version_, "the farm did not answer in time"};
    if (!offer) return std::move(offer).error();
    TRY(check_signature(offer->sums(), offer->signature(), order_.key));
    TRY_ASSIGN(const UpdateManifest manifest, parse_update_manifest(offer->sums(), order_.image));
    version_ = manifest.version;
    if (!is_newer(version_, order_.version)) return nothing(fmt::format("nothing newer than {}", order_.version));
    if (!order_.not_again.empty() && !is_newer(version_, order_.not_again))
      return nothing(fmt::format("{} or a newer version was here already", version_));
    if (offer->bytes_size() != static_cast<int>(manifest.files.size())) {
      return Error(ErrorCode::kBadData, "the farm does not say how large its files are");
    }
    std::copy(offer->bytes().begin(), offer->bytes().end(), bytes_.begin());
    TRY(check_sizes());
    TRY_ASSIGN(UpdateFolder folder, UpdateFolder::open(order_.folder, offer->sums(), offer->signature()));
    TRY(check_room(folder, manifest));
    for (std::size_t i = 0; i < bytes_.size(); ++i) {
      Status fetched = fetch(manifest.files[i], bytes_[i], &folder);
      while (!fetched && may_pass(fetched.error()) && wait()) fetched = fetch(manifest.files[i], bytes_[i], &folder);
      if (!fetched && is_cut_) break;
      if (!fetched) return fetched.error();
    }
    if (is_cut_) return FetchOutcome{FetchOutcome::Kind::kLater, version_, fmt::format("{} is on its way", version_)};
    return FetchOutcome{FetchOutcome::Kind::kReady, version_, fmt::format("{} has come from the farm", version_)};
  }

 private:
  [[nodiscard]] FetchOutcome nothing(std::string sentence) const {
    return {FetchOutcome::Kind::kNothing, version_, std::move(sentence)};
  }

  /// Waits before the next attempt; returns false if there is none.
  bool wait() {
    const SteadyClock clock;
    const TimePoint end = clock.now() + order_.retry_after;
    if (is_cut_ || retries_-- <= 0) return false;
    while (clock.now() < end && goes_on()) clock.wait_until(std::min(end, clock.now() + kLook));
    return !is_cut_;
  }
  bool goes_on() {
    is_cut_ = is_cut_ || !go_on_();
    return !is_cut_;
  }

  [[nodiscard]] Status check_sizes() const {
    std::uint64_t left = order_.limits.max_bytes;
    for (const std::uint64_t bytes : bytes_) {
      if (bytes > order_.limits.max_file_bytes || bytes > left || bytes == 0) {
        return Error(ErrorCode::kInvalidArgument,
                     fmt::format("the farm's {} has a file of {} bytes; a file may have {}, all of them {}", version_,
                                 bytes, order_.limits.max_file_bytes, order_.limits.max_bytes));
      }
      left -= bytes;
    }
    return Done{};
  }

  Status check_room(const UpdateFolder& folder, const UpdateManifest& manifest) const {
    std::uint64_t needed = order_.limits.keep_free_bytes;
    for (std::size_t i = 0; i < bytes_.size(); ++i) needed += bytes_[i] - folder.there(manifest.files[i], bytes_[i]);
    TRY_ASSIGN(const std::uint64_t room, folder.room());
    if (room >= needed) return Done{};
    return Error(ErrorCode::kSystem,
                 fmt::format("the disk has room for {} MB, and {} needs {}; do a factory reset or use a larger disk",
                             room >> 20, version_, needed >> 20));
  }

  Status fetch(const UpdateFile& file, std::uint64_t bytes, UpdateFolder* folder) {
    if (folder->has(file)) return Done{};
    std::uint64_t there = folder->there(file, bytes);
    if (there == 0) folder->forget(file);  // The file may be longer than it should be.
    while (there < bytes) {
      const std::uint64_t before = there;
      TRY(farm_.read(order_.image, file.sha256, there, [&](std::span<const std::byte> piece) -> Status {
        if (!goes_on()) return Error(ErrorCode::kUnavailable, "interrupted until another night");
        if (piece.size() > bytes - there) {
          folder->forget(file);
          return Error(ErrorCode::kBadData, fmt::format("the farm sends more of '{}' than it said", file.name));
        }
        there += piece.size();
        return folder->append(file, piece);
      }));
      if (there == before) {
        return Error(ErrorCode::kBadData,
                     fmt::format("the farm's '{}' ends after {} of {} bytes", file.name, there, bytes));
      }
    }
    return folder->finish(file);
  }

  const FetchOrder& order_;
  client::UpdateClient& farm_;
  const std::function<bool()>& go_on_;
  int retries_;
  bool is_cut_ = false;
  std::string version_{};
  std::array<std::uint64_t, 3> bytes_{};
};

}  // namespace

Result<FetchOutcome> fetch_update(const FetchOrder& order, client::UpdateClient* farm,
                                  const std::function<bool()>& go_on) {
  return Fetch(order, farm, go_on).run();
}

}  // namespace cyclorama::update
