// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/coordinator/coordinator.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <variant>

#include "common/base/text.h"
#include "common/wire/channel.h"
#include "common/wire/inspection_service.h"
#include "renderfarm/coordinator/coordinator_metrics.h"
#include "renderfarm/coordinator/coordinator_services.h"
#include "renderfarm/coordinator/cost_log.h"
#include "renderfarm/coordinator/relay_times.h"
#include "renderfarm/watch/farm_watch.h"

namespace cyclorama::coordinator {
namespace {

constexpr Duration kTick = std::chrono::milliseconds(100);
/// Maximum time that a stream may take to drain when it ends.
constexpr Duration kLinger = std::chrono::seconds(5);
constexpr Duration kStopGrace = std::chrono::seconds(2);
constexpr std::size_t kMaxSceneNameBytes = 64;
/// Limit for messages of museums. Museums send only views of a few hundred bytes each; nodes send tiles.
constexpr int kMuseumMessageBytes = 64 << 10;
/// Maximum number of calls per connection. A museum has a session and lists scenes; a node has its stream and fetches
/// files.
constexpr int kMuseumCalls = 16;
constexpr int kNodeCalls = 32;

/// A stream and, once it is ending, the deadline for its end.
template <typename Stream>
struct Open {
  std::shared_ptr<Stream> stream;
  std::optional<TimePoint> ends_by{};
};

std::vector<scene_distribution::SceneLibrary::Source> handed_out(const std::vector<FarmScene>& scenes) {
  std::vector<scene_distribution::SceneLibrary::Source> sources;
  for (const FarmScene& scene : scenes) {
    if (scene.on_coordinator) sources.push_back({scene.name, scene.path});
  }
  return sources;
}

template <typename Stream>
void end_stream(Open<Stream>& open, const grpc::Status& status, bool at_once) {
  open.stream->finish(status, at_once);
  if (!open.ends_by) open.ends_by = SteadyClock().now() + kLinger;
}

template <typename Stream>
void end_all(std::map<std::uint64_t, Open<Stream>>& streams, const grpc::Status& status) {
  for (auto& [id, open] : streams) end_stream(open, status, false);
}

template <typename Stream>
void cut_late_ones(std::map<std::uint64_t, Open<Stream>>& streams, TimePoint now) {
  for (auto& [id, open] : streams) {
    if (open.ends_by && now >= *open.ends_by) open.stream->finish(grpc::Status::OK, true);
  }
}

}  // namespace

/// The loop's thread and everything bound to it.
class Coordinator::Loop final : private CoordinatorDelegate {
 public:
  Loop(CoordinatorOptions options, Notice notice)
      : options_(std::move(options)),
        notice_(std::move(notice)),
        state_(options_.scenes, options_.strategy, options_.limits, clock_, *this),
        alive_at_(clock_.now().time_since_epoch().count()) {}
  ~Loop() override { stop(); }

  Status start() {
    if (!options_.record.empty()) {
      TRY_ASSIGN(cost_log_, CostLog::open(options_.record, say_));
    }
    TRY_ASSIGN(gate_, trust::Gatekeeper::open(options_.trust, clock_, say_));
    TRY(watch_.start(options_.watch, say_));
    thread_ = std::thread(
        [this] { run(); });  // Started before the servers, because every call that they accept must be finished.
    TRY_ASSIGN(node_server_, WireServer::start(options_.nodes, {&nodes_service_}, port_for(Role::kNode)));
    TRY_ASSIGN(museum_server_,
               WireServer::start(options_.museums, {&farm_service_, &updates_service_, &certificates_service_},
                                 port_for(Role::kMuseum)));
    if (!options_.inspect.empty()) {
      TRY_ASSIGN(inspect_server_, WireServer::start(options_.inspect, {&inspection_}));
    }
    return Done{};
  }

  void stop() {
    events_.post(StopRequested{});
    files_.stop();
    const TimePoint last = clock_.now() + kStopGrace;  // One deadline for all servers, any of which may hang.
    for (const auto& server : {museum_server_.get(), node_server_.get(), inspect_server_.get()}) {
      if (server != nullptr) server->stop(std::max(Duration::zero(), last - clock_.now()));
    }
    watch_.stop();
    events_.close();
    if (thread_.joinable()) thread_.join();
  }

  [[nodiscard]] static int port_of(const std::unique_ptr<WireServer>& server) { return server ? server->port() : 0; }
  [[nodiscard]] int museum_port() const { return port_of(museum_server_); }
  [[nodiscard]] int node_port() const { return port_of(node_server_); }
  [[nodiscard]] int inspect_port() const { return port_of(inspect_server_); }
  [[nodiscard]] int watch_port() const { return watch_.port(); }
  [[nodiscard]] std::uint64_t sent_file_bytes() const { return files_.sent_bytes(); }
  [[nodiscard]] TimePoint alive_at() const { return TimePoint(Duration(alive_at_.load())); }
  [[nodiscard]] std::string state() const { return inspection_.status().state(); }

