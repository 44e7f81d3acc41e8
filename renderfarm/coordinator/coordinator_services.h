// SPDX-License-Identifier: Apache-2.0
/// The head's gRPC services. They live on gRPC's threads and only post events to the loop, or hand out files.
#pragma once

#include <fmt/format.h>

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <variant>

#include "common/base/text.h"
#include "common/wire/channel.h"
#include "common/wire/farm.grpc.pb.h"
#include "common/wire/identity.h"
#include "common/wire/nodes.grpc.pb.h"
#include "common/wire/updates.grpc.pb.h"
#include "renderfarm/coordinator/event_queue.h"
#include "renderfarm/coordinator/file_server.h"
#include "renderfarm/coordinator/peer_stream.h"
#include "renderfarm/coordinator/update_shelf.h"

namespace cyclorama {

using NodeStream = PeerStream<wire::NodeReport, wire::NodeCommand>;
using MuseumStream = PeerStream<wire::VisitRequest, wire::VisitReply>;

// What gRPC's threads tell the loop.
struct NodeCame {
  std::uint64_t id;
  std::shared_ptr<NodeStream> stream;
  Identity who;
};
struct NodeSaid {
  std::uint64_t id;
  wire::NodeReport report;
  TimePoint at;
};
/// An order for a block is on the wire.
struct NodeTook {
  std::uint64_t id;
  std::uint64_t block;
  TimePoint at;
};
struct NodeClosed {
  std::uint64_t id;
};
struct NodeDone {
  std::uint64_t id;
};
struct MuseumCame {
  std::uint64_t id;
  std::shared_ptr<MuseumStream> stream;
  Identity who;
};
struct MuseumSaid {
  std::uint64_t id;
  wire::VisitRequest request;
  TimePoint at;
};
struct MuseumTook {
  std::uint64_t id;
  wire::VisitReply reply;
  TimePoint at;
};
struct MuseumClosed {
  std::uint64_t id;
};
struct MuseumDone {
  std::uint64_t id;
};
struct ScenesAsked {
  wire::ListScenesReply* reply;
  grpc::ServerUnaryReactor* reactor;
  Identity who;
};
struct SceneRead {
  SceneLibrary::News news;
};
struct StopAsked {};
using Event = std::variant<NodeCame, NodeSaid, NodeTook, NodeClosed, NodeDone, MuseumCame, MuseumSaid, MuseumTook,
                           MuseumClosed, MuseumDone, ScenesAsked, SceneRead, StopAsked>;
using Events = EventQueue<Event>;

class NodesService final : public wire::Nodes::CallbackService,
                           private PeerStreamEvents<wire::NodeReport, wire::NodeCommand> {
 public:
  NodesService(Events& events, FileServer& files) : events_(events), files_(files) {}

 private:
  grpc::ServerBidiReactor<wire::NodeReport, wire::NodeCommand>* Work(grpc::CallbackServerContext* context) override {
    const std::uint64_t id = ++last_id_;
    auto stream = NodeStream::open(id, context, *this);
    NodeStream* const reactor = stream.get();
    events_.post(NodeCame{id, std::move(stream), identity_of(*context)});
    reactor->read_next();
    return reactor;
  }
  grpc::ServerUnaryReactor* ListFiles(grpc::CallbackServerContext* context, const wire::ListFilesRequest* request,
                                      wire::SceneFiles* reply) override {
    return files_.list(context, *request, reply);
  }
  grpc::ServerWriteReactor<wire::FileChunk>* FetchFile(grpc::CallbackServerContext* context,
                                                       const wire::FetchFileRequest* request) override {
    return files_.fetch(context, *request);
  }
  void on_read(std::uint64_t id, wire::NodeReport message) override {
    events_.post(NodeSaid{id, std::move(message), SteadyClock().now()});
  }
  void on_written(std::uint64_t id, wire::NodeCommand message) override {
    if (message.has_render()) events_.post(NodeTook{id, message.render().block(), SteadyClock().now()});
  }
  void on_closed(std::uint64_t id) override { events_.post(NodeClosed{id}); }
  void on_done(std::uint64_t id) override { events_.post(NodeDone{id}); }

  Events& events_;
  FileServer& files_;
  std::atomic<std::uint64_t> last_id_ = 0;
};

class FarmService final : public wire::Farm::CallbackService,
                          private PeerStreamEvents<wire::VisitRequest, wire::VisitReply> {
 public:
  explicit FarmService(Events& events) : events_(events) {}

 private:
  grpc::ServerBidiReactor<wire::VisitRequest, wire::VisitReply>* Visit(grpc::CallbackServerContext* context) override {
    const std::uint64_t id = ++last_id_;
    auto stream = MuseumStream::open(id, context, *this);
    MuseumStream* const reactor = stream.get();
    events_.post(MuseumCame{id, std::move(stream), identity_of(*context)});
    reactor->read_next();
    return reactor;
  }
  grpc::ServerUnaryReactor* ListScenes(grpc::CallbackServerContext* context, const wire::ListScenesRequest*,
                                       wire::ListScenesReply* reply) override {
    grpc::ServerUnaryReactor* const reactor = context->DefaultReactor();
    if (!events_.post(ScenesAsked{reply, reactor, identity_of(*context)})) {
      reactor->Finish({grpc::StatusCode::UNAVAILABLE, "the farm's head stops"});
    }
    return reactor;
  }
  void on_read(std::uint64_t id, wire::VisitRequest message) override {
    events_.post(MuseumSaid{id, std::move(message), SteadyClock().now()});
  }
  void on_written(std::uint64_t id, wire::VisitReply message) override {
    events_.post(MuseumTook{id, std::move(message), SteadyClock().now()});
  }
  void on_closed(std::uint64_t id) override { events_.post(MuseumClosed{id}); }
  void on_done(std::uint64_t id) override { events_.post(MuseumDone{id}); }

  Events& events_;
  std::atomic<std::uint64_t> last_id_ = 0;
};

/// What museums keep themselves up to date with. `may` is asked on gRPC's threads.
class UpdatesService final : public wire::Updates::CallbackService {
 public:
  UpdatesService(UpdateShelf shelf, FileServer& files, std::function<bool(const Identity&)> may)
      : shelf_(std::move(shelf)), files_(files), may_(std::move(may)) {}

