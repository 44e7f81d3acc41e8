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
#include "renderfarm/trust/watched_file.h"

namespace cyclorama {

struct TrustOptions {
  std::optional<TlsFiles> tls{};          ///< Without it everybody is welcome, and may do everything.
  std::filesystem::path revoked{};        ///< The authority's crl.pem. Empty: no certificate is revoked.
  std::filesystem::path museums{};        ///< museums.toml. Empty: every museum may do everything.
  std::filesystem::path audit{};          ///< Empty: no audit log.
  bool insecure = false;                  ///< Ports that others can reach, without TLS.
  double most_views_per_second = 1000.0;  ///< Of one visit; a thousand at once are let pass.
};

/// Who may come in, what they may do there, when they must leave, and the record of it. Used by the head's loop for
/// every visit and node, and by its ports for every call.
///
/// Invariants: 1. a museum that is revoked, or loses the grant of what it visits, is among tick()'s leavers at the next
/// look at the files; 2. a file that cannot be read or is wrong changes nothing: what the last good one said stays, and
/// the log says so once; 3. each visit and each node has one line in the audit log when it comes, and one when it goes.
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
    bool changed = false;  ///< A file was read: what is_revoked() says may be another.
    std::vector<Leaver> visits{};
    std::vector<Leaver> nodes{};
  };

  /// Reads the files. `clock` is borrowed. `notice` gets sentences for the log, on the loop's thread.
  /// kInvalidArgument  grants or revocations without TLS.     Else as the files' readers: at the start all must be
  /// good.
  static Result<std::unique_ptr<Gatekeeper>> open(TrustOptions options, const Clock& clock, Notice notice);

  /// Why somebody may not use the port that is for `wanted`; nothing: welcome. An Admission.
  std::optional<std::string> refusal(const Identity& who, Role wanted);

  /// Thread-safe.
  [[nodiscard]] bool is_revoked(const Identity& who) const;

  /// Whether it may fetch versions of its image: without a grant not. Thread-safe.
  [[nodiscard]] bool may_update(const Identity& who) const;

  /// What the museum may do. Without a grant it sees no scene. Nobody's is everything.
  [[nodiscard]] Grant grant_of(const Identity& who) const;

  /// A visit's call came in: what it may do.
  /// kNotFound  the museum has no grant.     kBusy  it has as many visits as it may have.
  Result<Grant> visit_came(std::uint64_t id, const Identity& who);
  void visit_opened(std::uint64_t id, const std::string& scene);
  /// kInvalidArgument  it asks for more views than any visitor can look at.
  Status view_came(std::uint64_t id);
  /// The museum took it. When its limit of bytes allows the next: now, or later.
  TimePoint took(std::uint64_t id, const wire::VisitReply& reply);
  /// `reason` empty: the museum left. Does nothing for a visit that it does not know (any more).
  void visit_ended(std::uint64_t id, const std::string& reason);

  void node_came(std::uint64_t id, const Identity& who);
  void node_gone(std::uint64_t id, const std::string& reason);

  /// Looks at the files, if it is time: about twice a second. Who must leave now; visit_ended() and node_gone() follow.
  Leavers tick();

 private:
  struct Visit {
    Identity who{};
    Grant grant{};
    std::string scene{};  ///< Empty until it is opened.
    TimePoint opened_at{};
    VisitSummary summary{};
    TokenBucket views;
  };
  Gatekeeper(TrustOptions options, const Clock& clock, Notice notice);
  Status read_files();
  /// Each: true when something new was read.
  Result<bool> read_grants();
  Result<bool> read_revocations();
  [[nodiscard]] std::optional<std::string> why_leave(const Visit& visit) const;
  void record(const AuditEvent& event);
  /// For what somebody may do again and again: once a minute.
  void record_refusal(const AuditEvent& event);

  const TrustOptions options_;
  const Clock& clock_;
  const Notice notice_;
  std::unique_ptr<AuditLog> audit_;  ///< Null: none.
  WatchedFile grants_file_;
  WatchedFile revocations_file_;
  std::optional<Grants> grants_;  ///< Nothing: every museum may do everything.
  std::map<std::uint64_t, Visit> visits_;
  std::map<std::uint64_t, Identity> nodes_;
  std::map<std::string, TokenBucket> bytes_;  ///< Of museums with a limit.
  TimePoint next_look_{};
  bool told_out_of_date_ = false;
  bool told_audit_fails_ = false;

  mutable std::mutex mutex_;  ///< Guards the following.
  Revocations revocations_;
  std::optional<std::set<std::string, std::less<>>> updated_;  ///< Museums' names; nothing: all.
  std::map<std::string, TimePoint> refused_at_;                ///< By who and why.
  std::optional<std::string> audit_failure_;                   ///< Not told yet.
};

}  // namespace cyclorama
