// SPDX-License-Identifier: Apache-2.0
/// Sessions of the operator page: temporary access for people who have entered the PIN.
#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <mutex>
#include <string>
#include <string_view>

#include "common/base/clock.h"
#include "common/base/result.h"
#include "common/base/token_bucket.h"

namespace cyclorama::operations {

struct SessionRules {
  Duration longest = std::chrono::hours(12);
  /// Maximum time without a request; an open page sends some every second.
  Duration idle = std::chrono::minutes(30);
  std::size_t max = 32;  ///< Maximum number of sessions; beyond it, the longest idle one is closed.
  int free_tries = 3;    ///< Number of wrong PINs from one network, or on one known device, before it has to wait.
  Duration first_wait = std::chrono::seconds(2);  ///< Doubles with each further wrong PIN, up to max_wait.
  Duration max_wait = std::chrono::minutes(10);
  /// Rate for all clients together that are no known devices: 10^6 PINs take more than five years.
  double tries_per_hour = 20.0;
  double tries_at_once = 30.0;  ///< Burst that the rate allows at first.
};

/// Texts by which a client may have tries of its own. Each may be empty or anything else.
struct LoginProofs {
  std::string_view device{};     ///< Login::device of an earlier login.
  std::string_view wall_code{};  ///< The code on the wall, which only people in front of it see.
};

/// Cookies for a client that entered the PIN.
struct Login {
  std::string session;  ///< Token of the session: 256 random bits in hexadecimal.
  /// Proves later that this PIN was entered on this device once: such a device has tries of its own.
  std::string device;
};

/// Returns 256 random bits in hexadecimal. Errors: kSystem if there are none.
Result<std::string> new_token();

/// Thread-safe. PINs are checked one at a time, so that many concurrent attempts use no more memory than one.
class Sessions {
 public:
  /// `pin_file` contains the result of hashed_pin(); it is read at every attempt, so that a new PIN from a USB stick
  /// counts at once. `clock` is borrowed.
  Sessions(const Clock& clock, std::filesystem::path pin_file, SessionRules rules = {});

  /// Opens a session. `from` is the peer's address; all addresses of an IPv6 /64 count as one. Wrong PINs count for
  /// the device if it is known, which no device can be without the PIN; else for the wall, if the client has its
  /// code; else for the network, and for all such clients together. So wrong PINs from elsewhere lock out neither a
  /// known device nor people in front of the wall. Errors: kInvalidArgument if the PIN is wrong; kBusy, with the time
  /// to wait, after too many wrong PINs (this PIN is then not checked); kNotFound if no PIN was provisioned;
  /// kBadData, kSystem if the file cannot be read.
  Result<Login> open(std::string_view pin, const std::string& from, const LoginProofs& proofs = {});
  /// Returns true for a session's token, and marks the session as used. A PIN that has changed ends all sessions.
  [[nodiscard]] bool is_open(std::string_view token);
  void close(std::string_view token);
  /// Returns a new code for the wall. The one before it stays valid, for people who have just scanned it. Errors:
  /// kSystem if there are no random numbers.
  Result<std::string> renew_wall_code();
  /// Returns whether this is one of the two codes on the wall. Guessing it takes longer than a code lasts.
  [[nodiscard]] bool is_wall_code(std::string_view code) const;

 private:
  struct Session {
    TimePoint opened_at{};
    TimePoint used_at{};
    std::string pin_hash{};
  };
  struct Tries {
    int wrong = 0;
    TimePoint next_at{};
    TimePoint last_at{};
  };
  using TriesByClient = std::map<std::string, Tries, std::less<>>;
  /// The client whose tries are counted.
  struct Client {
    std::string name;
    bool has_own_tries = false;  ///< A known device, or the wall; else a network.
  };
  TriesByClient& tries_of(const Client& client) { return client.has_own_tries ? own_tries_ : network_tries_; }
  Client client_of(const std::string& from, const LoginProofs& proofs, std::string_view hash);
  Status may_try(const Client& client, TimePoint now);
  void was_wrong(const Client& client, TimePoint now);
  void forget_old(TimePoint now);

  const Clock& clock_;
  const std::filesystem::path pin_file_;
  const SessionRules rules_;
  std::mutex trying_;  ///< Serialises the checks of PINs.
  mutable std::mutex mutex_;  ///< Guards the following.
  std::map<std::string, Session, std::less<>> sessions_;
  std::array<std::string, 2> wall_codes_;  ///< The newest first; empty: none.
  TriesByClient own_tries_;
  TriesByClient network_tries_;
  TokenBucket wrong_of_unknown_;
};

}  // namespace cyclorama::operations
