// SPDX-License-Identifier: Apache-2.0
/// A coordinator on [::1] without nodes. Answers every view with tiles of one plain colour, as scripted.
#pragma once

#include <grpcpp/server_context.h>

#include <algorithm>
#include <cmath>
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <random>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "common/base/clock.h"
#include "common/image/jpeg.h"
#include "common/wire/channel.h"
#include "common/wire/farm.grpc.pb.h"
#include "tests/doubles/fake_scene.h"

namespace cyclorama {

/// Listens from its construction, on a free port or on the given one, so that a test can restart it. Thread-safe.
class FakeFarm final : public wire::Farm::Service {
 public:
  explicit FakeFarm(wire::SceneDescription scene = fake_scene("plain"), int port = 0) : scene_(std::move(scene)) {
    auto server = WireServer::start("[::1]:" + std::to_string(port), {this});
    CHECK(server);
    server_ = *std::move(server);
    port_ = server_->port();
  }
  ~FakeFarm() override { stop(); }
  FakeFarm(const FakeFarm&) = delete;
  FakeFarm& operator=(const FakeFarm&) = delete;

  [[nodiscard]] int port() const { return port_; }
  [[nodiscard]] std::string address() const { return "[::1]:" + std::to_string(port_); }

  // The script, which may be changed at any time:

  /// Opens or closes the gate. While it is closed, views are received, but not answered.
  void set_gate(bool open) {
    change([&] { gate_open_ = open; });
  }
  /// Sets the range of the time per frame, drawn uniformly.
  void set_frame_time(Duration min, Duration max) {
    change([&] { frame_time_ = {min, max}; });
  }
  /// Switches to pictures of vertical stripes that are fixed in the scene, so that only a turn changes the visible
  /// picture, and a new frame does not. Only for cylindrical panoramas.
  void set_striped(bool striped) {
    change([&] { striped_ = striped; });
  }
  /// Refuses new sessions with this status; OK accepts them again.
  void refuse_sessions(grpc::Status status) {
    change([&] { refusal_ = std::move(status); });
  }
  /// Makes the next frame end after its `begin` and this many tiles, when the stream breaks.
  void break_next_frame_after(int tiles) {
    change([&] { break_after_ = tiles; });
  }
  /// Cancels every session and stops listening.
  void stop() {
    change([&] { stopping_ = true; });
    server_->stop(Duration::zero());
  }

  // Recorded events:

