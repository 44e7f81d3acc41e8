// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/node/farm_node.h"

#include <fmt/format.h>
#include <grpcpp/client_context.h>

#include <algorithm>
#include <utility>

#include "common/image/cropped.h"
#include "common/wire/channel.h"
#include "common/wire/convert.h"
#include "common/wire/nodes.grpc.pb.h"
#include "renderfarm/balance/tiles.h"
#include "renderfarm/node/tile_sender.h"

namespace cyclorama {
namespace {

constexpr Duration kFirstRetry = std::chrono::milliseconds(100);
constexpr Duration kSlowestRetry = std::chrono::seconds(2);

constexpr std::size_t kMostCommands = 20'000;

using Stream = grpc::ClientReaderWriter<wire::NodeReport, wire::NodeCommand>;

/// Until the link closes or the stream breaks; the latter closes the link, so that nothing is rendered in vain.
void send_reports(Stream& stream, NodeLink& link) {
  TileSender sender;
  while (auto item = link.pop()) {
    if (!stream.Write(sender.report_of(*std::move(item)))) break;
  }
  link.close();
}

/// Precondition: validate(view).
RenderQuality quality_of(const wire::View& view) {
  RenderQuality quality;
  quality.samples = static_cast<int>(view.samples());
  quality.first_sample = static_cast<int>(view.first_sample());
  quality.sequence = static_cast<int>(view.sequence());
  quality.bounces = static_cast<int>(view.bounces());
  if (view.light_samples() > 0) quality.light_samples = static_cast<int>(view.light_samples());
  quality.firefly_limit = view.firefly_limit();
  quality.adaptive_error = view.adaptive_error();
  if (view.adaptive_minimum() > 0) quality.adaptive_minimum = static_cast<int>(view.adaptive_minimum());
  return quality;
}

/// What is wrong with the order, or the view to be rendered. The head checked it too; a node believes nobody.
Result<PanoramaView> view_of(const wire::RenderBlock& block) {
  TRY(validate(block.view()));
  TRY_ASSIGN(const Panorama panorama, from_wire(block.view().panorama()));
  wire::Tile whole;
  whole.set_x_px(block.x_px());
  whole.set_y_px(block.y_px());
  whole.set_width_px(block.width_px());
  whole.set_height_px(block.height_px());
  TRY(validate(whole, panorama));
  // A view's own number is the seed: noise changes from frame to frame and is the same on every node.
  return PanoramaView{from_wire(block.view().eye_m()), block.view().heading_rad(), panorama, quality_of(block.view()),
                      block.view().number()};
}

/// All that decides the samples of a picture.
std::string name_of(const wire::RenderBlock& block) {
  wire::View view = block.view();
  view.clear_samples();
  view.clear_first_sample();
  return block.scene() + '\n' + view.SerializeAsString();
}

void add_cost(const RenderCost& cost, RenderCost* ret_sum) {
  ret_sum->cpu_seconds += cost.cpu_seconds;
  ret_sum->wall_seconds += cost.wall_seconds;
  ret_sum->rays += cost.rays;
}

PixelRect rect_of(const wire::RenderBlock& block) {
  return {static_cast<int>(block.x_px()), static_cast<int>(block.y_px()), static_cast<int>(block.width_px()),
          static_cast<int>(block.height_px())};
}

}  // namespace

Result<std::unique_ptr<FarmNode>> FarmNode::start(FarmNodeOptions options, SceneLoader loader) {
  TRY_ASSIGN(auto channel, make_channel(options.head));
  return std::unique_ptr<FarmNode>(new FarmNode(std::move(options), std::move(channel), std::move(loader)));
}

FarmNode::FarmNode(FarmNodeOptions options, std::shared_ptr<grpc::Channel> channel, SceneLoader loader)
    : options_(std::move(options)),
      channel_(std::move(channel)),
      scenes_(std::move(loader)),
      render_thread_([this] { run_render(); }),
      link_thread_([this] { run_link(); }) {}

FarmNode::~FarmNode() { stop(); }

void FarmNode::stop() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
    if (context_ != nullptr) context_->TryCancel();
    if (link_ != nullptr) link_->close();
  }
  changed_.notify_all();
  if (link_thread_.joinable()) link_thread_.join();
  if (render_thread_.joinable()) render_thread_.join();
}

