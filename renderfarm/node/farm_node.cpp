// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/node/farm_node.h"

#include <grpcpp/channel.h>

#include <algorithm>
#include <utility>

#include "common/base/give_way.h"
#include "common/wire/channel.h"
#include "renderfarm/node/head_dialler.h"

namespace cyclorama {
namespace {

/// Of nice: threads that render fill all processors, and an order or a tile must not wait for one of them to be free.
constexpr int kRaysGiveWay = 5;

}  // namespace

Result<std::unique_ptr<FarmNode>> FarmNode::start(const FarmNodeOptions& options, SceneLoader loader) {
  if (options.heads.empty()) return Error(ErrorCode::kInvalidArgument, "a node needs a head");
  std::vector<HeadDialler::Channels> channels;
  for (const std::string& head : options.heads) {
    TRY_ASSIGN(auto work, make_channel(head, options.tls));
    TRY_ASSIGN(auto files, make_channel(head, options.tls));
    channels.push_back({std::move(work), std::move(files)});
  }
  wire::NodeReport hello;
  hello.mutable_hello()->set_version(CYCLORAMA_VERSION);
  hello.mutable_hello()->set_name(options.name);
  hello.mutable_hello()->set_threads(static_cast<std::uint32_t>(options.threads));
  hello.mutable_hello()->set_memory_limit_bytes(options.memory_limit_bytes);
  auto node = std::unique_ptr<FarmNode>(new FarmNode(options, std::move(loader)));
  for (std::size_t i = 0; i < channels.size(); ++i) {
    node->heads_.push_back(std::make_unique<HeadDialler>(options.heads[i], channels[i], hello, node->desk_));
  }
  return node;
}

FarmNode::FarmNode(const FarmNodeOptions& options, SceneLoader loader)
    : desk_(std::move(loader), options.memory_limit_bytes, options.cache),
      render_thread_([this] {
        give_way(kRaysGiveWay);
        while (desk_.renders().wait()) desk_.renders().work();
      }),
      load_thread_([this] {
        give_way(kRaysGiveWay);
        while (desk_.loads().wait()) desk_.loads().work();
      }) {}

FarmNode::~FarmNode() { stop(); }

void FarmNode::drain(Duration limit) {
  // A head that has not heard yet may have sent one more block.
  constexpr Duration kQuiet = std::chrono::milliseconds(250);
  constexpr Duration kForSending = std::chrono::seconds(1);
  const TimePoint deadline = SteadyClock().now() + limit;
  desk_.drain();
  desk_.renders().wait_until_idle(deadline, std::min(kQuiet, limit));
  for (const auto& head : heads_) head->finish();
  const TimePoint sent = SteadyClock().now() + std::min(kForSending, limit);
  for (const auto& head : heads_) head->wait_until_ended(sent);
}

void FarmNode::stop() {
  for (const auto& head : heads_) head->stop();
  desk_.renders().stop();
  desk_.loads().stop();
  if (render_thread_.joinable()) render_thread_.join();
  if (load_thread_.joinable()) load_thread_.join();
}

std::string FarmNode::state() const {
  std::string sentences;
  for (const auto& head : heads_) sentences += (sentences.empty() ? "" : "; ") + head->state();
  if (const std::string loads = desk_.loads().state(); !loads.empty()) sentences += "; " + loads;
  return sentences;
}

}  // namespace cyclorama
