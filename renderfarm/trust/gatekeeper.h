// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "common/base/clock.h"
#include "common/base/result.h"
#include "common/base/token_bucket.h"
#include "common/wire/farm.pb.h"
#include "common/wire/tls.h"
#include "renderfarm/trust/audit_log.h"
#include "renderfarm/trust/grants.h"
#include "renderfarm/trust/revocations.h"
#include "renderfarm/trust/view_guard.h"
#include "renderfarm/trust/watched_file.h"

namespace cyclorama::trust {

struct TrustOptions {
  std::optional<TlsFiles> tls{};         ///< Empty: every peer may do everything.
  std::filesystem::path revoked{};       ///< The authority's crl.pem. Empty: no certificate is revoked.
  std::filesystem::path museums{};       ///< museums.toml. Empty: every museum may do everything.
  std::filesystem::path audit{};         ///< The audit log. Empty: no audit log.
  bool insecure = false;                 ///< Permits ports without TLS that other machines can reach.
  double max_views_per_second = 1000.0;  ///< Limit for each session, with bursts of up to a thousand views.
};

/// Decides who may connect, what each peer may do and when it must leave, and records this. The coordinator's loop uses
/// it for every session and node, and the coordinator's ports use it for every call.
///
/// Invariants: 1. a session whose museum is revoked or loses the grant of its scene is returned by tick() at the next
/// check of the files; 2. an unreadable or invalid file changes nothing: the last valid content stays in force, and the
/// log reports the file once; 3. each session and each node has one line in the audit log when it connects and one when
/// it disconnects.
///
/// refusal(), is_revoked() and may_update() are thread-safe; everything else is thread-bound.
class Gatekeeper {
 public:
  using Notice = std::function<void(const std::string& sentence)>;
  struct Leaver {
    std::uint64_t id = 0;
    std::string reason{};
  };
  struct Leavers {
    bool changed = false;  ///< True if a file was read, so that is_revoked() may have changed.
    std::vector<Leaver> sessions{};
    std::vector<Leaver> nodes{};
  };

  /// Reads the files, which must all be valid at the start. Keeps a reference to `clock`. `notice` receives sentences
  /// for the log, on the loop's thread. Errors: kInvalidArgument for grants or revocations without TLS; otherwise those
  /// of the files' readers.
  static Result<std::unique_ptr<Gatekeeper>> open(TrustOptions options, const Clock& clock, Notice notice);

  /// Returns the reason why `who` may not use the port for `wanted`; nothing if it may. Can be used as an Admission.
  std::optional<std::string> refusal(const Identity& who, Role wanted);

  /// Thread-safe.
  [[nodiscard]] bool is_revoked(const Identity& who) const;

  /// Returns true if the museum may fetch versions of its image, which requires a grant. Thread-safe.
  [[nodiscard]] bool may_update(const Identity& who) const;

  /// Returns the museum's grant: one without scenes if it is not listed, and everything for an unauthenticated peer.
  [[nodiscard]] Grant grant_of(const Identity& who) const;

  /// Registers a session and returns its grant. Errors: kNotFound if the museum has no grant; kBusy if it has its
  /// maximum number of sessions.
  Result<Grant> session_connected(std::uint64_t id, const Identity& who);
  void session_opened(std::uint64_t id, const wire::SceneDescription& scene);
  /// Checks a view. Errors: kInvalidArgument if the session requests more views per second than a visitor could see or,
  /// unless its grant frees the eye, a view that no visitor could have (see ViewGuard); kBusy if the museum has reached
  /// a daily limit.
  Status view_received(std::uint64_t id, const wire::View& view);
  /// Records that the museum received `reply`. Returns when the museum's byte limit permits the next reply: now or
  /// later.
  TimePoint reply_written(std::uint64_t id, const wire::SessionReply& reply);
  /// Records the end of a session. An empty `reason` means that the museum left. Does nothing for an unknown session.
  void session_ended(std::uint64_t id, const std::string& reason);

  void node_connected(std::uint64_t id, const Identity& who);
  void node_disconnected(std::uint64_t id, const std::string& reason);

  /// Checks the files about twice a second. Returns the peers that must leave now; the caller then calls
  /// session_ended() and node_disconnected() for them.
  Leavers tick();

 private:
  struct Session {
    Identity who{};
    Grant grant{};
    std::string scene{};  ///< Empty until the session is opened.
    TimePoint opened_at{};
    SessionSummary summary{};
    TokenBucket views;
    std::optional<ViewGuard> guard{};  ///< Set for a museum with a grant once the session is opened.
  };
  Gatekeeper(TrustOptions options, const Clock& clock, Notice notice);
  Status read_files();
  /// The next two return true if something new was read.
  Result<bool> read_grants();
  Result<bool> read_revocations();
  [[nodiscard]] std::optional<std::string> why_leave(const Session& session) const;
  void record(const AuditEvent& event);
  /// Records a refusal that a peer may repeat endlessly; logs it at most once a minute.
  void record_refusal(const AuditEvent& event);

  const TrustOptions options_;
  const Clock& clock_;
  const Notice notice_;
  std::unique_ptr<AuditLog> audit_;  ///< Null if there is no audit log.
  WatchedFile grants_file_;
  WatchedFile revocations_file_;
  std::optional<Grants> grants_;  ///< Empty: every museum may do everything.
  std::map<std::uint64_t, Session> sessions_;
  std::map<std::uint64_t, Identity> nodes_;
  std::map<std::string, TokenBucket> bytes_;  ///< Budgets of the museums with a byte limit.
  std::map<std::string, DailyViews> days_;    ///< Counts of the museums with a grant.
  TimePoint next_check_{};
  bool logged_out_of_date_ = false;
  bool logged_audit_failure_ = false;

  mutable std::mutex mutex_;  ///< Guards the following.
  Revocations revocations_;
  std::optional<std::set<std::string, std::less<>>> updated_;  ///< Museums that may fetch updates; empty: all.
  std::map<std::string, TimePoint> refused_at_;                ///< Keyed by peer and reason.
  std::optional<std::string> audit_failure_;                   ///< Failure that was not reported yet.
};

}  // namespace cyclorama::trust
