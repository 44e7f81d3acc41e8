// SPDX-License-Identifier: Apache-2.0 cyclorama-visit: opens a session without a museum, and measures whether the farm
// is available, how fast it is, and what it shows.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>

#include "common/base/file.h"
#include "common/base/latest_value.h"
#include "common/base/percentiles.h"
#include "common/image/jpeg.h"
#include "common/image/png.h"
#include "common/process/log.h"
#include "common/process/program.h"
#include "common/wire/convert.h"
#include "common/wire/payload.h"
#include "renderfarm/client/farm_client.h"

namespace cyclorama::tools {
namespace {

struct Arguments {
  client::FarmClientOptions farm{};
  int frames = 100;
  int width = 1920;
  int height = 480;
  int samples = 1;
  int quality = 85;
  double turn_deg = 1.0;
  double limit_s = 120.0;
  std::string picture{};
  std::string json{};
};

/// Requests the next view whenever a frame begins, so that the farm always has work, and collects statistics.
class Visitor final : public client::FarmListener {
 public:
  explicit Visitor(const Arguments& arguments) : arguments_(arguments), picture_(arguments.width, arguments.height) {}

  void set_client(client::FarmClient& client) { client_.put(&client); }
  /// Waits for the last frame. Returns false if the session took too long or a stop was requested.
  [[nodiscard]] bool wait(const StopSignal& stop, TimePoint deadline) {
    constexpr auto kPeriod = std::chrono::milliseconds(200);
    while (!stop.requested() && SteadyClock().now() < deadline) {
      if (done_.take_before(SteadyClock().now() + kPeriod)) return true;
    }
    return false;
  }

  void on_opened(const wire::SceneDescription& scene) override {
    log(LogLevel::kInfo,
        fmt::format("scene '{}': {}, {} triangles seen", scene.name(), scene.title(), scene.triangles_seen()));
    scene_ = scene;
    if (client_now_ == nullptr)
      client_now_ = client_.take_before(SteadyClock().now() + std::chrono::seconds(1)).value_or(nullptr);
    request_view();
  }
  void on_lost(const Error& reason) override { log(LogLevel::kWarning, reason.message()); }
  void on_begin(const wire::View&) override {
    bytes_ = 0;
    request_view();
  }
  void on_tile(wire::Tile tile) override {
    bytes_ += payload_bytes(tile);
    const int x = static_cast<int>(tile.x_px());
    const int y = static_cast<int>(tile.y_px());
    const Status decoded = decoder_.decode_into(std::as_bytes(std::span(tile.jpeg())), picture_.at(x, y),
                                                static_cast<int>(tile.width_px()), static_cast<int>(tile.height_px()),
                                                picture_.row_values());
    if (!decoded) log(LogLevel::kWarning, decoded.error().message());
  }
  void on_end(const wire::FrameEnd& end) override {
    if (!end.complete()) {
      ++given_up_;
      log(LogLevel::kWarning, "a frame was given up: " + end.reason());
      return;
    }
    whole_ = picture_;  // The next frame's tiles are drawn into the same picture, and that frame may never end.
    const TimePoint now = SteadyClock().now();
    if (frames_++ == 0) first_at_ = now;
    last_at_ = now;
    for (const wire::StageTime& stage : end.stages()) stages_[stage.name()].add(1e3 * stage.seconds());
    numbers_["bytes_per_frame"].add(static_cast<double>(bytes_));
    numbers_["balance_efficiency"].add(end.balance_efficiency());
    numbers_["nodes"].add(end.nodes());
    numbers_["tiles"].add(end.tiles());
    if (frames_ >= arguments_.frames) done_.put(true);
  }

  /// Returns the statistics. Precondition: the client has been stopped.
  [[nodiscard]] nlohmann::json summary() const {
    nlohmann::json out;
    out["scene"] = scene_.name();
    out["triangles"] = scene_.triangles_seen();
    out["frames"] = frames_;
    out["frames_given_up"] = given_up_;
    const double seconds = to_seconds(last_at_ - first_at_);
    out["fps"] = frames_ > 1 && seconds > 0.0 ? (frames_ - 1) / seconds : 0.0;
    for (const auto& [name, values] : numbers_) out[name] = values.mean();
    for (const auto& [name, ms] : stages_) {
      out["stages"][name] = {{"p50_ms", ms.at(0.5)}, {"p95_ms", ms.at(0.95)}, {"p99_ms", ms.at(0.99)}};
    }
    return out;
  }
  /// Returns the last complete frame; empty if there was none.
  [[nodiscard]] const RgbImage& picture() const { return whole_; }