  [[nodiscard]] std::vector<wire::View> views() const {
    const std::lock_guard lock(mutex_);
    return views_;
  }
  [[nodiscard]] int sessions() const {
    const std::lock_guard lock(mutex_);
    return sessions_;
  }
  [[nodiscard]] wire::OpenSession last_open() const {
    const std::lock_guard lock(mutex_);
    return last_open_;
  }
  /// Waits until `count` views have arrived in all sessions together. Returns false at the deadline.
  bool wait_for_views(std::size_t count, Duration limit = std::chrono::seconds(10)) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, limit, [&] { return views_.size() >= count; });
  }

  /// Returns the colour of frame `number` as sRGB in the order R, G, B.
  static void colour_of(std::uint64_t number, std::uint8_t (&ret_rgb)[3]) {
    for (unsigned i = 0; i < 3; ++i) ret_rgb[i] = static_cast<std::uint8_t>(40 + (number * (37 + 20 * i)) % 200);
  }

 private:
  using Stream = grpc::ServerReaderWriter<wire::SessionReply, wire::SessionRequest>;
  struct Inbox {
    std::vector<wire::View> waiting;
    bool closed = false;
  };

  template <typename Change>
  void change(Change&& make) {
    {
      const std::lock_guard lock(mutex_);
      make();
    }
    changed_.notify_all();
  }

  grpc::Status ListScenes(grpc::ServerContext*, const wire::ListScenesRequest*, wire::ListScenesReply* reply) override {
    reply->add_scenes()->set_name(scene_.name());
    reply->mutable_scenes(0)->set_title(scene_.title());
    return grpc::Status::OK;
  }

  grpc::Status Session(grpc::ServerContext* context, Stream* stream) override {
    wire::SessionRequest first;
    if (!stream->Read(&first) || !first.has_open()) return {grpc::StatusCode::INVALID_ARGUMENT, "open comes first"};
    {
      const std::lock_guard lock(mutex_);
      ++sessions_;
      last_open_ = first.open();
      if (!refusal_.ok()) return refusal_;
    }
    changed_.notify_all();
    wire::SessionReply opened;
    *opened.mutable_opened() = scene_;
    stream->Write(opened);
    Inbox inbox;
    std::thread reader([&] { read_views(*stream, &inbox); });
    const grpc::Status status = answer(*stream, &inbox);
    context->TryCancel();
    reader.join();
    return status;
  }

  void read_views(Stream& stream, Inbox* inbox) {
    wire::SessionRequest request;
    while (stream.Read(&request)) {
      change([&] {
        views_.push_back(request.view());
        inbox->waiting.push_back(request.view());
      });
    }
    change([&] { inbox->closed = true; });
  }

  grpc::Status answer(Stream& stream, Inbox* inbox) {
    for (;;) {
      wire::View view;
      int tiles = -1;
      bool striped = false;
      {
        std::unique_lock lock(mutex_);
        changed_.wait(lock, [&] { return stopping_ || inbox->closed || (gate_open_ && !inbox->waiting.empty()); });
        if (stopping_ || inbox->closed) return grpc::Status::OK;
        view = inbox->waiting.front();
        inbox->waiting.erase(inbox->waiting.begin());
        tiles = std::exchange(break_after_, -1);
        striped = striped_;
        const double share = std::uniform_real_distribution(0.0, 1.0)(random_);
        const auto takes =
            frame_time_.first + std::chrono::duration_cast<Duration>(
                                    share * std::chrono::duration<double>(frame_time_.second - frame_time_.first));
        changed_.wait_for(lock, takes, [&] { return stopping_ || inbox->closed; });
      }
      if (!send_frame(stream, view, tiles, striped))
        return {grpc::StatusCode::UNAVAILABLE, "the script broke the stream"};
    }
  }

  static bool send_frame(Stream& stream, const wire::View& view, int break_after, bool striped) {
    constexpr std::uint32_t kTilePx = 256;
    wire::SessionReply reply;
    *reply.mutable_begin() = view;
    bool sent = stream.Write(reply);
    std::uint32_t tiles = 0;
    for (std::uint32_t y = 0; y < view.panorama().height_px(); y += kTilePx) {
      for (std::uint32_t x = 0; x < view.panorama().width_px(); x += kTilePx) {
        if (break_after >= 0 && static_cast<int>(tiles) >= break_after) return false;
        wire::Tile* const tile = reply.mutable_tile();
        tile->set_view_number(view.number());
        tile->set_x_px(x);
        tile->set_y_px(y);
        tile->set_width_px(std::min(kTilePx, view.panorama().width_px() - x));
        tile->set_height_px(std::min(kTilePx, view.panorama().height_px() - y));
        const RgbImage picture = striped ? stripes(view, *tile) : plain(view, *tile);
        const auto jpeg =
            JpegEncoder().encode(picture, {static_cast<int>(view.jpeg_quality()), view.subsample_chroma()});
        CHECK(jpeg);
        tile->set_jpeg(std::string(reinterpret_cast<const char*>(jpeg->data()), jpeg->size()));
        sent = sent && stream.Write(reply);
        ++tiles;
      }
    }
    wire::FrameEnd* const end = reply.mutable_end();
    end->set_view_number(view.number());
    end->set_tiles(tiles);
    end->set_complete(true);
    end->set_nodes(1);
    end->set_balance_efficiency(1.0);
    for (const char* const name : {"plan", "render", "encode", "farm"}) {
      wire::StageTime* const stage = end->add_stages();
      stage->set_name(name);
      stage->set_seconds(1e-3);
    }
    return sent && stream.Write(reply);
  }

  static RgbImage plain(const wire::View& view, const wire::Tile& tile) {
    RgbImage image(static_cast<int>(tile.width_px()), static_cast<int>(tile.height_px()));
    std::uint8_t rgb[3];
    colour_of(view.number(), rgb);
    for (std::size_t i = 0; i < image.data().size(); ++i) image.data()[i] = rgb[i % 3];
    return image;
  }
  static RgbImage stripes(const wire::View& view, const wire::Tile& tile) {
    RgbImage image(static_cast<int>(tile.width_px()), static_cast<int>(tile.height_px()));
    const wire::Panorama& panorama = view.panorama();
    for (int x = 0; x < image.width(); ++x) {
      const double across = (static_cast<double>(tile.x_px()) + x + 0.5) / panorama.width_px() - 0.5;
      const double azimuth = view.heading_rad() + panorama.azimuth_span_rad() * across;
      const auto grey = static_cast<std::uint8_t>(std::lround(128.0 + 100.0 * std::sin(90.0 * azimuth)));
      for (int y = 0; y < image.height(); ++y) std::fill_n(image.at(x, y), 3, grey);
    }
    return image;
  }

  const wire::SceneDescription scene_;
  int port_ = 0;

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  bool gate_open_ = true;
  bool stopping_ = false;
  int break_after_ = -1;
  bool striped_ = false;
  std::pair<Duration, Duration> frame_time_{};
  std::mt19937 random_{1};
  grpc::Status refusal_;
  std::vector<wire::View> views_;
  int sessions_ = 0;
  wire::OpenSession last_open_;

  std::unique_ptr<WireServer> server_;
};

}  // namespace cyclorama