 private:
  void run() {
    TimePoint next_tick = clock_.now();
    for (bool open = true; open;) {
      open = !events_.is_closed();  // Read first, so that events posted before the queue is closed are still handled.
      TimePoint wake = stopping_ ? next_tick : std::min(next_tick, state_.next_deadline());
      if (!held_.empty()) wake = std::min(wake, held_.begin()->first);
      for (Event& event : events_.take_all(wake)) {
        cause_at_ = clock_.now();
        std::visit([this](auto& e) { handle(e); }, event);
      }
      const TimePoint now = clock_.now();
      cause_at_ = now;
      release(now);
      if (now < next_tick) {
        if (now >= wake) state_.tick();
        continue;
      }
      next_tick = now + kTick;
      alive_at_ = now.time_since_epoch().count();
      if (!stopping_) {
        state_.tick();
        check_files();
      }
      cut_late_ones(nodes_, now);
      cut_late_ones(museums_, now);
      meters_.update(state_, now);
      watch_.metrics().scene_bytes_sent(files_.sent_bytes());
    }
  }

  [[nodiscard]] ServerOptions port_for(Role role) const {
    const bool museums = role == Role::kMuseum;
    return {.tls = options_.trust.tls,
            .admit = [gate = gate_.get(), role](const Identity& who) { return gate->refusal(who, role); },
            .message_limit_bytes = museums ? kMuseumMessageBytes : kMessageLimitBytes,
            .calls_per_connection = museums ? kMuseumCalls : kNodeCalls};
  }

  void session_message(const MuseumMessage& e) {
    const Status bearable = e.request.has_view() ? gate_->view_received(e.id, e.request.view()) : Done{};
    if (bearable) return state_.session_requested(SessionId{e.id}, e.request, e.at);
    state_.session_disconnected(SessionId{e.id});
    end_session(SessionId{e.id}, bearable.error(), true);
  }

  /// Passes on the held notifications of museums with a byte limit once the limit permits the next frame.
  void release(TimePoint now) {
    while (!held_.empty() && held_.begin()->first <= now) {
      ReplyWritten reply_written = std::move(held_.begin()->second);
      held_.erase(held_.begin());
      if (!stopping_) state_.written(SessionId{reply_written.id}, reply_written.reply);
      watch::SessionPictures* const pictures = watch_.pictures();
      if (pictures != nullptr && museums_.contains(reply_written.id))
        pictures->taken(reply_written.id, std::move(reply_written.reply));
    }
  }
  void check_files() {
    const trust::Gatekeeper::Leavers leavers = gate_->tick();
    for (const auto& [id, reason] : leavers.sessions) {
      gate_->session_ended(id, reason);
      state_.session_disconnected(SessionId{id});
      send_away(museums_.at(id), reason);
    }
    if (leavers.changed) files_.cut([this](const Identity& who) { return gate_->is_revoked(who); });
    for (const auto& [id, reason] : leavers.nodes) {
      gate_->node_disconnected(id, reason);
      state_.node_disconnected(NodeId{id});
      send_away(nodes_.at(id), reason);
    }
  }
  template <typename Stream>
  static void send_away(Open<Stream>& open, const std::string& reason) {
    end_stream(open, {grpc::StatusCode::PERMISSION_DENIED, reason}, true);
  }

  void handle(NodeConnected& e) {
    nodes_.emplace(e.id, Open<NodeStream>{std::move(e.stream)});
    if (stopping_) return end_stream(nodes_.at(e.id), kStops, false);
    gate_->node_connected(e.id, e.who);
    node_names_[e.id] = e.who.name;
    state_.node_connected(NodeId{e.id});
  }
  void handle(OrderWritten& e) { state_.order_written(NodeId{e.id}, e.block, e.at); }
  void handle(NodeMessage& e) {
    cause_at_ = e.at;
    if (const std::string& name = node_names_[e.id]; e.report.has_hello() && !name.empty()) {
      // The certificate identifies the node; the reported name distinguishes hosts that share a certificate.
      std::string* const said = e.report.mutable_hello()->mutable_name();
      *said = said->empty() || *said == name ? name : name + "/" + *said;
    }
    if (!stopping_) state_.node_reported(NodeId{e.id}, std::move(e.report));
    nodes_.at(e.id).stream->read_next();
  }
  void handle(NodeClosed& e) {
    if (!stopping_) state_.node_disconnected(NodeId{e.id});
    gate_->node_disconnected(e.id, "");
    end_stream(nodes_.at(e.id), grpc::Status::OK, false);
  }
  void handle(NodeDone& e) {
    nodes_.erase(e.id);
    node_names_.erase(e.id);
  }

