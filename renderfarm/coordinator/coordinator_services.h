// SPDX-License-Identifier: Apache-2.0
/// The coordinator's gRPC services. They run on gRPC's threads and only post events to the loop or serve files.
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
#include "common/wire/certificates.grpc.pb.h"
#include "common/wire/channel.h"
#include "common/wire/farm.grpc.pb.h"
#include "common/wire/identity.h"
#include "common/wire/nodes.grpc.pb.h"
#include "common/wire/updates.grpc.pb.h"
#include "renderfarm/coordinator/event_queue.h"
#include "renderfarm/coordinator/file_server.h"
#include "renderfarm/coordinator/light_file_store.h"
#include "renderfarm/coordinator/peer_stream.h"
#include "renderfarm/coordinator/update_store.h"
#include "renderfarm/trust/renewals.h"

namespace cyclorama::coordinator {

using NodeStream = PeerStream<wire::NodeReport, wire::NodeCommand>;
using MuseumStream = PeerStream<wire::SessionRequest, wire::SessionReply>;

// Events that gRPC's threads post to the loop:
struct NodeConnected {
  std::uint64_t id;
  std::shared_ptr<NodeStream> stream;
  Identity who;
};
struct NodeMessage {
  std::uint64_t id;
  wire::NodeReport report;
  TimePoint at;
};
/// Posted when the command to render a block has been written to the node's stream.
struct OrderWritten {
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
struct MuseumConnected {
  std::uint64_t id;
  std::shared_ptr<MuseumStream> stream;
  Identity who;
};
struct MuseumMessage {
  std::uint64_t id;
  wire::SessionRequest request;
  TimePoint at;
};
struct ReplyWritten {
  std::uint64_t id;
  wire::SessionReply reply;
  TimePoint at;
};
struct MuseumClosed {
  std::uint64_t id;
};
struct MuseumDone {
  std::uint64_t id;
};
struct ListScenesCall {
  wire::ListScenesReply* reply;
  grpc::ServerUnaryReactor* reactor;
  Identity who;
};
struct SceneRead {
  scene_distribution::SceneLibrary::News news;
};
/// Posted when a node has sent the light of this version.
struct LightStored {
  std::string version;
};
struct StopRequested {};
using Event =
    std::variant<NodeConnected, NodeMessage, OrderWritten, NodeClosed, NodeDone, MuseumConnected, MuseumMessage,
                 ReplyWritten, MuseumClosed, MuseumDone, ListScenesCall, SceneRead, LightStored, StopRequested>;
using Events = EventQueue<Event>;

/// Receives one file of light from a node. gRPC calls one method at a time. `stored` is called before the node gets its
/// reply.
class LightReceiver final : public grpc::ServerReadReactor<wire::LightChunk> {
 public:
  LightReceiver(LightFileStore& store, std::function<void(const std::string& version)> stored)
      : store_(store), stored_(std::move(stored)) {
    StartRead(&chunk_);
  }

 private:
  void OnReadDone(bool ok) override {
    Status fine = ok                    ? take()
                  : receipt_ == nullptr ? Error(ErrorCode::kInvalidArgument, "no light was sent")
                                        : receipt_->finish();
    if (ok && fine) return StartRead(&chunk_);
    if (fine) stored_(version_);
    Finish(fine ? grpc::Status::OK : to_grpc(fine.error()));
  }
  Status take() {
    if (receipt_ == nullptr) {
      version_ = chunk_.version();
      TRY_ASSIGN(receipt_, store_.receive(version_));
    }
    return receipt_->add(std::as_bytes(std::span(chunk_.data())));
  }
  void OnDone() override { delete this; }

