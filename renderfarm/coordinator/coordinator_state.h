// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "common/base/clock.h"
#include "common/base/result.h"
#include "common/wire/farm.pb.h"
#include "common/wire/nodes.pb.h"
#include "renderfarm/balance/balancer.h"
#include "renderfarm/coordinator/accounts.h"
#include "renderfarm/coordinator/block_orders.h"
#include "renderfarm/coordinator/block_reassignment.h"
#include "renderfarm/coordinator/deadlines.h"
#include "renderfarm/coordinator/delegate.h"
#include "renderfarm/coordinator/frame_planner.h"
#include "renderfarm/coordinator/frame_scheduler.h"
#include "renderfarm/coordinator/ids.h"
#include "renderfarm/coordinator/node_speeds.h"
#include "renderfarm/coordinator/node_table.h"
#include "renderfarm/coordinator/placement.h"
#include "renderfarm/coordinator/resting_pictures.h"
#include "renderfarm/coordinator/scene_catalogue.h"
#include "renderfarm/coordinator/scene_lights.h"
#include "renderfarm/coordinator/scene_orders.h"
#include "renderfarm/coordinator/session_admission.h"
#include "renderfarm/coordinator/session_closer.h"
#include "renderfarm/coordinator/session_table.h"
#include "renderfarm/trust/grants.h"
#include "renderfarm/watch/farm_overview.h"

namespace cyclorama::coordinator {

struct CoordinatorLimits {
  std::size_t nodes = 512;
  std::size_t sessions = 64;
  /// Maximum pixels of one picture (8192 × 8192).
  std::int64_t picture_px = std::int64_t{1} << 26;
  /// Maximum bytes of tiles that wait to be written to one museum; beyond that, its newest frame is given up.
  std::size_t session_bytes = std::size_t{256} << 20;
  Duration silence = std::chrono::seconds(10);  ///< Timeout for a new peer's first message (hello or open).
  Duration stall = std::chrono::seconds(30);    ///< Timeout for a museum that takes none of its queued messages.
  /// Frame time that a session's first deadlines assume, until its own frames have been measured.
  Duration first_frame = std::chrono::milliseconds(500);
  /// Time that nodes have to connect and report the light that they have, before one is ordered to compute it.
  Duration light_gathering = std::chrono::seconds(3);
};

/// The scheduling logic of the coordinator: which peers are connected, which node renders what, and what is sent to
/// whom. Pure: it uses no threads, sockets or system clock. Events arrive as calls; commands leave through
/// CoordinatorDelegate. Used by Coordinator; thread-bound.
///
/// It only dispatches events to parts that have one duty each and can be tested alone:
///
///   who is there     NodeTable, SessionTable, SessionAdmission (what a museum may request), SessionCloser
///   what there is    SceneCatalogue, SceneOrders (which node loads what), SceneLights (light computed ahead)
///   whose turn       Accounts; nodes serve blocks by rank, so museums take turns
///   where            Placement (which nodes a session uses), NodeSpeeds, FramePlanner (who renders which part)
///   frames           FrameScheduler (from a view to the frame's end), RestingPictures (refines a picture at rest)
///   blocks           BlockOrders, BlockReassignment (of slow, silent and lost nodes), Deadlines (what is late)
class CoordinatorState {
 public:
  /// The first scene is the default. Precondition: there is at least one scene, and the names are unique.
  CoordinatorState(std::vector<FarmScene> scenes, balance::BalanceStrategy strategy, CoordinatorLimits limits,
                   const Clock& clock, CoordinatorDelegate& delegate);

  void node_connected(NodeId node);
  void node_reported(NodeId node, wire::NodeReport report);
  void node_disconnected(NodeId node);
  /// To be called when a node has sent this light's file; FetchFile serves the file from then on.
  void light_stored(const std::string& version) { lights_.stored(version); }
  /// To be called when the file list of a distributed scene has been read; nodes may then load the scene.
  void scene_read(const std::string& scene, const std::string& digest) { scene_orders_.read(scene, digest); }