  void handle(MuseumConnected& e) {
    museums_.emplace(e.id, Open<MuseumStream>{std::move(e.stream)});
    if (stopping_) return end_stream(museums_.at(e.id), kStops, false);
    auto grant = gate_->session_connected(e.id, e.who);
    if (!grant) {
      watch_.metrics().session_refused(grant.error().code());
      return end_stream(museums_.at(e.id), to_grpc(grant.error()), false);
    }
    state_.session_connected(SessionId{e.id}, *std::move(grant));
  }
  void handle(MuseumMessage& e) {
    cause_at_ = e.at;
    if (!stopping_) session_message(e);
    museums_.at(e.id).stream->read_next();
  }
  void handle(ReplyWritten& e) {
    cause_at_ = e.at;
    const RelayTimes::Times times = relay_times_.taken(SessionId{e.id}, e.reply, e.at);
    if (times.relay_seconds) meters_.add_stage("relay", *times.relay_seconds);
    if (times.overhead_seconds) meters_.add_stage("overhead", *times.overhead_seconds);
    if (e.reply.has_opened()) watch_.metrics().session_opened(state_.museum_of(SessionId{e.id}));
    const TimePoint due = gate_->reply_written(e.id, e.reply);
    held_.emplace(due, std::move(e));
    release(clock_.now());
  }
  void handle(MuseumClosed& e) {
    if (!stopping_) state_.session_disconnected(SessionId{e.id});
    gate_->session_ended(e.id, "");
    end_stream(museums_.at(e.id), grpc::Status::OK, false);
  }
  void handle(MuseumDone& e) {
    museums_.erase(e.id);
    relay_times_.session_ended(SessionId{e.id});
    if (watch::SessionPictures* const pictures = watch_.pictures()) pictures->session_ended(e.id);
  }

  void handle(ListScenesCall& e) {
    *e.reply = state_.scenes(gate_->grant_of(e.who));
    e.reactor->Finish(grpc::Status::OK);
  }
  void handle(SceneRead& e) {
    say_(e.news.sentence);
    if (!stopping_ && !e.news.digest.empty()) state_.scene_read(e.news.scene, e.news.digest);
  }
  void handle(LightStored& e) {
    if (!stopping_) state_.light_stored(e.version);
  }
  void handle(StopRequested&) {
    stopping_ = true;
    for (const auto& [id, open] : museums_) gate_->session_ended(id, kStops.error_message());
    for (const auto& [id, open] : nodes_) gate_->node_disconnected(id, kStops.error_message());
    end_all(museums_, kStops);
    end_all(nodes_, kStops);
  }

  void to_node(NodeId node, const wire::NodeCommand& command) override {
    nodes_.at(static_cast<std::uint64_t>(node)).stream->send(command);
  }
  void to_museum(SessionId session, wire::SessionReply reply) override {
    const auto id = static_cast<std::uint64_t>(session);
    if (reply.has_opened()) gate_->session_opened(id, reply.opened());
    relay_times_.sent(session, cause_at_);
    museums_.at(id).stream->send(std::move(reply));
  }
  void accept_light(const wire::LightVersion& light) override { lights_.accept(light); }
  void forget_light(const wire::LightVersion& light) override { lights_.forget(light.version()); }
  void end_node(NodeId node, const Error& reason) override {
    gate_->node_disconnected(static_cast<std::uint64_t>(node), reason.message());
    watch_.metrics().node_sent_away();
    end_stream(nodes_.at(static_cast<std::uint64_t>(node)), to_grpc(reason), false);
  }
  void end_session(SessionId session, const Error& reason, bool at_once) override {
    gate_->session_ended(static_cast<std::uint64_t>(session), reason.message());
    watch_.metrics().session_refused(reason.code());
    end_stream(museums_.at(static_cast<std::uint64_t>(session)), to_grpc(reason), at_once);
  }
  void frame_ended(const FrameReport& report) override {
    relay_times_.frame_ended(report);
    meters_.add(report);
    if (cost_log_) cost_log_->add(report);
  }
  void notice(const std::string& sentence, const NoticeAbout& about) override { notice_(sentence, about); }

  inline static const grpc::Status kStops{grpc::StatusCode::UNAVAILABLE, "the farm's coordinator stops"};

