// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "common/base/clock.h"
#include "common/base/result.h"
#include "common/wire/farm.pb.h"
#include "common/wire/nodes.pb.h"
#include "renderfarm/coordinator/delegate.h"
#include "renderfarm/coordinator/ids.h"
#include "renderfarm/coordinator/session.h"
#include "renderfarm/trust/grants.h"
#include "renderfarm/watch/farm_overview.h"

namespace cyclorama::coordinator {

struct FarmScene {
  std::string name;
  std::string path;
  bool on_coordinator =
      false;             ///< The path is on the coordinator's disk, not on the nodes': they fetch what they lack.
  std::string digest{};  ///< With on_coordinator: of its list of files; empty until they have been read.

  /// Whether nodes can be told where it is.
  [[nodiscard]] bool is_ready() const { return !on_coordinator || !digest.empty(); }
};

struct CoordinatorLimits {
  std::size_t nodes = 512;
  std::size_t sessions = 64;
  /// Of one picture: 8192 x 8192.
  std::int64_t picture_px = std::int64_t{1} << 26;
  /// Tiles that one museum has not yet taken; beyond, its newest frame is given up.
  std::size_t session_bytes = std::size_t{256} << 20;
  Duration silence = std::chrono::seconds(10);  ///< A stranger's, before its hello or open.
  Duration stall = std::chrono::seconds(30);    ///< A museum's that takes nothing of what waits for it.
};

/// The coordinator's mind: who is there, who renders what, what goes to whom. Pure: it knows no thread, socket or clock;
/// events come in, orders go out through CoordinatorDelegate. Used by Coordinator; thread-bound.
///
/// A session's frames: a view waits in one slot (newest wins) until fewer than two frames are unfinished or unwritten;
/// then it is split among the nodes that have the scene, and all blocks are sent at once, so that a node begins its
/// next block the moment it has sent the last. Nodes take blocks first come, first served: with at most two frames per
/// session in their queues, sessions take turns. Of two frames, the older one's tiles go to the museum as they come,
/// the newer one's are held.
///
/// A session with a frame budget is governed: a Governor chooses each view's quality, and when nothing was asked for a
/// while, the last view is refined, picture after picture, until the reference is reached. Of a refined picture nothing
/// is sent before it is whole, so that the next view ends it without a trace.
///
///   moving ──nothing asked──► refining ──reference──► at rest: no message, no block
///      ▲                          │                       │
///      └──────── a view ──────────┴───────────────────────┘
///
/// Deadlines of a frame count from when no older one of its session is before it; their measure is the session's budget, or
/// what its last frames took if that is more. A node that is done takes blocks that others have not begun. A node that
/// was silent for 60 % of the measure while others are done gets no more blocks, and theirs is what it owes, in parts,
/// so that all help. After twice the measure, a frame that has a successor is given up: the last whole picture stands
/// in for it, and the frame says so. What a node owes that goes or fails is given to others at once. Whoever delivers a
/// tile first counts; the rest is dropped.
///
/// Invariants: 1. the museum gets begin, tiles, end of one frame after the other; 2. no tile twice; 3. a frame that
/// ends `complete` had all its tiles sent; 4. each view is answered by a frame or replaced by a newer one; 5. memory
/// per session is bounded by CoordinatorLimits.
class CoordinatorState {
 public:
  /// The first scene is the default. Precondition: at least one scene, names unlike.
  CoordinatorState(std::vector<FarmScene> scenes, balance::BalanceStrategy strategy, CoordinatorLimits limits,
                   const Clock& clock, CoordinatorDelegate& delegate);

  void node_connected(NodeId node);
  void node_reported(NodeId node, wire::NodeReport report);
  void node_disconnected(NodeId node);
  /// The files of a scene that the coordinator hands out are known now: nodes are told to load it.
  void scene_read(const std::string& scene, const std::string& digest);

