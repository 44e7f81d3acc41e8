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
#include "renderfarm/coordinator/accounts.h"
#include "renderfarm/coordinator/deadlines.h"
#include "renderfarm/coordinator/delegate.h"
#include "renderfarm/coordinator/ids.h"
#include "renderfarm/coordinator/node_speeds.h"
#include "renderfarm/coordinator/node_table.h"
#include "renderfarm/coordinator/placement.h"
#include "renderfarm/coordinator/session.h"
#include "renderfarm/trust/grants.h"
#include "renderfarm/watch/farm_overview.h"

namespace cyclorama::coordinator {

struct FarmScene {
  std::string name;
  std::string path;
  /// True if the path is on the coordinator's disk; nodes then fetch the files that they lack.
  bool on_coordinator = false;
  std::string digest{};  ///< If on_coordinator, the digest of its file list; empty until the files have been read.

  /// Returns true once the scene can be announced to nodes.
  [[nodiscard]] bool is_ready() const { return !on_coordinator || !digest.empty(); }
};

struct CoordinatorLimits {
  std::size_t nodes = 512;
  std::size_t sessions = 64;
  /// Maximum pixels of one picture (8192 × 8192).
  std::int64_t picture_px = std::int64_t{1} << 26;
  /// Maximum bytes of tiles that wait to be written to one museum; beyond that, its newest frame is given up.
  std::size_t session_bytes = std::size_t{256} << 20;
  Duration silence = std::chrono::seconds(10);  ///< Timeout for a new peer's first message (hello or open).
  Duration stall = std::chrono::seconds(30);    ///< Timeout for a museum that takes none of its queued messages.
  /// Time that nodes have to connect and report the light that they have, before one is ordered to compute it.
  Duration light_gathering = std::chrono::seconds(3);
};

/// The scheduling logic of the coordinator: which peers are connected, which node renders what, and what is sent to
/// whom. Pure: it uses no threads, sockets or system clock. Events arrive as calls; commands leave through
/// CoordinatorDelegate. Used by Coordinator; thread-bound.
///
/// Its parts have one duty each and can be tested alone: NodeTable (who can do what), NodeSpeeds (how fast they are),
/// Deadlines (what is late), Accounts (whose turn it is) and Placement (which nodes a session uses).
///
/// Frames of a session: a view waits in one slot, in which a newer view replaces it, until fewer than two frames are
/// unfinished or unwritten. It is then split among the nodes that have the scene, and all blocks are sent at once, so
/// that a node can start its next block as soon as it has sent the previous one. Nodes serve blocks by rank (see
/// Accounts), so museums take turns. If two frames are in flight, the tiles of the older one are relayed to the museum
/// as they arrive, and the tiles of the newer one are held.
///
/// A session with a frame budget is governed: a Governor chooses the quality of each view. After a while without a
/// request, the last view is refined, picture by picture, until the reference quality is reached. A refined picture is
/// sent only once it is complete, so the museum never sees a part of one that the next view cancels.
///
///   moving ──no request──► refining ──reference reached──► at rest: no messages, no blocks
///      ▲                      │                               │
///      └─────── a view ───────┴───────────────────────────────┘
///
/// The deadlines of a frame are counted from the moment when it becomes the oldest frame of its session. They are
/// multiples of a base time: the session's budget, or the recent frame time if that is longer. An idle node takes
/// blocks that others have not begun. A node that has been silent for 60 % of the base time while others are done gets
/// no more blocks of the account; its outstanding tiles are cut and reassigned, so that all nodes help. After twice the
/// base time, a frame with a successor is given up: the last complete picture stands in for it, and the frame's end
/// reports this. The outstanding tiles of a node that disconnects or fails are reassigned at once. The first delivery
/// of a tile counts; later deliveries are dropped.
///
/// Invariants: 1. the museum gets the begin, tiles and end of one frame before those of the next; 2. no tile is sent
/// twice; 3. all tiles of a frame that ends `complete` were sent; 4. each view is answered by a frame or replaced by a
/// newer view; 5. memory per session is bounded by CoordinatorLimits.
class CoordinatorState {
 public:
  /// The first scene is the default. Precondition: there is at least one scene, and the names are unique.
  CoordinatorState(std::vector<FarmScene> scenes, balance::BalanceStrategy strategy, CoordinatorLimits limits,
                   const Clock& clock, CoordinatorDelegate& delegate);

  void node_connected(NodeId node);
  void node_reported(NodeId node, wire::NodeReport report);
  void node_disconnected(NodeId node);
  /// To be called when a node has sent this light's file; FetchFile serves the file from then on.
  void light_stored(const std::string& version);
  /// To be called when the file list of a distributed scene has been read; nodes may then load the scene.
  void scene_read(const std::string& scene, const std::string& digest);