 private:
  [[nodiscard]] Status admit(const grpc::CallbackServerContext& context) const {
    const Identity who = identity_of(context);
    if (may_(who)) return Done{};
    return Error(ErrorCode::kInvalidArgument,
                 fmt::format("the farm gives '{}' no updates; its operator may change that in museums.toml",
                             printable(who.name)));
  }
  grpc::ServerUnaryReactor* Offer(grpc::CallbackServerContext* context, const wire::OfferUpdateRequest* request,
                                  wire::UpdateOffer* reply) override {
    grpc::ServerUnaryReactor* const reactor = context->DefaultReactor();
    const Status admitted = admit(*context);
    auto offer = admitted ? shelf_.offer(request->image()) : Result<wire::UpdateOffer>(admitted.error());
    if (offer) *reply = *std::move(offer);
    reactor->Finish(offer ? grpc::Status::OK : to_grpc(offer.error()));
    return reactor;
  }
  grpc::ServerWriteReactor<wire::FileChunk>* Fetch(grpc::CallbackServerContext* context,
                                                   const wire::FetchUpdateRequest* request) override {
    const Status admitted = admit(*context);
    return files_.send(
        context, admitted ? shelf_.open(request->image(), request->sha256()) : Result<StampedFile>(admitted.error()),
        request->offset());
  }

  const UpdateShelf shelf_;
  FileServer& files_;
  const std::function<bool(const Identity&)> may_;
};

}  // namespace cyclorama