std::string FarmNode::state() const {
  const std::lock_guard lock(mutex_);
  return state_;
}

void FarmNode::set_state(std::string sentence) {
  const std::lock_guard lock(mutex_);
  state_ = std::move(sentence);
}

bool FarmNode::has_moved_since(TimePoint since) const {
  return !rendering_ || TimePoint(Duration(moved_at_.load())) >= since;
}

void FarmNode::run_link() {
  Duration delay = kFirstRetry;
  for (;;) {
    bool served = false;
    const Error reason = serve(&served);
    delay = served ? kFirstRetry : std::min(2 * delay, kSlowestRetry);
    std::unique_lock lock(mutex_);
    state_ = fmt::format("no head: {}; dialling again", reason.message());
    if (changed_.wait_for(lock, delay, [this] { return stopping_; })) return;
  }
}

Error FarmNode::serve(bool* ret_served) {
  const auto link = std::make_shared<NodeLink>();
  const auto stub = wire::Nodes::NewStub(channel_);
  grpc::ClientContext context;
  {
    const std::lock_guard lock(mutex_);
    if (stopping_) context.TryCancel();
    context_ = &context;
    link_ = link;
  }
  const auto stream = stub->Work(&context);
  wire::NodeReport hello;
  hello.mutable_hello()->set_version(CYCLORAMA_VERSION);
  hello.mutable_hello()->set_name(options_.name);
  hello.mutable_hello()->set_threads(static_cast<std::uint32_t>(options_.threads));
  Status fine = Done{};
  if (stream->Write(hello)) {
    std::thread send([&] { send_reports(*stream, *link); });
    wire::NodeCommand command;
    while (fine && stream->Read(&command)) {
      if (!std::exchange(*ret_served, true)) set_state(fmt::format("serving the head at {}", options_.head));
      fine = take(link, command);
    }
    if (!fine) context.TryCancel();
    link->close();
    changed_.notify_all();
    send.join();
  }
  const grpc::Status status = finish_after_read(context, [&] { return stream->Finish(); });
  const std::lock_guard lock(mutex_);
  context_ = nullptr;
  link_ = nullptr;
  if (!fine) return std::move(fine).error().while_doing(options_.head);
  return status.ok() ? Error(ErrorCode::kUnavailable, options_.head + " ended the stream")
                     : from_grpc(status, options_.head);
}

Status FarmNode::take(const std::shared_ptr<NodeLink>& link, const wire::NodeCommand& message) {
  if (message.has_cancel()) {
    link->cancel(message.cancel().block());
    return Done{};
  }
  if (message.has_render() && !link->take_order(message.render())) {
    return Error(ErrorCode::kBadData,
                 fmt::format("the head sent block {} twice, or too many blocks", message.render().block()));
  }
  {
    const std::lock_guard lock(mutex_);
    if (commands_.size() >= kMostCommands) return Error(ErrorCode::kBadData, "the head sent too many orders at once");
    commands_.push_back({link, message});
  }
  changed_.notify_all();
  return Done{};
}

void FarmNode::run_render() {
  for (;;) {
    Command command;
    {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [this] { return stopping_ || !commands_.empty(); });
      if (stopping_) return;
      command = std::move(commands_.front());
      commands_.pop_front();
    }
    if (command.link->is_closed()) continue;
    if (command.message.has_load_scene()) load(*command.link, command.message.load_scene());
    if (command.message.has_render()) render(*command.link, command.message.render().block());
  }
}