  LightFileStore& store_;
  const std::function<void(const std::string&)> stored_;
  wire::LightChunk chunk_;
  std::string version_;
  std::unique_ptr<LightFileStore::Receipt> receipt_;
};

class NodesService final : public wire::Nodes::CallbackService,
                           private PeerStreamEvents<wire::NodeReport, wire::NodeCommand> {
 public:
  NodesService(Events& events, FileServer& files, LightFileStore& lights)
      : events_(events), files_(files), lights_(lights) {}

 private:
  grpc::ServerBidiReactor<wire::NodeReport, wire::NodeCommand>* Work(grpc::CallbackServerContext* context) override {
    const std::uint64_t id = ++last_id_;
    auto stream = NodeStream::open(id, context, *this);
    NodeStream* const reactor = stream.get();
    events_.post(NodeConnected{id, std::move(stream), identity_of(*context)});
    reactor->read_next();
    return reactor;
  }
  grpc::ServerUnaryReactor* ListFiles(grpc::CallbackServerContext* context, const wire::ListFilesRequest* request,
                                      wire::SceneFiles* reply) override {
    return files_.list(context, *request, reply);
  }
  grpc::ServerWriteReactor<wire::FileChunk>* FetchFile(grpc::CallbackServerContext* context,
                                                       const wire::FetchFileRequest* request) override {
    if (auto light = lights_.open(request->sha256())) return files_.send(context, std::move(light), request->offset());
    return files_.fetch(context, *request);
  }
  grpc::ServerReadReactor<wire::LightChunk>* StoreLight(grpc::CallbackServerContext*, wire::StoreLightReply*) override {
    // The receiver deletes itself in OnDone().
    return new LightReceiver(lights_, [this](const std::string& version) { events_.post(LightStored{version}); });
  }
  void on_read(std::uint64_t id, wire::NodeReport message) override {
    events_.post(NodeMessage{id, std::move(message), SteadyClock().now()});
  }
  void on_written(std::uint64_t id, wire::NodeCommand message) override {
    if (message.has_render()) events_.post(OrderWritten{id, message.render().block(), SteadyClock().now()});
  }
  void on_closed(std::uint64_t id) override { events_.post(NodeClosed{id}); }
  void on_done(std::uint64_t id) override { events_.post(NodeDone{id}); }

  Events& events_;
  FileServer& files_;
  LightFileStore& lights_;
  std::atomic<std::uint64_t> last_id_ = 0;
};

class FarmService final : public wire::Farm::CallbackService,
                          private PeerStreamEvents<wire::SessionRequest, wire::SessionReply> {
 public:
  explicit FarmService(Events& events) : events_(events) {}

 private:
  grpc::ServerBidiReactor<wire::SessionRequest, wire::SessionReply>* Session(
      grpc::CallbackServerContext* context) override {
    const std::uint64_t id = ++last_id_;
    auto stream = MuseumStream::open(id, context, *this);
    MuseumStream* const reactor = stream.get();
    events_.post(MuseumConnected{id, std::move(stream), identity_of(*context)});
    reactor->read_next();
    return reactor;
  }
  grpc::ServerUnaryReactor* ListScenes(grpc::CallbackServerContext* context, const wire::ListScenesRequest*,
                                       wire::ListScenesReply* reply) override {
    grpc::ServerUnaryReactor* const reactor = context->DefaultReactor();
    if (!events_.post(ListScenesCall{reply, reactor, identity_of(*context)})) {
      reactor->Finish({grpc::StatusCode::UNAVAILABLE, "the farm's coordinator stops"});
    }
    return reactor;
  }
  void on_read(std::uint64_t id, wire::SessionRequest message) override {
    events_.post(MuseumMessage{id, std::move(message), SteadyClock().now()});
  }
  void on_written(std::uint64_t id, wire::SessionReply message) override {
    events_.post(ReplyWritten{id, std::move(message), SteadyClock().now()});
  }
  void on_closed(std::uint64_t id) override { events_.post(MuseumClosed{id}); }
  void on_done(std::uint64_t id) override { events_.post(MuseumDone{id}); }

  Events& events_;
  std::atomic<std::uint64_t> last_id_ = 0;
};

/// Serves system updates to museums. `may` returns true if a caller is authorized; it is called on gRPC's threads.
class UpdatesService final : public wire::Updates::CallbackService {
 public:
  UpdatesService(UpdateStore store, FileServer& files, std::function<bool(const Identity&)> may)
      : store_(std::move(store)), files_(files), may_(std::move(may)) {}

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
    auto offer = admitted ? store_.offer(request->image()) : Result<wire::UpdateOffer>(admitted.error());
    if (offer) *reply = *std::move(offer);
    reactor->Finish(offer ? grpc::Status::OK : to_grpc(offer.error()));
    return reactor;
  }
  grpc::ServerWriteReactor<wire::FileChunk>* Fetch(grpc::CallbackServerContext* context,
                                                   const wire::FetchUpdateRequest* request) override {
    const Status admitted = admit(*context);
    return files_.send(context,
                       admitted ? store_.open(request->image(), request->sha256())
                                : Result<scene_distribution::StampedFile>(admitted.error()),
                       request->offset());
  }

  const UpdateStore store_;
  FileServer& files_;
  const std::function<bool(const Identity&)> may_;
};

/// Renews museums' certificates. A request is a file of a kilobyte, so it is answered on gRPC's thread.
class CertificatesService final : public wire::Certificates::CallbackService {
 public:
  explicit CertificatesService(trust::Renewals renewals) : renewals_(std::move(renewals)) {}

 private:
  grpc::ServerUnaryReactor* Renew(grpc::CallbackServerContext* context, const wire::RenewRequest* request,
                                  wire::RenewReply* reply) override {
    grpc::ServerUnaryReactor* const reactor = context->DefaultReactor();
    auto certificate = renewals_.renew(identity_of(*context), request->request_pem());
    if (certificate) reply->set_certificate_pem(*std::move(certificate));
    reactor->Finish(certificate ? grpc::Status::OK : to_grpc(certificate.error()));
    return reactor;
  }

  const trust::Renewals renewals_;
};

}  // namespace cyclorama::coordinator
