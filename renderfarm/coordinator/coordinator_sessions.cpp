// SPDX-License-Identifier: Apache-2.0
// Handling of museums' sessions.
#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "common/base/text.h"
#include "common/wire/convert.h"
#include "common/wire/payload.h"
#include "renderfarm/coordinator/coordinator_state.h"
#include "renderfarm/governor/stored_light_front.h"

namespace cyclorama::coordinator {
namespace {

/// Maximum samples of a view with stored light. More would show no difference, and would delay other museums' blocks,
/// because the samples of a cell are traced together.
constexpr std::uint32_t kMaxStoredLightSamples = 64;

Status check_quota(const char* what, std::uint32_t requested, int granted) {
  if (static_cast<std::int64_t>(requested) <= granted) return Done{};
  return Error(ErrorCode::kInvalidArgument,
               fmt::format("view.{} is {}; this museum's grant allows at most {}", what, requested, granted));
}

}  // namespace

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
  session.balancer = balance::make_balancer(strategy_);
  sessions_.emplace(id, std::move(session));
}

void CoordinatorState::session_requested(SessionId id, const wire::SessionRequest& request, TimePoint received_at) {
  const auto found = sessions_.find(id);
  if (found == sessions_.end()) return;
  Session& session = found->second;
  Status fine = Done{};
  if (request.has_open() != session.scene.empty()) {
    fine = Error(ErrorCode::kInvalidArgument, "a session must be opened first, and once");
  } else if (request.has_open()) {
    fine = open(id, session, request.open());
  } else if (request.has_view()) {
    fine = request_view(session, request.view(), received_at);
  } else {
    fine = Error(ErrorCode::kInvalidArgument, "a message of unknown kind");
  }
  if (fine) {
    advance(id);
    watch(id);
    return;
  }
  const std::string refusal = fmt::format("the session of '{}' is refused: {}", session.museum, fine.error().message());
  // A museum that waits for a scene reconnects again and again; identical refusals are logged once.
  if (refusal != last_refusal_)
    delegate_.notice(refusal, {.museum = session.museum, .session = id, .is_trouble = true});
  last_refusal_ = refusal;
  forget_session(id);
  delegate_.end_session(id, fine.error(), false);
}

Result<std::unique_ptr<GovernorState>> CoordinatorState::governed_by(const wire::OpenSession& open,
                                                                     const std::string& scene, int max_samples) const {
  constexpr double kMaxBudgetMs = 60000.0;
  constexpr std::uint32_t kUsualReference = 1024;
  constexpr std::uint32_t kMaxReferenceSamples = 4096;
  const double budget_ms = open.frame_budget_ms();
  if (budget_ms == 0.0) return std::unique_ptr<GovernorState>();
  if (!(budget_ms > 0.0 && budget_ms <= kMaxBudgetMs)) {
    return Error(ErrorCode::kInvalidArgument,
                 fmt::format("open.frame_budget_ms is {}; it must be 0 to {}", budget_ms, kMaxBudgetMs));
  }
  if (open.reference_samples() > kMaxReferenceSamples) {
    return Error(ErrorCode::kInvalidArgument, fmt::format("open.reference_samples is {}; it must be at most {}",
                                                          open.reference_samples(), kMaxReferenceSamples));
  }
  const std::uint32_t samples = open.reference_samples() == 0 ? kUsualReference : open.reference_samples();
  return governed_by(budget_ms, std::min(static_cast<int>(samples), max_samples), scene);
}

std::unique_ptr<GovernorState> CoordinatorState::governed_by(double budget_ms, int reference_samples,
                                                             const std::string& scene) const {
  const bool has_light = !light_in_use(scene).empty();
  const auto measured = pareto_fronts_.find(scene);
  if (measured != pareto_fronts_.end() && (has_light || !governor::uses_stored_light(measured->second))) {
    return std::make_unique<GovernorState>(governor::Governor(measured->second, budget_ms), reference_samples,
                                           std::nullopt);
  }
  const auto known = bounces_.find(scene);
  const int bounces = known == bounces_.end() ? governor::kStandardBounces : known->second;
  governor::ParetoFront front =
      has_light ? governor::stored_light_front(bounces) : governor::ParetoFront::standard(bounces);
  return std::make_unique<GovernorState>(governor::Governor(std::move(front), budget_ms), reference_samples, bounces);
}

Status CoordinatorState::open(SessionId id, Session& session, const wire::OpenSession& open) {
  session.museum = session.grant.museum.empty() ? printable(open.museum()) : session.grant.museum;
  const std::string& wanted = open.scene();  // An empty name selects the first scene that the grant allows.
  const auto scene = std::ranges::find_if(scenes_, [&](const FarmScene& known) {
    return (wanted.empty() || known.name == wanted) && session.grant.allows(known.name);
  });
  if (scene == scenes_.end() && wanted.empty()) {
    return Error(ErrorCode::kNotFound, fmt::format("this farm has no scene for '{}'", session.museum));
  }
  if (scene == scenes_.end()) {
    return Error(ErrorCode::kNotFound,
                 fmt::format("this farm has no scene '{}'; request the list of scenes", printable(wanted)));
  }
  if (nodes_with(scene->name) == 0) {
    order_scene_anew(scene->name);
    return unavailable_reason(scene->name);
  }
  TRY(check_scene_memory(session, scene->name));
  TRY_ASSIGN(session.governed, governed_by(open, scene->name, session.grant.samples));
  session.scene = scene->name;
  wire::SessionReply reply;
  *reply.mutable_opened() = descriptions_.at(scene->name);
  send(id, session, std::move(reply));
  delegate_.notice(fmt::format("'{}' opened scene '{}'", session.museum, scene->name),
                   {.museum = session.museum, .session = id});
  return Done{};
}

