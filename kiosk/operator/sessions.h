// SPDX-License-Identifier: Apache-2.0
/// Who may use the operator page: those who entered the PIN, for a while.
#pragma once

#include <filesystem>
#include <map>
#include <mutex>
#include <string>
#include <string_view>

#include "common/base/clock.h"
#include "common/base/result.h"
#include "common/base/token_bucket.h"

namespace cyclorama {

struct SessionRules {
  Duration longest = std::chrono::hours(12);
  Duration idle = std::chrono::minutes(30);          ///< Without a request; an open page makes some every second.
  std::size_t most = 32;                             ///< The one that was idle the longest makes room.
  int free_tries = 3;                                ///< Wrong PINs of one network before it has to wait.
  Duration first_wait = std::chrono::seconds(2);     ///< Doubles with each further wrong one,
  Duration longest_wait = std::chrono::minutes(10);  ///< up to this.
  double tries_per_minute = 10.0;                    ///< Of everybody together: 10^6 PINs take two months,
  double tries_at_once = 30.0;                       ///< but for these.
};

/// Thread-safe. Tries of PINs are looked at one after the other, so that many at once cost no more memory than one.
class Sessions {
 public:
  /// `pin_file` holds what hashed_pin() makes; it is read at every try, so another stick's PIN holds from then on.
  /// `clock` is borrowed.
  Sessions(const Clock& clock, std::filesystem::path pin_file, SessionRules rules = {});

  /// A new session's token: 256 random bits in hexadecimal. `from` is the peer's address; all of an IPv6 /64 are one.
  /// kInvalidArgument  a wrong PIN.     kBusy  too many wrong ones: says how long to wait, and the PIN was not looked
  /// at. kNotFound  no PIN was provisioned.     kBadData, kSystem  the file.
  Result<std::string> open(std::string_view pin, const std::string& from);
  /// True for a session's token; it then is not idle.
  [[nodiscard]] bool is_open(std::string_view token);
  void close(std::string_view token);

 private:
  struct Session {
    TimePoint opened_at{};
    TimePoint used_at{};
  };
  struct Tries {
    int wrong = 0;
    TimePoint next_at{};
    TimePoint last_at{};
  };
  Status may_try(const std::string& network, TimePoint now);
  void was_wrong(const std::string& network, TimePoint now);
  void forget_old(TimePoint now);

  const Clock& clock_;
  const std::filesystem::path pin_file_;
  const SessionRules rules_;
  std::mutex trying_;  ///< One PIN at a time.
  std::mutex mutex_;   ///< Guards the following.
  std::map<std::string, Session, std::less<>> sessions_;
  std::map<std::string, Tries> tries_;
  TokenBucket wrong_of_all_;
};

/// "192.0.2.7", or the first half of an IPv6 address, which one household or hall has: "2001:db8:0:1".
[[nodiscard]] std::string network_of(const std::string& address);

}  // namespace cyclorama