  const CoordinatorOptions options_;
  const Notice notice_;
  /// Logs a sentence that concerns no particular peer.
  const std::function<void(const std::string&)> say_ = [this](const std::string& sentence) { notice_(sentence, {}); };
  const SteadyClock clock_;
  Events events_;
  InspectionService inspection_{"coordinator"};
  watch::FarmWatch watch_{inspection_};
  CoordinatorMetrics meters_{inspection_, watch_.metrics()};
  RelayTimes relay_times_;
  TimePoint cause_at_{};  ///< Arrival time of the event being handled.
  std::unique_ptr<CostLog> cost_log_;
  CoordinatorState state_;
  std::unique_ptr<trust::Gatekeeper> gate_;
  std::multimap<TimePoint, ReplyWritten> held_;
  std::map<std::uint64_t, std::string> node_names_;  ///< Names from the nodes' certificates.
  bool stopping_ = false;
  std::map<std::uint64_t, Open<NodeStream>> nodes_;
  std::map<std::uint64_t, Open<MuseumStream>> museums_;
  std::atomic<Duration::rep> alive_at_;
  scene_distribution::SceneLibrary library_{
      handed_out(options_.scenes), options_.distribution.digests,
      [this](scene_distribution::SceneLibrary::News news) { events_.post(SceneRead{std::move(news)}); }};
  FileServer files_{library_, options_.distribution.files};
  LightFileStore lights_;
  NodesService nodes_service_{events_, files_, lights_};
  FarmService farm_service_{events_};
  UpdatesService updates_service_{UpdateStore(options_.updates), files_,
                                  [this](const Identity& who) { return gate_->may_update(who); }};
  CertificatesService certificates_service_{trust::Renewals(options_.renewals)};
  std::unique_ptr<WireServer> node_server_;
  std::unique_ptr<WireServer> museum_server_;
  std::unique_ptr<WireServer> inspect_server_;
  std::thread thread_;
};

Status validate(const CoordinatorOptions& options) {
  const auto refuse = [](const std::string& what) { return Error(ErrorCode::kInvalidArgument, what); };
  if (options.scenes.empty())
    return refuse("no scene is given; write --scene NAME=PATH, or a [[scene]] with name and path in farm.toml");
  for (const FarmScene& scene : options.scenes) {
    const bool plain = std::ranges::all_of(scene.name, [](char c) {
      return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' || c == '_' ||
             c == '.';
    });
    if (scene.name.empty() || scene.name.size() > kMaxSceneNameBytes || !plain) {
      return refuse(fmt::format("scene name '{}' must be 1 to {} letters, digits, '-', '_' or '.'",
                                printable(scene.name), kMaxSceneNameBytes));
    }
    if (scene.path.empty()) return refuse(fmt::format("scene '{}' has no path", scene.name));
    if (printable(scene.path, scene.path.size()) != scene.path) {
      return refuse(fmt::format("the path of scene '{}', '{}', is not UTF-8, or has control characters: rename it",
                                scene.name, printable(scene.path)));
    }
    if (std::ranges::count(options.scenes, scene.name, &FarmScene::name) > 1) {
      return refuse(fmt::format("scene '{}' is given twice", scene.name));
    }
  }
  for (const std::string& address : {options.museums, options.nodes}) {
    if (options.trust.tls || options.trust.insecure || is_loopback(address)) continue;
    return refuse(
        fmt::format("'{}' can be reached by others, and there is no TLS; make certificates with "
                    "cyclorama-authority and write [tls], or set insecure = true",
                    printable(address)));
  }
  if (!options.inspect.empty() && !options.trust.insecure && !is_loopback(options.inspect)) {
    return refuse(fmt::format("the inspection address '{}' can be reached by others; write [::1] and a port",
                              printable(options.inspect)));
  }
  return validate(options.watch);
}

Result<std::unique_ptr<Coordinator>> Coordinator::start(CoordinatorOptions options, Notice notice) {
  TRY(validate(options));
  auto loop = std::make_unique<Loop>(std::move(options), std::move(notice));
  TRY(loop->start());
  return std::unique_ptr<Coordinator>(new Coordinator(std::move(loop)));
}

Coordinator::Coordinator(std::unique_ptr<Loop> loop) : loop_(std::move(loop)) {}
Coordinator::~Coordinator() = default;
int Coordinator::museum_port() const { return loop_->museum_port(); }
int Coordinator::node_port() const { return loop_->node_port(); }
int Coordinator::inspect_port() const { return loop_->inspect_port(); }
int Coordinator::watch_port() const { return loop_->watch_port(); }
std::uint64_t Coordinator::sent_file_bytes() const { return loop_->sent_file_bytes(); }
TimePoint Coordinator::alive_at() const { return loop_->alive_at(); }
std::string Coordinator::state() const { return loop_->state(); }
void Coordinator::stop() { loop_->stop(); }

}  // namespace cyclorama::coordinator