Status CoordinatorState::request_view(Session& session, const wire::View& view, TimePoint received_at) {
  TRY(validate(view));
  const std::int64_t px = std::int64_t{view.panorama().width_px()} * view.panorama().height_px();
  if (px > limits_.picture_px) {
    return Error(ErrorCode::kInvalidArgument,
                 fmt::format("view.panorama has {} pixels; this farm renders at most {}", px, limits_.picture_px));
  }
  TRY(check_quota("samples", view.samples(), session.grant.samples));
  TRY(check_quota("bounces", view.bounces(), session.grant.bounces));
  if (view.stored_light() && view.samples() > kMaxStoredLightSamples) {
    return Error(ErrorCode::kInvalidArgument, fmt::format("view.samples is {}; with stored light it is at most {}",
                                                          view.samples(), kMaxStoredLightSamples));
  }
  if (view.number() <= session.newest_view) {
    return Error(ErrorCode::kInvalidArgument,
                 fmt::format("view.number is {} after {}; it must increase", view.number(), session.newest_view));
  }
  if (view.first_sample() != 0) {
    return Error(ErrorCode::kInvalidArgument, "view.first_sample is not 0; only the farm refines pictures");
  }
  session.newest_view = view.number();
  session.views.put(view.number(), {view, received_at});
  if (session.governed) leave_rest(session);
  return Done{};
}

Status CoordinatorState::check_scene_memory(const Session& session, const std::string& scene) const {
  if (session.grant.scene_bytes <= 0.0) return Done{};
  std::set<std::string> open{scene};
  for (const auto& [id, other] : sessions_) {
    if (other.account == session.account && !other.scene.empty()) open.insert(other.scene);
  }
  double bytes = 0.0;
  for (const std::string& name : open) bytes += static_cast<double>(nodes_.memory_of(name));
  if (bytes <= session.grant.scene_bytes) return Done{};
  return Error(ErrorCode::kBusy,
               fmt::format("scene '{}': with it, the scenes of '{}' need {:.2f} GiB; its grant allows {:.2f} GiB",
                           scene, session.museum, bytes / (1 << 30), session.grant.scene_bytes / (1 << 30)));
}

Error CoordinatorState::unavailable_reason(const std::string& scene) const {
  if (!std::ranges::find(scenes_, scene, &FarmScene::name)->is_ready()) {
    return Error(ErrorCode::kUnavailable, fmt::format("scene '{}': the coordinator is still reading its files", scene));
  }
  std::size_t loading = 0;
  std::string failure;
  for (const auto& [id, node] : nodes_) {
    const auto found = node.scenes.find(scene);
    if (found == node.scenes.end()) continue;
    if (found->second.state == Node::SceneState::kLoading) ++loading;
    if (found->second.state == Node::SceneState::kFailed)
      failure = fmt::format("'{}': {}", node.name, found->second.error);
  }
  std::string why = "no node is connected; start cyclorama-node on the render hosts";
  if (!nodes_.empty()) why = fmt::format("none of {} nodes has it", nodes_.size());
  if (!failure.empty()) why = fmt::format("no node could load it; node {}", failure);
  if (loading > 0) why = fmt::format("{} of {} nodes are loading it; it will be ready soon", loading, nodes_.size());
  return Error(ErrorCode::kUnavailable, fmt::format("scene '{}': {}", scene, why));
}

void CoordinatorState::session_disconnected(SessionId id) {
  const auto found = sessions_.find(id);
  if (found == sessions_.end()) return;
  if (!found->second.scene.empty())
    delegate_.notice(fmt::format("'{}' left", found->second.museum), {.museum = found->second.museum, .session = id});
  forget_session(id);
}

void CoordinatorState::forget_session(SessionId id) {
  const auto found = sessions_.find(id);
  for (const FrameInFlight& frame : found->second.frames) {
    if (!frame.failure) cancel_blocks(frame);
    accounts_.end(found->second.account, frame.turn);
  }
  wire::NodeCommand forget;
  forget.mutable_forget_session()->set_session(static_cast<std::uint64_t>(id));
  for (const auto& [node, known] : nodes_) {
    if (known.has(found->second.scene)) delegate_.to_node(node, forget);
  }
  accounts_.close(found->second.account);
  placement_.forget(id);
  sessions_.erase(found);
}

void CoordinatorState::written(SessionId id, const wire::SessionReply& reply) {
  const auto found = sessions_.find(id);
  if (found == sessions_.end()) return;
  Session& session = found->second;
  CHECK(session.messages_waiting > 0);
  --session.messages_waiting;
  session.taken_at = clock_.now();
  if (reply.has_tile()) session.bytes_waiting -= payload_bytes(reply.tile());
  if (!reply.has_end()) return;
  const WrittenFrame frame = session.unwritten_ends.front();
  session.unwritten_ends.pop_front();
  session.views.finish(frame.view_number);
  if (session.governed) learn(*session.governed, frame);
  advance(id);
  watch(id);
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
    refine(id, session);
  }
  for (const auto& [id, reason] : lost) {
    delegate_.notice(fmt::format("the session of '{}' is ended: {}", sessions_.at(id).museum, reason.message()),
                     {.museum = sessions_.at(id).museum, .session = id, .is_trouble = true});
    forget_session(id);
    delegate_.end_session(id, reason, true);
  }
  std::vector<SessionId> watched;  // Copied, because watch() may end a session.
  for (const auto& [id, session] : sessions_) watched.push_back(id);
  for (const SessionId id : watched) watch(id);
}

}  // namespace cyclorama::coordinator