 private:
  void request_view() {
    if (client_now_ == nullptr) return;
    constexpr double kDegree = std::numbers::pi / 180.0;
    wire::View view;
    view.set_number(++asked_);
    *view.mutable_eye_m() = scene_.start_eye_m();
    view.set_heading_rad(scene_.start_heading_rad() + arguments_.turn_deg * kDegree * static_cast<double>(asked_ - 1));
    view.set_samples(static_cast<std::uint32_t>(arguments_.samples));
    view.set_jpeg_quality(static_cast<std::uint32_t>(arguments_.quality));
    view.set_subsample_chroma(true);
    Panorama panorama;
    panorama.width_px = arguments_.width;
    panorama.height_px = arguments_.height;
    panorama.azimuth_span_rad = std::numbers::pi;
    const double tan_half = 0.5 * panorama.radians_per_px() * arguments_.height;  // Square pixels at the horizon.
    panorama.tan_elevation_top = tan_half;
    panorama.tan_elevation_bottom = -tan_half;
    to_wire(panorama, view.mutable_panorama());
    client_now_->request(std::move(view));
  }

  const Arguments& arguments_;
  LatestValue<client::FarmClient*> client_;
  LatestValue<bool> done_;
  // Used only by the client's thread until the client has been stopped.
  client::FarmClient* client_now_ = nullptr;
  wire::SceneDescription scene_;
  std::uint64_t asked_ = 0;
  int frames_ = 0;
  int given_up_ = 0;
  std::size_t bytes_ = 0;
  TimePoint first_at_{};
  TimePoint last_at_{};
  std::map<std::string, Percentiles> stages_;
  std::map<std::string, Percentiles> numbers_;
  RgbImage picture_;  ///< The frame that is being received.
  RgbImage whole_{};
  JpegDecoder decoder_;
};

Status run(const Arguments& arguments, const StopSignal& stop) {
  Visitor visitor(arguments);
  TRY_ASSIGN(const auto client, client::FarmClient::start(arguments.farm, visitor));
  visitor.set_client(*client);
  const auto limit = std::chrono::duration_cast<Duration>(std::chrono::duration<double>(arguments.limit_s));
  const bool done = visitor.wait(stop, SteadyClock().now() + limit);
  client->stop();
  const nlohmann::json summary = visitor.summary();
  fmt::print("{}\n", summary.dump(2));
  if (!arguments.json.empty()) TRY(write_file_atomically(arguments.json, summary.dump(2) + "\n"));
  if (!arguments.picture.empty() && visitor.picture().width() > 0) TRY(write_png(arguments.picture, visitor.picture()));
  if (!done) return Error(ErrorCode::kTimedOut, "not all frames arrived; the lines above give the reasons");
  return Done{};
}

}  // namespace
}  // namespace cyclorama::tools

int main(int argc, char** argv) {
  using namespace cyclorama;
  using namespace cyclorama::tools;
  Program program(
      "cyclorama-visit",
      "Opens a session with a render farm without a museum: requests turning views and prints how fast they arrive.");
  Arguments arguments;
  CLI::App& app = program.options();
  constexpr int kMaxSidePx = 16384;
  app.add_option("--farm", arguments.farm.coordinators,
                 "The farm's coordinator, such as [::1]:7401; several are tried in turn")
      ->required();
  app.add_option("--scene", arguments.farm.scene, "The scene (default: the farm's first)");
  app.add_option("--frames", arguments.frames, "Number of frames")
      ->check(CLI::Range(1, 1000000))
      ->capture_default_str();
  app.add_option("--width", arguments.width, "Width of the picture in pixels")
      ->check(CLI::Range(1, kMaxSidePx))
      ->capture_default_str();
  app.add_option("--height", arguments.height, "Height of the picture in pixels")
      ->check(CLI::Range(1, kMaxSidePx))
      ->capture_default_str();
  app.add_option("--samples", arguments.samples, "Samples per pixel")
      ->check(CLI::Range(1, 4096))
      ->capture_default_str();
  app.add_option("--quality", arguments.quality, "JPEG quality")->check(CLI::Range(1, 100))->capture_default_str();
  app.add_option("--turn-deg", arguments.turn_deg, "Rotation to the right per frame")->capture_default_str();
  app.add_option("--limit-s", arguments.limit_s, "Time limit")->capture_default_str();
  app.add_option("--picture", arguments.picture, "Write the last frame here, as PNG");
  app.add_option("--json", arguments.json, "Write the figures here, as JSON");
  arguments.farm.museum = "cyclorama-visit";
  return program.run(argc, argv, [&](const StopSignal& stop) { return run(arguments, stop); });
}