  /// `grant` holds the session's permissions.
  void session_connected(SessionId session, trust::Grant grant = {});
  void session_requested(SessionId session, const wire::SessionRequest& request, TimePoint received_at);
  /// To be called when the museum has closed its side, or the connection broke.
  void session_disconnected(SessionId session);
  /// To be called when the command to render a block has been written to the node's stream.
  void order_written(NodeId node, std::uint64_t block, TimePoint at);
  /// To be called when a message has been written to the museum's stream.
  void written(SessionId session, const wire::SessionReply& reply);

  /// To be called at next_deadline(), and at least every second: handles late nodes and frames, unauthenticated peers
  /// and stalled museums.
  void tick();
  [[nodiscard]] TimePoint next_deadline() const;

  [[nodiscard]] wire::ListScenesReply scenes(const trust::Grant& grant = {}) const;
  [[nodiscard]] std::size_t nodes_with(const std::string& scene) const;
  [[nodiscard]] std::size_t nodes() const { return nodes_.size(); }
  [[nodiscard]] std::size_t sessions() const { return sessions_.size(); }
  /// Returns null if no node has described the scene.
  [[nodiscard]] const wire::SceneDescription* description(const std::string& scene) const;
  [[nodiscard]] const std::vector<FarmScene>& farm_scenes() const { return scenes_; }
  /// Returns one sentence for the operator.
  [[nodiscard]] std::string summary() const;
  /// Returns the name of the session's museum; empty if the session is not open.
  [[nodiscard]] std::string museum_of(SessionId session) const;
  /// Returns the known state of registered nodes, open sessions and scenes; CoordinatorMetrics adds measurements.
  [[nodiscard]] watch::FarmOverview overview() const;

 private:
  // Nodes: coordinator_nodes.cpp
  Status hello(NodeId id, Node& node, const wire::Hello& hello);
  Status scene_loaded(Node& node, const wire::SceneLoaded& loaded);
  Status keep_pareto_front(const wire::SceneLoaded& loaded);
  Status tile_received(NodeId id, Node& node, wire::BlockTile& tile);
  Status block_ended(NodeId id, Node& node, const wire::BlockEnd& end);
  Status block_progressed(Node& node, const wire::BlockProgress& progress);
  /// Charges the block's account for the time that the node has spent on the block so far.
  void charge(BlockLocation* place, double cpu_seconds);
  void tick_nodes();
  void order_scene(NodeId id, Node& node, const FarmScene& scene, const std::set<std::string>& keep);
  /// Orders a scene for a session if no node has it: nodes that dropped it, or failed to load it a while ago, try
  /// again.
  void order_scene_anew(const std::string& scene);
  [[nodiscard]] std::set<std::string> scenes_in_use() const;
  void status_received(Node& node, const wire::NodeStatus& status);
  Status scene_dropped(Node& node, const wire::SceneDropped& dropped);

  // Light computed ahead: coordinator_light.cpp
  Status scene_light(NodeId id, Node& node, const wire::SceneLight& report);
  static Status add_light(const wire::LightVersion& light, Node::LoadedScene* scene);
  /// Takes the next steps for a scene's light: chooses it, has nodes send and fetch it, switches to it, or has it
  /// computed.
  void follow_light(const std::string& scene);
  Status light_pieces(NodeId id, Node& node, const wire::LightPieces& report);
  void choose_light(const std::string& scene, SceneLightState& light);
  void spread_light(const std::string& scene, SceneLightState& light);
  void switch_light(const std::string& scene, SceneLightState& light);
  /// Sets the version for frames that are planned from now on, and the Pareto fronts of governors.
  void use_light(const std::string& scene, SceneLightState& light, const std::string& version);
  /// Has light computed: lets nodes take part, and divides the work among them.
  void order_light(const std::string& scene, SceneLightState& light);
  void order_computation(NodeId id, const std::string& scene, SceneLightState& light);
  void order_pieces(const std::string& scene, SceneLightState& light);
  /// Ends the division of a computation that is over.
  void clear_board(SceneLightState& light);
  [[nodiscard]] std::size_t nodes_with_light(const std::string& scene, const std::string& version) const;
  [[nodiscard]] const std::string& light_in_use(const std::string& scene) const;
  /// Sets the version of the light that a view uses; none if the scene has no light, so that paths are traced.
  void name_light(const std::string& scene, wire::View* view) const;
  [[nodiscard]] std::string light_summary(const std::string& scene) const;

  // Governed sessions: coordinator_refinement.cpp
  /// Chooses the view's quality.
  static void govern(GovernorState& governed, FrameInFlight* frame);
  /// Updates the governor from a frame that the museum has taken.
  void learn(GovernorState& governed, const WrittenFrame& frame);
  /// Ends the refinement because a new view has arrived.
  void leave_rest(Session& session);
  /// Plans the next picture of a session at rest, if there is one.
  void refine(SessionId id, Session& session);
  void finish_refined(SessionId id, Session& session, FrameInFlight& frame, const FrameReport& report);
  [[nodiscard]] static std::string quality_summary(const Session& session);

