// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>

#include "common/base/clock.h"
#include "common/base/token_bucket.h"
#include "common/wire/rank.h"
#include "renderfarm/coordinator/ids.h"

namespace cyclorama::coordinator {

/// Shares the farm among museums. Each museum has one account, whatever the number of its sessions. Every block that a
/// node ends is charged to the account, including blocks of frames that were given up.
///
/// The order is that of start-time fair queueing (Goyal, Vin, Cheng, "Start-time Fair Queuing", 1996), computed from
/// measured service: an account's virtual time grows by its cpu-seconds over its weight, and the account whose virtual
/// time is lowest is served first. Predicted costs only order the frames within one account.
///
/// An account that received less than the others may catch up by a bounded amount: kCreditSeconds of its share. Thus a
/// museum within its share does not wait for one that takes all it can get, and an idle museum does not save up more.
/// An account that had no frame in flight begins again at the virtual time of an imagined account that always takes
/// exactly its share. Thus museums within their shares are served in the order of their requests, whether or not a
/// greedy museum is connected, and a museum that received slightly more a while ago does not wait for all others.
///
/// An account that has used up its quota is served after all others (WorkClass::kSpare); an otherwise idle farm still
/// serves it at full speed. Each class of work has a separate virtual time. Pure; thread-bound.
class Accounts {
 public:
  struct Terms {
    double weight = 1.0;                 ///< Must be above 0.
    double cores = 0.0;                  ///< Cpu-seconds per second; 0: no quota.
    double megapixels_per_second = 0.0;  ///< Requested megapixels per second; 0: no quota.
  };
  struct Demand {
    bool at_rest = false;
    double cpu_seconds = 0.0;  ///< Predicted cost; above 0.
    double megapixels = 0.0;
  };
  /// Position of a frame in the order.
  struct Turn {
    WorkClass work = WorkClass::kMoving;
    double start = 0.0;     ///< Virtual time.
    double reserved = 0.0;  ///< See Demand::cpu_seconds.
    [[nodiscard]] Rank rank() const;
  };

  /// Opens the museum's account for one more session. Without a name, which only a farm without certificates permits,
  /// each session has a separate account. The terms replace earlier ones.
  AccountId open(const std::string& museum, const Terms& terms);
  /// Records that a session of the account has ended.
  void close(AccountId account);

  /// Determines a frame's position in the order. end() must follow, unless the account's last session is closed.
  [[nodiscard]] Turn begin(AccountId account, const Demand& demand, TimePoint now);
  /// Records that the frame is over. Its blocks may still be charged later.
  void end(AccountId account, const Turn& turn);
  /// Charges the account for time that a node has spent. Ignored for an account without a name whose session is closed.
  void charge(AccountId account, WorkClass work, double cpu_seconds, TimePoint now);

  /// Sets the cpu-seconds that all nodes give per second, which determine everybody's share.
  void set_threads(double threads) { threads_ = threads; }
  [[nodiscard]] bool is_over_quota(AccountId account, TimePoint now) const;
  [[nodiscard]] double weight(AccountId account) const;
  /// Returns what the account has received so far, in virtual time; 0 for an unknown one.
  [[nodiscard]] double received(AccountId account, WorkClass work) const;
  /// Returns what an account may catch up with, in virtual time.
  [[nodiscard]] double credit() const;
  /// Returns the cpu-seconds charged since the account was first opened; 0 for an unknown account.
  [[nodiscard]] double charged_seconds(AccountId account) const;

  /// Seconds of its share of the farm by which an account may catch up.
  static constexpr double kCreditSeconds = 1.0;
  /// Burst that a quota permits: the amount that it allows in this time may be used at once before work counts as
  /// spare.
  static constexpr double kQuotaBurstSeconds = 2.0;

 private:
  /// The work of one account in one class.
  struct Flow {
    double time = 0.0;         ///< Virtual time.
    double last_charge = 0.0;  ///< Growth of `time` by the last charge.
    double reserved = 0.0;     ///< Predicted cpu-seconds of the frames in flight.
    int frames = 0;            ///< Number of frames in flight.
  };
  struct Account {
    std::string museum{};
    Terms terms{};
    int sessions = 0;
    double charged = 0.0;
    TokenBucket cores{0.0, 0.0};
    TokenBucket megapixels{0.0, 0.0};
    std::array<Flow, kWorkClasses> flows{};
  };
  /// The imagined account that takes just its share, in one class.
  struct FairShare {
    double time = 0.0;    ///< Its virtual time; never decreases.
    TimePoint at{};       ///< Time of the last update.
    double latest = 0.0;  ///< The highest virtual time of any account.
  };
  /// Updates and returns the virtual time of an account that takes just its share: it grows with the farm's threads,
  /// but is never more than a credit behind those who have frames in flight, and never ahead of all.
  [[nodiscard]] double fair_time(std::size_t work, TimePoint now);

  /// Sums up the weights of the accounts that have a session.
  void sum_up_weights();

  double threads_ = 1.0;
  double weights_ = 0.0;  ///< Weights of the accounts that have a session.
  std::array<FairShare, kWorkClasses> fair_{};
  std::map<AccountId, Account> accounts_;
  std::map<std::string, AccountId> named_;
  std::uint64_t last_id_ = 0;
};

}  // namespace cyclorama::coordinator
