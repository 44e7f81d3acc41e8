// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/trust/gatekeeper.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "common/base/file.h"
#include "common/base/text.h"
#include "common/wire/convert.h"
#include "common/wire/payload.h"

namespace cyclorama::trust {
namespace {

constexpr Duration kLookEvery = std::chrono::milliseconds(500);
constexpr Duration kSameRefusal = std::chrono::minutes(1);
constexpr std::size_t kMaxRefusals = 1000;
/// Maximum delay of a frame, so that a museum whose pictures exceed its byte limit still gets one from time to time.
constexpr Duration kMaxDelay = std::chrono::seconds(10);
constexpr std::size_t kMaxAuthorityBytes = 1 << 20;

/// A grant without scenes, for a museum that museums.toml does not name.
Grant nothing_for(const std::string& museum) { return {.museum = museum, .scenes = {}}; }

}  // namespace

Result<std::unique_ptr<Gatekeeper>> Gatekeeper::open(TrustOptions options, const Clock& clock, Notice notice) {
  if (!options.tls && !(options.revoked.empty() && options.museums.empty())) {
    return Error(ErrorCode::kInvalidArgument,
                 "'museums_file' and 'revoked' need [tls]: without certificates no peer can be identified");
  }
  std::unique_ptr<Gatekeeper> made(new Gatekeeper(std::move(options), clock, std::move(notice)));
  TRY(made->read_files());
  return made;
}

Gatekeeper::Gatekeeper(TrustOptions options, const Clock& clock, Notice notice)
    : options_(std::move(options)),
      clock_(clock),
      notice_(std::move(notice)),
      grants_file_(options_.museums),
      revocations_file_(options_.revoked) {}

Status Gatekeeper::read_files() {
  if (!options_.audit.empty()) {
    TRY_ASSIGN(audit_, AuditLog::open(options_.audit));
  }
  TRY(read_grants());
  TRY(read_revocations());
  return Done{};
}

Result<bool> Gatekeeper::read_grants() {
  if (options_.museums.empty()) return false;
  auto changed = grants_file_.changed();
  if (!changed) return false;
  TRY_ASSIGN(const std::string text, *std::move(changed));
  TRY_ASSIGN(grants_, Grants::parse(text, options_.museums.string()));
  bytes_.clear();
  std::set<std::string, std::less<>> updated;
  for (const auto& [name, grant] : grants_->all()) {
    if (grant.updates) updated.insert(name);
  }
  {
    const std::lock_guard lock(mutex_);
    updated_ = std::move(updated);
  }
  notice_(fmt::format("'{}' was read: {} museums", options_.museums.string(), grants_->size()));
  record({.event = "grants read", .reason = fmt::format("{} museums", grants_->size())});
  return true;
}

Result<bool> Gatekeeper::read_revocations() {
  if (options_.revoked.empty()) return false;
  auto changed = revocations_file_.changed();
  if (!changed) return false;
  TRY_ASSIGN(const std::string text, *std::move(changed));
  TRY_ASSIGN(const std::string authority, read_text_file(options_.tls->authority, kMaxAuthorityBytes));
  auto read = Revocations::parse(text, authority);
  if (!read) {
    return Error(ErrorCode::kBadData, fmt::format("'{}' {}", options_.revoked.string(), read.error().message()));
  }
  notice_(fmt::format("'{}' was read: {} certificates are revoked", options_.revoked.string(), read->size()));
  record({.event = "revocations read", .reason = fmt::format("{} certificates", read->size())});
  logged_out_of_date_ = false;
  const std::lock_guard lock(mutex_);
  revocations_ = *std::move(read);
  return true;
}

std::optional<std::string> Gatekeeper::refusal(const Identity& who, Role wanted) {
  std::string reason;
  if (who.role != wanted) {
    reason = fmt::format("this port is for the certificates of a {}, and this one is of a {}", to_text(wanted),
                         to_text(who.role));
  } else if (is_revoked(who)) {
    reason = fmt::format("the certificate of '{}' was revoked; ask the farm for a new one", who.name);
  } else {
    return std::nullopt;
  }
  record_refusal({.event = fmt::format("{} refused", to_text(who.role)), .who = who, .reason = reason});
  return reason;
}

bool Gatekeeper::is_revoked(const Identity& who) const {
  const std::lock_guard lock(mutex_);
  return revocations_.contains(who.serial);
}

bool Gatekeeper::may_update(const Identity& who) const {
  const std::lock_guard lock(mutex_);
  return who.role == Role::kNobody || !updated_ || updated_->contains(who.name);
}

Grant Gatekeeper::grant_of(const Identity& who) const {
  if (who.role == Role::kNobody) return {};
  if (!grants_) return {.museum = who.name};
  const Grant* const found = grants_->find(who.name);
  return found == nullptr ? nothing_for(who.name) : *found;
}

Result<Grant> Gatekeeper::session_connected(std::uint64_t id, const Identity& who) {
  const Grant grant = grant_of(who);
  const auto refuse = [&](ErrorCode code, const std::string& reason) {
    record_refusal({.event = "session refused", .who = who, .reason = reason});
    return Error(code, reason);
  };
  if (grant.scenes.empty()) {
    return refuse(ErrorCode::kNotFound,
                  fmt::format("the farm has no grant for '{}'; its operator must add it to museums.toml", who.name));
  }
  if (who.role != Role::kNobody) {
    const auto open = std::ranges::count_if(sessions_, [&](const auto& v) { return v.second.who.name == who.name; });
    if (open >= grant.sessions) {
      return refuse(ErrorCode::kBusy, fmt::format("'{}' already has its maximum of {} sessions", who.name, open));
    }
  }
  sessions_.insert_or_assign(id, Session{.who = who, .grant = grant, .views = {options_.max_views_per_second, 1000.0}});
  return grant;
}

void Gatekeeper::session_opened(std::uint64_t id, const wire::SceneDescription& scene) {
  const auto found = sessions_.find(id);
  if (found == sessions_.end()) return;
  found->second.scene = scene.name();
  if (grants_ && !found->second.grant.free_eye) found->second.guard.emplace(scene);
  found->second.opened_at = clock_.now();
  record({.event = "session opened", .who = found->second.who, .scene = scene.name()});
}

Status Gatekeeper::view_received(std::uint64_t id, const wire::View& view) {
  const auto found = sessions_.find(id);
  if (found == sessions_.end()) return Done{};
  Session& session = found->second;
  const TimePoint now = clock_.now();
  if (session.views.take(1.0, now) > now) {
    return Error(ErrorCode::kInvalidArgument,
                 fmt::format("more than {:.0f} views per second were requested", options_.max_views_per_second));
  }
  if (!grants_) return Done{};
  TRY(validate(view));
  if (session.guard) TRY(session.guard->check(view, now));
  const std::int64_t day = now.time_since_epoch() / std::chrono::hours(24);
  const DailyViews::Limits limits{session.grant.views_per_day, session.grant.places_per_day};
  return days_[session.who.name].count(session.scene, view, limits, day);
}

TimePoint Gatekeeper::reply_written(std::uint64_t id, const wire::SessionReply& reply) {
  const TimePoint now = clock_.now();
  const auto found = sessions_.find(id);
  if (found == sessions_.end()) return now;
  Session& session = found->second;
  if (reply.has_end() && reply.end().complete()) ++session.summary.frames;
  const std::size_t bytes = reply.has_tile() ? payload_bytes(reply.tile()) : 0;
  session.summary.bytes += bytes;
  const double limit = session.grant.bytes_per_second;
  if (limit <= 0.0) return now;
  const auto bucket = bytes_.try_emplace(session.who.name, limit, limit).first;
  const TimePoint due = bucket->second.take(static_cast<double>(bytes), now);
  // Only the end of a frame delays the next frame.
  return reply.has_end() ? std::min(due, now + kMaxDelay) : now;
}

void Gatekeeper::session_ended(std::uint64_t id, const std::string& reason) {
  const auto found = sessions_.find(id);
  if (found == sessions_.end()) return;
  Session session = std::move(found->second);
  sessions_.erase(found);
  if (session.scene.empty()) {
    if (!reason.empty()) record_refusal({.event = "session refused", .who = session.who, .reason = reason});
    return;
  }
  session.summary.seconds = to_seconds(clock_.now() - session.opened_at);
  record({.event = "session ended",
          .who = session.who,
          .scene = session.scene,
          .reason = reason,
          .session = session.summary});
}

void Gatekeeper::node_connected(std::uint64_t id, const Identity& who) {
  record({.event = "node came", .who = who});
  nodes_.insert_or_assign(id, who);
}

void Gatekeeper::node_disconnected(std::uint64_t id, const std::string& reason) {
  const auto found = nodes_.find(id);
  if (found == nodes_.end()) return;
  record({.event = "node gone", .who = found->second, .reason = reason});
  nodes_.erase(found);
}

std::optional<std::string> Gatekeeper::why_leave(const Session& session) const {
  if (is_revoked(session.who)) return "its certificate was revoked";
  const Grant now = grant_of(session.who);
  if (now.scenes.empty()) return "the farm has no grant for it any more";
  if (!session.scene.empty() && !now.allows(session.scene))
    return fmt::format("scene '{}' is not granted any more", session.scene);
  return std::nullopt;
}

Gatekeeper::Leavers Gatekeeper::tick() {
  if (clock_.now() < next_check_) return {};
  next_check_ = clock_.now() + kLookEvery;
  bool changed = false;
  for (const Result<bool>& read : {read_grants(), read_revocations()}) {
    if (read) {
      changed = changed || *read;
      continue;
    }
    const std::string sentence = read.error().message() + "; its previous content stays in force";
    notice_(sentence);
    record({.event = "settings refused", .reason = sentence});
  }
  {
    const std::lock_guard lock(mutex_);
    if (!logged_out_of_date_ && revocations_.is_out_of_date()) {
      notice_(fmt::format("'{}' should have been replaced by {}; make a new one with cyclorama-authority refresh",
                          options_.revoked.string(), revocations_.next_update()));
      logged_out_of_date_ = true;
    }
    if (const auto failure = std::exchange(audit_failure_, std::nullopt);
        failure && !std::exchange(logged_audit_failure_, true)) {
      notice_(*failure + "; sessions continue without it");
    }
  }
  if (!changed) return {};
  Leavers leavers{.changed = true};
  for (const auto& [id, session] : sessions_) {
    if (const auto reason = why_leave(session)) {
      notice_(fmt::format("'{}' must leave: {}", session.who.name, *reason));
      leavers.sessions.push_back({id, *reason});
    }
  }
  for (const auto& [id, who] : nodes_) {
    if (!is_revoked(who)) continue;
    notice_(fmt::format("node '{}' must leave: its certificate was revoked", who.name));
    leavers.nodes.push_back({id, "its certificate was revoked"});
  }
  return leavers;
}

void Gatekeeper::record(const AuditEvent& event) {
  if (audit_ == nullptr) return;
  if (const Status written = audit_->write(event); !written) {
    const std::lock_guard lock(mutex_);
    audit_failure_ = written.error().message();
  }
}

void Gatekeeper::record_refusal(const AuditEvent& event) {
  {
    const std::lock_guard lock(mutex_);
    if (refused_at_.size() > kMaxRefusals) refused_at_.clear();
    TimePoint& last = refused_at_[fmt::format("{} {} {}", event.event, event.who.name, event.reason)];
    if (last != TimePoint{} && clock_.now() - last < kSameRefusal) return;
    last = clock_.now();
  }
  record(event);
}

}  // namespace cyclorama::trust