  // Sessions: coordinator_sessions.cpp
  Status open(SessionId id, Session& session, const wire::OpenSession& open);
  /// Returns null if the session has no budget.
  [[nodiscard]] Result<std::unique_ptr<GovernorState>> governed_by(const wire::OpenSession& open,
                                                                   const std::string& scene, int max_samples) const;
  [[nodiscard]] std::unique_ptr<GovernorState> governed_by(double budget_ms, int reference_samples,
                                                           const std::string& scene) const;
  /// Errors: kBusy if the museum's open scenes and this one need more memory than its grant allows.
  [[nodiscard]] Status check_scene_memory(const Session& session, const std::string& scene) const;
  Status request_view(Session& session, const wire::View& view, TimePoint received_at);
  [[nodiscard]] Error unavailable_reason(const std::string& scene) const;
  void forget_session(SessionId id);
  void tick_sessions();

  // Faults: coordinator_faults.cpp
  /// Checks the deadlines of the session's oldest frame. May end the session.
  void watch(SessionId id);
  void meet_deadlines(SessionId id);
  /// Marks the node as late for the account: it gets no more blocks of the account, and its outstanding tiles are
  /// reassigned.
  void retire(NodeId id, AccountId account);
  void log_late_node(Node& node);
  void lose_blocks(const std::map<std::uint64_t, BlockLocation>& blocks, NodeId not_to);
  void reassign(SessionId id, Session& session, FrameInFlight& frame, std::vector<PixelRect> tiles, NodeId not_to);
  /// To be called when a node is done with the frame: it may take a block that another node has not begun.
  void move_block_to_idle(SessionId id, Session& session, FrameInFlight& frame, NodeId idle);

  // Frames: coordinator_frames.cpp
  void plan(SessionId id, Session& session);
  [[nodiscard]] std::vector<AssignedBlock> split(SessionId id, Session& session, const wire::View& view,
                                                 bool whole_blocks);
  /// Records in the placement how much time of the nodes the frame will take.
  void place(SessionId id, const Session& session, const std::vector<AssignedBlock>& blocks);
  void order_block(SessionId id, const Session& session, const FrameInFlight& frame, std::uint64_t block, NodeId node,
                   const PixelRect& rect);
  /// Adds what the other accounts with blocks at the node have received elsewhere, if that is much.
  void state_service(Node& node, AccountId except, wire::RenderBlock* order) const;
  void fail(FrameInFlight& frame, const std::string& reason, Session& session);
  /// Determines the frame's position in the order of all museums' frames.
  void take_turn(Session& session, FrameInFlight* frame);
  /// Returns the sum of the threads of all nodes that have a block.
  [[nodiscard]] double threads_of(const std::vector<AssignedBlock>& blocks) const;
  void cancel_blocks(const FrameInFlight& frame);
  /// Sends the tiles and messages that may be sent, ends frames that are over, and plans waiting views. Called after
  /// every event of a session; may end the session.
  void advance(SessionId id);
  void relay(SessionId id, Session& session, wire::Tile tile);
  void begin(SessionId id, Session& session, FrameInFlight& frame);
  void finish(SessionId id, Session& session, FrameInFlight& frame);
  [[nodiscard]] FrameReport report_of(SessionId id, const FrameInFlight& frame) const;
  void end(SessionId id, Session& session, const FrameInFlight& frame, const FrameReport& report);
  void send(SessionId id, Session& session, wire::SessionReply reply);
  FrameInFlight* find_frame(const BlockLocation& place);

  std::vector<FarmScene> scenes_;
  const balance::BalanceStrategy strategy_;
  const CoordinatorLimits limits_;
  const Clock& clock_;
  CoordinatorDelegate& delegate_;
  NodeTable nodes_;
  NodeSpeeds speeds_;
  const Deadlines deadlines_{nodes_, speeds_, clock_};
  std::map<SessionId, Session> sessions_;
  std::map<std::string, wire::SceneDescription> descriptions_;  ///< Scenes that any node has loaded so far.
  std::map<std::string, governor::ParetoFront> pareto_fronts_;  ///< Pareto fronts of the measured scenes, by scene.
  std::map<std::string, SceneLightState> lights_;               ///< State of each scene's light.
  std::map<std::string, int> bounces_;                          ///< Bounces that nodes stated, by scene.
  Accounts accounts_;
  Placement placement_;
  std::uint64_t last_block_ = 0;
  std::uint64_t last_frame_ = 0;
  std::string last_refusal_;
};

}  // namespace cyclorama::coordinator
