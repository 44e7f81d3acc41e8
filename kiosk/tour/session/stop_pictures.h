// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "kiosk/tour/session/kept_picture.h"
#include "kiosk/tour/session/picture_fetch.h"

namespace cyclorama::tour {

/// Converged pictures of a tour's stops on disk, for the time when the farm is away. While it may, it fetches what is
/// missing, one picture after another in the stops' order, until the disk's budget is used up; whatever is not wanted
/// any more is removed.
///
///   wanted ──► missing ── may fetch, fits ──► being fetched ──► kept        Thread `pictures`. Thread-safe.
///                 ▲ ◄──── may not any more, or failed: again later ┘
class StopPictures {
 public:
  struct Wanted {
    std::string stop;
    wire::View view;          ///< Its number is not set.
    std::uint64_t scene = 0;  ///< Checksum of the scene's description.
    friend bool operator==(const Wanted& a, const Wanted& b) { return a.key() == b.key(); }
    /// Name of the file: another view of the stop, or another scene, has another one.
    [[nodiscard]] std::string key() const;
  };
  struct Progress {
    std::size_t wanted = 0;
    std::size_t kept = 0;
    std::uint64_t bytes = 0;
    std::string trouble;  ///< Reason why not all are kept; empty: they are, or nothing may be fetched now.
  };

  /// Creates the folder. Errors: kSystem if that fails.
  static Result<std::unique_ptr<StopPictures>> open(std::filesystem::path folder, std::uint64_t max_bytes,
                                                    client::FarmClientOptions farm);
  ~StopPictures();
  StopPictures(const StopPictures&) = delete;
  StopPictures& operator=(const StopPictures&) = delete;

  /// Returns what the last visit of an earlier process left; nothing if there is none.
  [[nodiscard]] std::optional<KeptVisit> earlier_visit() const;
  /// Sets the pictures to keep, in the order in which they are fetched.
  void set_wanted(const KeptVisit& visit, std::vector<Wanted> wanted);
  /// Allows or forbids fetching; a fetch that is forbidden ends without result.
  void allow(bool may_fetch);

  [[nodiscard]] bool is_kept(const std::string& stop) const;
  /// Reads a picture from disk. Errors: kNotFound if it is not kept; those of parse_kept_picture(), whereupon it is
  /// fetched again.
  Result<KeptPicture> read(const std::string& stop);
  [[nodiscard]] Progress progress() const;

 private:
  StopPictures(std::filesystem::path folder, std::uint64_t max_bytes, client::FarmClientOptions farm);
  [[nodiscard]] std::filesystem::path file_of(const std::string& key) const { return folder_ / (key + ".picture"); }
  [[nodiscard]] std::filesystem::path visit_file() const { return folder_ / "visit"; }
  void list_files();
  void run();
  [[nodiscard]] const Wanted* missing() const;
  void fetch(const Wanted& wanted, std::unique_lock<std::mutex>* lock);
  Status keep(const Wanted& wanted, const KeptPicture& picture);
  [[nodiscard]] std::uint64_t kept_bytes() const;

  const std::filesystem::path folder_;
  const std::uint64_t max_bytes_;
  const client::FarmClientOptions farm_;

  mutable std::mutex mutex_;  ///< Guards the following.
  std::condition_variable changed_;
  std::vector<Wanted> wanted_;
  std::map<std::string, std::uint64_t> files_;  ///< Keys and sizes of the files in the folder.
  std::set<std::string> too_large_;             ///< Keys of pictures that the budget has no room for.
  bool may_fetch_ = false;
  bool is_stopping_ = false;
  std::string trouble_;

  std::thread pictures_;  ///< Last member, because it uses all others.
};

}  // namespace cyclorama::tour
