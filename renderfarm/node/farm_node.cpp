// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/node/farm_node.h"

#include <grpcpp/channel.h>

#include <algorithm>
#include <utility>

#include "common/base/give_way.h"
#include "common/wire/channel.h"
#include "renderfarm/node/coordinator_connection.h"

namespace cyclorama::node {

Result<std::unique_ptr<FarmNode>> FarmNode::start(const FarmNodeOptions& options, SceneLoader loader,
                                                  LightStarter light) {
  if (options.coordinators.empty()) return Error(ErrorCode::kInvalidArgument, "a node needs a coordinator");
  std::vector<CoordinatorConnection::Channels> channels;
  for (const std::string& coordinator : options.coordinators) {
    TRY_ASSIGN(auto work, make_channel(coordinator, options.tls));
    TRY_ASSIGN(auto files, make_channel(coordinator, options.tls));
    channels.push_back({std::move(work), std::move(files)});
  }
  wire::NodeReport hello;
  hello.mutable_hello()->set_version(CYCLORAMA_VERSION);
  hello.mutable_hello()->set_name(options.name);
  hello.mutable_hello()->set_threads(static_cast<std::uint32_t>(options.threads));
  hello.mutable_hello()->set_memory_limit_bytes(options.memory_limit_bytes);
  auto node = std::unique_ptr<FarmNode>(new FarmNode(options, std::move(loader), std::move(light)));
  for (std::size_t i = 0; i < channels.size(); ++i) {
    node->coordinators_.push_back(
        std::make_unique<CoordinatorConnection>(options.coordinators[i], channels[i], hello, node->controller_));
  }
  return node;
}

FarmNode::FarmNode(const FarmNodeOptions& options, SceneLoader loader, LightStarter light)
    : controller_(std::move(loader), options.memory_limit_bytes, options.cache, std::move(light), options.crew),
      load_thread_([this] {
        give_way(kRaysGiveWay);
        while (controller_.loads().wait()) controller_.loads().work();
      }),
      light_thread_([this] {
        while (controller_.lights().wait()) controller_.lights().work();
      }) {
  for (std::size_t lane = 0; lane < controller_.renders().lanes(); ++lane) {
    render_threads_.emplace_back([this, lane] {
      give_way(kRaysGiveWay);
      while (controller_.renders().wait()) controller_.renders().work(lane);
    });
  }
}

FarmNode::~FarmNode() { stop(); }

void FarmNode::drain(Duration limit) {
  // A coordinator that has not yet received the status may have sent one more block.
  constexpr Duration kQuiet = std::chrono::milliseconds(250);
  constexpr Duration kForSending = std::chrono::seconds(1);
  const TimePoint deadline = SteadyClock().now() + limit;
  controller_.drain();
  controller_.renders().wait_until_idle(deadline, std::min(kQuiet, limit));
  for (const auto& coordinator : coordinators_) coordinator->finish();
  const TimePoint sent = SteadyClock().now() + std::min(kForSending, limit);
  for (const auto& coordinator : coordinators_) coordinator->wait_until_ended(sent);
}

void FarmNode::stop() {
  for (const auto& coordinator : coordinators_) coordinator->stop();
  controller_.renders().stop();
  controller_.loads().stop();
  controller_.lights().stop();
  for (std::thread& render : render_threads_) {
    if (render.joinable()) render.join();
  }
  if (load_thread_.joinable()) load_thread_.join();
  if (light_thread_.joinable()) light_thread_.join();
}

std::string FarmNode::state() const {
  std::string sentences;
  for (const auto& coordinator : coordinators_) sentences += (sentences.empty() ? "" : "; ") + coordinator->state();
  if (const std::string loads = controller_.loads().state(); !loads.empty()) sentences += "; " + loads;
  return sentences;
}

}  // namespace cyclorama::node
