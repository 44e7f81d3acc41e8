// SPDX-License-Identifier: Apache-2.0
// Dispatches the messages of museums' sessions.
#include <fmt/format.h>

#include <utility>

#include "common/base/text.h"
#include "renderfarm/coordinator/coordinator_state.h"
#include "renderfarm/coordinator/session_governor.h"

namespace cyclorama::coordinator {

void CoordinatorState::session_connected(SessionId id, trust::Grant grant) {
  if (sessions_.size() >= limits_.sessions) {
    delegate_.end_session(
        id,
        Error(ErrorCode::kBusy,
              fmt::format("this farm accepts {} sessions at once, and that many are open", limits_.sessions)),
        false);
    return;
  }
  Session session;
  session.account = accounts_.open(grant.museum, {grant.weight, grant.cores, grant.megapixels_per_second});
  session.watermark = grant.watermark;
  session.grant = std::move(grant);
  session.arrived_at = clock_.now();
  session.pace_seconds = to_seconds(limits_.first_frame);
  session.balancer = balance::make_balancer(strategy_);
  sessions_.add(id, std::move(session));
}

void CoordinatorState::session_requested(SessionId id, const wire::SessionRequest& request, TimePoint received_at) {
  Session* const session = sessions_.find(id);
  if (session == nullptr) return;
  const Status fine = dispatch(id, *session, request, received_at);
  if (fine) {
    scheduler_.advance(id);
    scheduler_.watch(id);
    return;
  }
  const std::string refusal =
      fmt::format("the session of '{}' is refused: {}", session->museum, fine.error().message());
  // A museum that waits for a scene reconnects again and again; identical refusals are logged once.
  if (refusal != last_refusal_)
    delegate_.notice(refusal, {.museum = session->museum, .session = id, .is_trouble = true});
  last_refusal_ = refusal;
  closer_.end(id, fine.error(), false);
}

Status CoordinatorState::dispatch(SessionId id, Session& session, const wire::SessionRequest& request,
                                  TimePoint received_at) {
  if (request.has_open() != session.scene.empty()) {
    return Error(ErrorCode::kInvalidArgument, "a session must be opened first, and once");
  }
  if (request.has_open()) return open(id, session, request.open());
  if (!request.has_view()) return Error(ErrorCode::kInvalidArgument, "a message of unknown kind");
  TRY(admission_.check_view(session, request.view()));
  scheduler_.request(session, request.view(), received_at);
  return Done{};
}

Status CoordinatorState::open(SessionId id, Session& session, const wire::OpenSession& open) {
  session.museum = session.grant.museum.empty() ? printable(open.museum()) : session.grant.museum;
  TRY_ASSIGN(const FarmScene scene, catalogue_.find(open.scene(), session.grant, session.museum));
  if (nodes_with(scene.name) == 0) {
    scene_orders_.order_anew(scene.name);
    return scene_orders_.unavailable_reason(scene.name);
  }
  TRY(admission_.check_scene_memory(session, scene.name));
  TRY_ASSIGN(const int reference_samples, SessionAdmission::reference_samples(session, open));
  if (reference_samples > 0) {
    const bool has_light = !lights_.in_use(scene.name).empty();
    session.governed = catalogue_.governed(open.frame_budget_ms(), reference_samples, scene.name, has_light);
  }
  session.scene = scene.name;
  wire::SessionReply reply;
  *reply.mutable_opened() = *catalogue_.description(scene.name);
  sessions_.send(id, session, std::move(reply));
  delegate_.notice(fmt::format("'{}' opened scene '{}'", session.museum, scene.name),
                   {.museum = session.museum, .session = id});
  return Done{};
}

void CoordinatorState::change_fronts(const std::string& scene) {
  const bool has_light = !lights_.in_use(scene).empty();
  for (auto& [id, session] : sessions_) {
    if (session.scene != scene || !session.governed) continue;
    const GovernorState& old = *session.governed;
    change_front(session, catalogue_.governed(old.governor.budget_ms(), old.reference_samples, scene, has_light));
  }
}

void CoordinatorState::session_disconnected(SessionId id) {
  const Session* const session = sessions_.find(id);
  if (session == nullptr) return;
  if (!session->scene.empty())
    delegate_.notice(fmt::format("'{}' left", session->museum), {.museum = session->museum, .session = id});
  closer_.forget(id);
}

void CoordinatorState::tick_sessions() {
  std::vector<std::pair<SessionId, Error>> lost;
  for (auto& [id, session] : sessions_) {
    if (session.scene.empty() && clock_.now() - session.arrived_at > limits_.silence) {
      lost.emplace_back(id, Error(ErrorCode::kTimedOut, "the session was not opened in time"));
    } else if (session.messages_waiting > 0 && clock_.now() - session.taken_at > limits_.stall) {
      lost.emplace_back(id, Error(ErrorCode::kTimedOut,
                                  fmt::format("the museum took nothing for {:.0f} s", to_seconds(limits_.stall))));
    }
    scheduler_.refine(id, session);
  }
  for (const auto& [id, reason] : lost) {
    delegate_.notice(fmt::format("the session of '{}' is ended: {}", sessions_.at(id).museum, reason.message()),
                     {.museum = sessions_.at(id).museum, .session = id, .is_trouble = true});
    closer_.end(id, reason, true);
  }
  std::vector<SessionId> watched;  // Copied, because watch() may end a session.
  for (const auto& [id, session] : sessions_) watched.push_back(id);
  for (const SessionId id : watched) scheduler_.watch(id);
}

}  // namespace cyclorama::coordinator