void FarmNode::load(NodeLink& link, const wire::LoadScene& order) {
  wire::NodeReport report;
  loading_ = true;
  *report.mutable_scene_loaded() = scenes_.load(order, [&](double fraction) {
    set_state(fmt::format("loading scene '{}': {:.0f} %", order.scene(), 100.0 * fraction));
  });
  loading_ = false;
  const wire::SceneLoaded& loaded = report.scene_loaded();
  set_state(loaded.error().empty()
                ? fmt::format("serving the head at {}; scene '{}' of {:.1f} M triangles loaded in {:.1f} s",
                              options_.head, loaded.scene(),
                              1e-6 * static_cast<double>(loaded.description().triangles_seen()), loaded.load_seconds())
                : fmt::format("cannot load scene '{}': {}", loaded.scene(), loaded.error()));
  link.push(std::move(report));
}

void FarmNode::render(NodeLink& link, std::uint64_t block) {
  const auto order = link.order(block);
  CHECK(order != nullptr);
  RenderedBlock end = render_tiles(link, *order);
  end.block = block;
  link.forget(block);
  link.push(std::move(end));
}

RgbImage FarmNode::refine_tile(BlockRenderer& renderer, const wire::RenderBlock& block, const PanoramaView& view,
                               const PixelRect& rect, const std::function<bool()>& cancelled, RenderCost* ret_cost) {
  const std::string picture = name_of(block);
  FilmStore::Kept kept = films_.take(block.visit(), picture, rect);
  const int wanted = static_cast<int>(block.view().first_sample() + block.view().samples());
  // Beyond what is wanted: the head asks for an earlier picture again.
  if (kept.samples == 0 || kept.samples > wanted) kept = {Film(rect.width, rect.height, false), 0};
  for (const SampleRange& range : cut_samples({kept.samples, wanted})) {
    Film part;
    add_cost(renderer.render_film(view, rect, range, &part, cancelled), ret_cost);
    if (cancelled()) return {};
    kept.film.add(part);
  }
  kept.samples = wanted;
  RgbImage pixels = renderer.developed(kept.film);
  films_.put(block.visit(), picture, rect, std::move(kept));
  return pixels;
}

RenderedBlock FarmNode::render_tiles(NodeLink& link, const BlockOrder& order) {
  RenderedBlock end;
  const auto view = view_of(order.block);
  BlockRenderer* const renderer = scenes_.find(order.block.scene());
  if (!view || renderer == nullptr) {
    end.error = view ? fmt::format("scene '{}' is not loaded", order.block.scene()) : view.error().message();
    return end;
  }
  const auto cancelled = [&] {
    moved_at_ = SteadyClock().now().time_since_epoch().count();
    return order.cancelled.load() || link.is_closed();
  };
  const JpegOptions options{static_cast<int>(order.block.view().jpeg_quality()), order.block.view().subsample_chroma()};
  if (!order.block.keep()) films_.forget(order.block.visit());
  const PixelRect block = rect_of(order.block);
  // A picture at rest has so many samples that the noise goes by itself, and the denoiser's bias would stay.
  const bool denoise = order.block.view().denoise() && !order.block.keep();
  RgbImage denoised;  // Of the whole block, with the first tile.
  for (const PixelRect& rect : tiles_of(block)) {
    RenderedTile tile{order.block.block(), order.block.view().number(), rect, {}, options};
    moved_at_ = SteadyClock().now().time_since_epoch().count();
    rendering_ = true;
    if (order.block.keep()) {
      tile.pixels = refine_tile(*renderer, order.block, *view, rect, cancelled, &end.cost);
    } else if (denoise) {
      if (denoised.empty()) add_cost(renderer->render_denoised(*view, block, &denoised, cancelled), &end.cost);
      tile.pixels = cropped(denoised, {rect.x - block.x, rect.y - block.y, rect.width, rect.height});
    } else {
      add_cost(renderer->render(*view, rect, &tile.pixels, cancelled), &end.cost);
    }
    rendering_ = false;
    if (cancelled() || !link.push(std::move(tile))) {
      end.error = "cancelled";
      return end;
    }
  }
  return end;
}

}  // namespace cyclorama