  /// What the session may do is in `grant`.
  void session_connected(SessionId session, trust::Grant grant = {});
  void session_requested(SessionId session, const wire::SessionRequest& request, TimePoint received_at);
  /// The museum closed its side, or is gone.
  void session_disconnected(SessionId session);
  /// An order for a block is on the wire.
  void order_written(NodeId node, std::uint64_t block, TimePoint at);
  /// A message to the museum is on the wire.
  void written(SessionId session, const wire::SessionReply& reply);

  /// At next_deadline(), and at least every second: late nodes and frames, strangers, stalled museums.
  void tick();
  [[nodiscard]] TimePoint next_deadline() const;

  [[nodiscard]] wire::ListScenesReply scenes(const trust::Grant& grant = {}) const;
  [[nodiscard]] std::size_t nodes_with(const std::string& scene) const;
  [[nodiscard]] std::size_t nodes() const { return nodes_.size(); }
  [[nodiscard]] std::size_t sessions() const { return sessions_.size(); }
  /// Null when no node has told it.
  [[nodiscard]] const wire::SceneDescription* description(const std::string& scene) const;
  [[nodiscard]] const std::vector<FarmScene>& farm_scenes() const { return scenes_; }
  /// One sentence for the operator.
  [[nodiscard]] std::string summary() const;
  /// Empty when the session is not open.
  [[nodiscard]] std::string museum_of(SessionId session) const;
  /// What is known here of nodes that said hello, sessions that were opened, and scenes; the rest is the meters'.
  [[nodiscard]] watch::FarmOverview overview() const;

 private:
  // Nodes: coordinator_nodes.cpp
  Status hello(NodeId id, Node& node, const wire::Hello& hello);
  Status scene_loaded(Node& node, const wire::SceneLoaded& loaded);
  Status keep_pareto_front(const wire::SceneLoaded& loaded);
  Status tile_received(NodeId id, Node& node, wire::BlockTile& tile);
  Status block_ended(NodeId id, Node& node, const wire::BlockEnd& end);
  void tick_nodes();
  void order_scene(NodeId id, Node& node, const FarmScene& scene, const std::set<std::string>& keep);
  /// For a session that came in vain: those that dropped the scene, or could not load it a while ago, try again.
  void order_scene_anew(const std::string& scene);
  [[nodiscard]] std::set<std::string> scenes_in_use() const;
  void status_received(Node& node, const wire::NodeStatus& status);
  Status scene_dropped(Node& node, const wire::SceneDropped& dropped);
  /// Of one thread of the node that loaded it.
  [[nodiscard]] double relative_speed(const wire::SceneLoaded& loaded);
  void learn_utilisation(Node& node, const wire::BlockEnd& end);
  /// Which utilisation is the usual one.
  void compare_nodes();
  /// Of all its threads: 1 is one thread of the first node that told how fast it is.
  [[nodiscard]] double speed_of(const Node& node, const std::string& scene) const;
  /// The same against the wall's clock: forecasts are thread time, of which nodes that share their hosts get a part.
  [[nodiscard]] double wall_speed_of(const Node& node, const std::string& scene) const;

  // Governed sessions: coordinator_refinement.cpp
  /// Chooses the view's quality.
  static void govern(GovernorState& governed, FrameInFlight* frame);
  /// What a frame that the museum has taken teaches.
  void learn(GovernorState& governed, const WrittenFrame& frame);
  /// A view came: what was refined is no more.
  void leave_rest(Session& session);
  /// Plans the next picture of a session at rest, if there is one.
  void refine(SessionId id, Session& session);
  void finish_refined(SessionId id, Session& session, FrameInFlight& frame, const FrameReport& report);
  [[nodiscard]] static std::string quality_summary(const Session& session);

  // Sessions: coordinator_sessions.cpp
  Status open(SessionId id, Session& session, const wire::OpenSession& open);
  /// Null without a budget.
  [[nodiscard]] Result<std::unique_ptr<GovernorState>> governed_by(const wire::OpenSession& open,
                                                                   const std::string& scene) const;
  Status request_view(Session& session, const wire::View& view, TimePoint received_at);
  [[nodiscard]] Error unavailable_reason(const std::string& scene) const;
  void forget_session(SessionId id);
  void tick_sessions();