  /// `grant` holds the session's permissions.
  void session_connected(SessionId session, trust::Grant grant = {});
  void session_requested(SessionId session, const wire::SessionRequest& request, TimePoint received_at);
  /// To be called when the museum has closed its side, or the connection broke.
  void session_disconnected(SessionId session);
  /// To be called when the command to render a block has been written to the node's stream.
  void order_written(NodeId node, std::uint64_t block, TimePoint at) { scheduler_.order_written(node, block, at); }
  /// To be called when a message has been written to the museum's stream.
  void written(SessionId session, const wire::SessionReply& reply) { scheduler_.written(session, reply); }

  /// To be called at next_deadline(), and at least every second: handles late nodes and frames, unauthenticated peers
  /// and stalled museums.
  void tick();
  [[nodiscard]] TimePoint next_deadline() const { return scheduler_.next_deadline(); }

  [[nodiscard]] wire::ListScenesReply scenes(const trust::Grant& grant = {}) const { return catalogue_.list(grant); }
  [[nodiscard]] std::size_t nodes_with(const std::string& scene) const { return nodes_.count_with(scene); }
  [[nodiscard]] std::size_t nodes() const { return nodes_.size(); }
  [[nodiscard]] std::size_t sessions() const { return sessions_.size(); }
  /// Returns null if no node has described the scene.
  [[nodiscard]] const wire::SceneDescription* description(const std::string& scene) const {
    return catalogue_.description(scene);
  }
  [[nodiscard]] const std::vector<FarmScene>& farm_scenes() const { return catalogue_.all(); }
  /// Returns one sentence for the operator.
  [[nodiscard]] std::string summary() const;
  /// Returns the name of the session's museum; empty if the session is not open.
  [[nodiscard]] std::string museum_of(SessionId session) const;
  /// Returns the known state of registered nodes, open sessions and scenes; CoordinatorMetrics adds measurements.
  [[nodiscard]] watch::FarmOverview overview() const;

 private:
  // Nodes: coordinator_nodes.cpp
  Status dispatch(NodeId id, Node& node, wire::NodeReport& report);
  Status hello(NodeId id, Node& node, const wire::Hello& hello);
  void tick_nodes();

  // Sessions: coordinator_sessions.cpp
  Status dispatch(SessionId id, Session& session, const wire::SessionRequest& request, TimePoint received_at);
  Status open(SessionId id, Session& session, const wire::OpenSession& open);
  /// Gives the governors of the scene's sessions the Pareto front that fits the scene's light.
  void change_fronts(const std::string& scene);
  void tick_sessions();

  const balance::BalanceStrategy strategy_;
  const CoordinatorLimits limits_;
  const Clock& clock_;
  CoordinatorDelegate& delegate_;
  NodeTable nodes_;
  NodeSpeeds speeds_;
  SessionTable sessions_{clock_, delegate_};
  Accounts accounts_;
  Placement placement_;
  const Deadlines deadlines_{nodes_, speeds_, clock_};
  SceneCatalogue catalogue_;
  SceneLights lights_{limits_.light_gathering, nodes_, speeds_, clock_, delegate_, [this](const std::string& scene) {
                        change_fronts(scene);
                      }};
  SceneOrders scene_orders_{catalogue_, nodes_, speeds_, lights_, sessions_, clock_, delegate_};
  const SessionAdmission admission_{limits_.picture_px, nodes_, sessions_};
  BlockOrders orders_{nodes_, sessions_, accounts_, clock_, delegate_};
  BlockReassignment reassignment_{nodes_, speeds_, sessions_, orders_, clock_, delegate_};
  SessionCloser closer_{nodes_, sessions_, accounts_, placement_, orders_, delegate_};
  FramePlanner planner_{nodes_, speeds_, placement_, accounts_, clock_};
  RestingPictures resting_{nodes_, lights_, planner_, orders_, accounts_, clock_};
  FrameScheduler scheduler_{limits_.session_bytes,
                            {clock_, delegate_, nodes_, sessions_, deadlines_, lights_, scene_orders_, planner_,
                             orders_, reassignment_, resting_, closer_}};
  std::string last_refusal_;
};

}  // namespace cyclorama::coordinator