  // Faults: coordinator_faults.cpp
  /// The deadlines of the session's foremost frame. May end the session.
  void watch(SessionId id);
  void meet_deadlines(SessionId id);
  [[nodiscard]] TimePoint next_due(const Session& session) const;
  [[nodiscard]] static Duration measure_of(const Session& session);
  [[nodiscard]] TimePoint due_at(const Session& session, const FrameInFlight& frame,
                                 const FrameAssembly::Block& block) const;
  /// Nodes that keep the frame waiting while others are done with it.
  [[nodiscard]] std::vector<NodeId> silent_nodes(const Session& session, const FrameInFlight& frame) const;
  [[nodiscard]] bool has_idle_node(const Session& session, const FrameInFlight& frame) const;
  /// It gets no more blocks, and others what it owes.
  void retire(NodeId id);
  void log_late_node(Node& node);
  void lose_blocks(const std::map<std::uint64_t, BlockLocation>& blocks, NodeId not_to);
  void reassign(SessionId id, Session& session, FrameInFlight& frame, std::vector<PixelRect> tiles, NodeId not_to);
  /// The node is done with the frame: it may take a block that another has not begun.
  void move_block_to_idle(SessionId id, Session& session, FrameInFlight& frame, NodeId idle);
  /// Until the node is free for a more urgent block: half a tile of what it is at.
  [[nodiscard]] double turn_seconds(const Node& node, const std::string& scene) const;

  // Frames: coordinator_frames.cpp
  void plan(SessionId id, Session& session);
  [[nodiscard]] std::vector<AssignedBlock> split(Session& session, const wire::View& view, bool whole_blocks) const;
  [[nodiscard]] NodeId least_loaded(const std::vector<NodeId>& nodes) const;
  void order_block(SessionId id, const Session& session, const FrameInFlight& frame, std::uint64_t block, NodeId node,
                   const PixelRect& rect);
  void fail(FrameInFlight& frame, const std::string& reason, Session& session);
  void cancel_blocks(const FrameInFlight& frame);
  /// Sends what may be sent, ends what is over, plans what waits. After every event of a session; may end the session.
  void advance(SessionId id);
  void relay(SessionId id, Session& session, wire::Tile tile);
  void begin(SessionId id, Session& session, FrameInFlight& frame);
  void finish(SessionId id, Session& session, FrameInFlight& frame);
  [[nodiscard]] FrameReport report_of(SessionId id, const FrameInFlight& frame) const;
  void end(SessionId id, Session& session, const FrameInFlight& frame, const FrameReport& report);
  void send(SessionId id, Session& session, wire::SessionReply reply);
  FrameInFlight* find_frame(const BlockLocation& place);
  /// Those to give blocks to: that have the scene and are neither late nor about to stop, or, if there are none, all
  /// that have it.
  [[nodiscard]] std::vector<NodeId> nodes_for(const std::string& scene, NodeId not_to = {}) const;

  std::vector<FarmScene> scenes_;
  const balance::BalanceStrategy strategy_;
  const CoordinatorLimits limits_;
  const Clock& clock_;
  CoordinatorDelegate& delegate_;
  std::map<NodeId, Node> nodes_;
  std::map<SessionId, Session> sessions_;
  std::map<std::string, wire::SceneDescription> descriptions_;  ///< Of the scenes that some node has or had.
  std::map<std::string, governor::ParetoFront> pareto_fronts_;  ///< Of those that have been measured.
  std::map<std::string, double> probes_;                        ///< Of the first node that told one, by scene.
  std::map<std::string, double> usual_utilisation_;             ///< By scene, as of the last tick: the nodes' median.
  FairShare share_;
  std::uint64_t last_block_ = 0;
  std::uint64_t last_frame_ = 0;
  std::string last_refusal_;
};

}  // namespace cyclorama::coordinator
