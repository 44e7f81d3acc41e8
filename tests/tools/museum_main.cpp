// SPDX-License-Identifier: Apache-2.0
// A museum that verifies everything: keeps a session open, walks in a circle, and checks every pixel that it receives.
// One line of JSON on standard output per event; times are CLOCK_MONOTONIC, so those of all processes of a machine are
// comparable.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <deque>
#include <filesystem>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>
#include <span>
#include <sstream>
#include <thread>

#include "common/base/file.h"
#include "common/image/jpeg.h"
#include "common/image/png.h"
#include "common/process/program.h"
#include "common/wire/convert.h"
#include "common/wire/payload.h"
#include "renderfarm/client/farm_client.h"
#include "renderfarm/quality/enlarge.h"
#include "tests/support/view_text.h"

namespace cyclorama {
namespace {

using Json = nlohmann::json;

struct Arguments {
  client::FarmClientOptions farm{};
  double rate_hz = 20.0;
  double walk_s = 5.0;
  double rest_s = 0.0;
  int width = 256;
  int height = 128;
  int samples = 1;
  int poses = 120;
  bool stored_light = false;
  bool blind = false;
  double tile_delay_ms = 0.0;
  double timeout_s = 30.0;
  std::string views{};
  std::string pictures{};
  std::string bundle{};
};

double seconds_now() { return to_seconds(SteadyClock().now().time_since_epoch()); }

/// FNV-1a.
std::uint64_t digest_of(std::span<const std::byte> bytes) {
  std::uint64_t digest = 14695981039346656037U;
  for (const std::byte byte : bytes) digest = (digest ^ std::to_integer<std::uint64_t>(byte)) * 1099511628211U;
  return digest;
}

/// Reads one view per line, with increasing numbers: either only the number, or the whole view as written by to_hex(),
/// which begins with 0, unlike a number. Errors: as read_file(), and kBadData.
Result<std::deque<wire::View>> read_views(const std::string& path) {
  constexpr std::size_t kLimitBytes = 64 << 20;
  TRY_ASSIGN(const std::vector<std::byte> bytes, read_file(path, kLimitBytes));
  std::istringstream lines(std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
  std::deque<wire::View> views;
  for (std::string line; std::getline(lines, line);) {
    std::optional<wire::View> view = line.starts_with('0') ? view_from_hex(line) : wire::View();
    if (view && !view->has_panorama()) {
      std::uint64_t number = 0;
      const auto [end, error] = std::from_chars(line.data(), line.data() + line.size(), number);
      if (error != std::errc() || end != line.data() + line.size()) view.reset();
      if (view) view->set_number(number);
    }
    if (!view || view->number() <= (views.empty() ? 0 : views.back().number())) {
      return Error(ErrorCode::kBadData,
                   fmt::format("{}:{}: neither a number above the one before nor such a view", path, views.size() + 1));
    }
    views.push_back(*std::move(view));
  }
  if (views.empty()) return Error(ErrorCode::kBadData, path + ": no views");
  return views;
}

/// Counts how often each cell of the 16-pixel grid was sent; in a complete frame every count is one.
class Cover {
 public:
  Cover() = default;
  Cover(int width_px, int height_px)
      : columns_((width_px + kCell - 1) / kCell),
        cells_(static_cast<std::size_t>(columns_ * ((height_px + kCell - 1) / kCell)), 0) {}
  void add(const wire::Tile& tile) {
    const int x = static_cast<int>(tile.x_px()), y = static_cast<int>(tile.y_px());
    const int right = x + static_cast<int>(tile.width_px()), lower = y + static_cast<int>(tile.height_px());
    for (int row = y / kCell; row * kCell < lower; ++row) {
      for (int column = x / kCell; column * kCell < right; ++column) {
        ++cells_[static_cast<std::size_t>(row * columns_ + column)];
      }
    }
  }
  [[nodiscard]] bool is_whole() const {
    return std::ranges::all_of(cells_, [](int times) { return times == 1; });
  }

 private:
  static constexpr int kCell = 16;
  int columns_ = 0;
  std::vector<int> cells_{};
};

/// Requests views and records events. ask() is called on the main thread, everything else on the client's.
class RecordingListener final : public client::FarmListener {
 public:
  explicit RecordingListener(const Arguments& arguments) : arguments_(arguments) {}

  /// A view with only a number is completed from that number alone. Returns false if no session is open yet.
  bool ask(client::FarmClient& client, wire::View view) {
    const std::lock_guard lock(mutex_);
    if (!scene_) return false;
    if (!view.has_panorama()) view = view_of(view.number());
    asked_at_[view.number()] = seconds_now();
    client.request(std::move(view));
    return true;
  }
  [[nodiscard]] int ended() const {
    const std::lock_guard lock(mutex_);
    return ended_;
  }

  void on_opened(const wire::SceneDescription& scene) override {
    const std::lock_guard lock(mutex_);
    scene_ = scene;
    say({{"event", "opened"}, {"scene", scene.name()}});
  }
  void on_lost(const Error& reason) override {
    // A violation of farm.proto is the farm's fault; everything else is a connection that ended.
    say({{"event", reason.code() == ErrorCode::kBadData ? "violation" : "lost"}, {"reason", reason.message()}});
  }
  void on_begin(const wire::View& view) override {
    view_ = view;
    const int width = static_cast<int>(view.panorama().width_px()),
              height = static_cast<int>(view.panorama().height_px());
    if (picture_.width() != width || picture_.height() != height) picture_ = RgbImage(width, height);
    cover_ = Cover(width, height);
    bytes_ = 0;
    begun_at_ = seconds_now();
  }
  void on_tile(wire::Tile tile) override {
    if (arguments_.tile_delay_ms > 0.0) {
      std::this_thread::sleep_for(std::chrono::duration<double, std::milli>(arguments_.tile_delay_ms));
    }
    cover_.add(tile);
    bytes_ += payload_bytes(tile);
    if (arguments_.blind) return;
    const bool in_colour = !view_.subsample_chroma() || !arguments_.pictures.empty();
    const Status decoded = in_colour ? draw(tile) : draw_grey(tile);
    if (!decoded) say({{"event", "violation"}, {"reason", decoded.error().message()}});
  }
  void on_end(const wire::FrameEnd& end) override {
    Json line{{"event", "frame"},
              {"view", end.view_number()},
              {"complete", end.complete()},
              {"late", end.late()},
              {"reason", end.reason()},
              {"nodes", end.nodes()},
              {"tiles", end.tiles()},
              {"samples", end.samples()},
              {"efficiency", end.balance_efficiency()},
              {"begun_s", begun_at_},
              {"bytes", bytes_},
              {"refined", view_.number() <= last_ended_},
              {"stored_light", view_.stored_light()},
              {"denoise", view_.denoise()},
              {"view_hex", to_hex(view_)},
              {"width_px", picture_.width()}};
    for (const wire::StageTime& stage : end.stages()) line["stages_ms"][stage.name()] = 1e3 * stage.seconds();
    if (end.complete()) {
      line["whole"] = cover_.is_whole();
      if (!arguments_.blind) line["digest"] = fmt::format("{:016x}", digest_of(std::as_bytes(picture_.data())));
    }
    if (end.complete() && !arguments_.pictures.empty()) keep_picture(end.view_number() == last_ended_);
    last_ended_ = end.view_number();
    const std::lock_guard lock(mutex_);
    const auto asked = asked_at_.find(end.view_number());
    if (asked != asked_at_.end()) line["asked_s"] = asked->second;
    asked_at_.erase(asked_at_.begin(), asked_at_.lower_bound(end.view_number()));
    ended_ += end.complete() ? 1 : 0;
    say(std::move(line));
  }

 private:
  /// Writes the last picture of a walk and the first one at rest, when that has come.
  void keep_picture(bool refined) {
    if (refined && !walking_.empty()) {
      if (walking_.width() != picture_.width()) {  // The wall shows it enlarged.
        walking_ = quality::enlarged(walking_, picture_.width(), picture_.height());
      }
      for (const auto& [name, picture] : {std::pair("walking.png", &walking_), std::pair("rest.png", &picture_)}) {
        const Status written = write_png(std::filesystem::path(arguments_.pictures) / name, *picture);
        if (!written) say({{"event", "lost"}, {"reason", written.error().message()}});
      }
      walking_ = {};
    }
    if (!refined) walking_ = picture_;
  }
  Status draw(const wire::Tile& tile) {
    return decoder_.decode_into(std::as_bytes(std::span(tile.jpeg())),
                                picture_.at(static_cast<int>(tile.x_px()), static_cast<int>(tile.y_px())),
                                static_cast<int>(tile.width_px()), static_cast<int>(tile.height_px()),
                                picture_.row_values());
  }
  /// Halved chroma is interpolated only within its tile, so it depends on where the picture was cut.
  Status draw_grey(const wire::Tile& tile) {
    const auto width = static_cast<int>(tile.width_px()), height = static_cast<int>(tile.height_px());
    TRY_ASSIGN(const GreyImage grey, decoder_.decode_grey(std::as_bytes(std::span(tile.jpeg())),
                                                          std::size_t{tile.width_px()} * tile.height_px()));
    if (grey.width() != width || grey.height() != height) {
      return Error(ErrorCode::kBadData, "a tile's JPEG has another size than the tile");
    }
    for (int y = 0; y < height; ++y) {
      std::uint8_t* pixel = picture_.at(static_cast<int>(tile.x_px()), static_cast<int>(tile.y_px()) + y);
      for (int x = 0; x < width; ++x, pixel += 3) std::fill_n(pixel, 3, *grey.at(x, y));
    }
    return Done{};
  }
  wire::View view_of(std::uint64_t number) const {
    constexpr double kRadiusM = 0.25;
    const auto pose = static_cast<double>(number % static_cast<std::uint64_t>(arguments_.poses));
    const double turned = 2.0 * std::numbers::pi * pose / arguments_.poses;
    wire::View view;
    view.set_number(number);
    *view.mutable_eye_m() = scene_->start_eye_m();
    view.mutable_eye_m()->set_x(scene_->start_eye_m().x() + kRadiusM * std::sin(turned));
    view.mutable_eye_m()->set_z(scene_->start_eye_m().z() + kRadiusM * std::cos(turned));
    view.set_heading_rad(scene_->start_heading_rad() + turned);
    view.set_samples(static_cast<std::uint32_t>(arguments_.samples));
    view.set_stored_light(arguments_.stored_light);
    constexpr std::uint32_t kQuality = 85;
    view.set_jpeg_quality(kQuality);
    view.set_subsample_chroma(false);  // Decoded pixels then do not depend on where tiles are cut.
    Panorama panorama;
    panorama.width_px = arguments_.width;
    panorama.height_px = arguments_.height;
    panorama.azimuth_span_rad = std::numbers::pi;
    const double tan_half = 0.5 * panorama.radians_per_px() * arguments_.height;  // Square pixels at the horizon.
    panorama.tan_elevation_top = tan_half;
    panorama.tan_elevation_bottom = -tan_half;
    to_wire(panorama, view.mutable_panorama());
    return view;
  }
  static void say(Json line) {
    line["at_s"] = seconds_now();
    fmt::print("{}\n", line.dump());
    std::fflush(stdout);
  }

  const Arguments& arguments_;
  mutable std::mutex mutex_;  ///< Guards the following.
  std::optional<wire::SceneDescription> scene_{};
  std::map<std::uint64_t, double> asked_at_;
  int ended_ = 0;
  // Used only on the client's thread.
  wire::View view_;
  RgbImage picture_;  ///< Grey if the farm chose to halve the chroma.
  RgbImage walking_;  ///< With --pictures: the last whole one that moved.
  std::uint64_t last_ended_ = 0;
  Cover cover_;
  std::size_t bytes_ = 0;
  double begun_at_ = 0.0;
  JpegDecoder decoder_;
};

/// Requests views at the given rate for ever; or, with a list, each of its views when the previous frame has ended.
void walk(const Arguments& arguments, std::deque<wire::View> list, RecordingListener& listener,
          client::FarmClient& client, const StopSignal& stop) {
  const bool lockstep = !list.empty();
  const auto period = std::chrono::duration_cast<Duration>(
      lockstep ? std::chrono::duration<double>(0.001) : std::chrono::duration<double>(1.0 / arguments.rate_hz));
  const SteadyClock clock;
  const TimePoint began = clock.now();
  TimePoint next = began;
  wire::View next_view;
  next_view.set_number(1);
  for (int asked = 0; !stop.wait_until(next); next = std::max(next + period, clock.now())) {
    if (!lockstep) {
      const bool rests = std::fmod(to_seconds(next - began), arguments.walk_s + arguments.rest_s) >= arguments.walk_s;
      if (!rests && listener.ask(client, next_view)) next_view.set_number(next_view.number() + 1);
    } else if (asked <= listener.ended()) {
      if (list.empty()) return;
      if (!listener.ask(client, list.front())) continue;
      list.pop_front();
      ++asked;
    }
  }
}

Status run(Arguments& arguments, const StopSignal& stop) {
  arguments.farm.timeout = std::chrono::duration_cast<Duration>(std::chrono::duration<double>(arguments.timeout_s));
  if (!arguments.bundle.empty()) {
    const std::filesystem::path folder = arguments.bundle;
    arguments.farm.tls = TlsFiles{folder / "authority.crt", folder / "certificate.crt", folder / "key.pem"};
  }
  std::deque<wire::View> list;
  if (!arguments.views.empty()) {
    TRY_ASSIGN(list, read_views(arguments.views));
  }
  RecordingListener listener(arguments);
  TRY_ASSIGN(const auto client, client::FarmClient::start(arguments.farm, listener));
  walk(arguments, std::move(list), listener, *client, stop);
  client->stop();
  return Done{};
}

}  // namespace
}  // namespace cyclorama

int main(int argc, char** argv) {
  using namespace cyclorama;
  Program program("test-museum", "Visits a farm and checks every pixel that comes; one line of JSON per event.");
  Arguments arguments;
  arguments.farm.museum = "test-museum";
  CLI::App& app = program.options();
  app.add_option("--farm", arguments.farm.coordinators, "The farm's coordinators, tried in turn")->required();
  app.add_option("--scene", arguments.farm.scene, "Which scene (default: the farm's first)");
  app.add_option("--museum", arguments.farm.museum, "Its name");
  app.add_option("--bundle", arguments.bundle, "The folder of its certificate, key and authority: dial with TLS");
  app.add_option("--budget-ms", arguments.farm.frame_budget_ms, "Per frame: the farm chooses the quality");
  app.add_option("--reference-samples", arguments.farm.reference_samples, "Of the picture at rest");
  app.add_option("--timeout-s", arguments.timeout_s, "A coordinator that says nothing for so long is given up");
  app.add_option("--rate-hz", arguments.rate_hz, "Of the views")->check(CLI::Range(0.01, 1000.0));
  app.add_option("--walk-s", arguments.walk_s, "Between two rests")->check(CLI::Range(0.1, 1e6));
  app.add_option("--rest-s", arguments.rest_s, "Ask for nothing for so long, again and again; 0: never")
      ->check(CLI::Range(0.0, 1e6));
  app.add_option("--views", arguments.views,
                 "Ask for these views, one a line, each when the one before has come: a number, or a frame's view_hex");
  app.add_option("--width", arguments.width, "Of the picture, in pixels");
  app.add_option("--height", arguments.height, "Of the picture, in pixels");
  app.add_option("--samples", arguments.samples, "Per pixel");
  app.add_option("--poses", arguments.poses, "Different views of the round")->check(CLI::Range(1, 100000));
  app.add_flag("--stored-light", arguments.stored_light, "Ask for pictures that read stored light (without a budget)");
  app.add_option("--pictures", arguments.pictures,
                 "Write the last picture of a walk and the first one at rest into this folder");
  app.add_flag("--blind", arguments.blind, "Take tiles without looking at them: all of the processor is the farm's");
  app.add_option("--tile-delay-ms", arguments.tile_delay_ms, "Be a slow museum: wait so long at each tile");
  return program.run(argc, argv, [&](const StopSignal& stop) { return run(arguments, stop); });
}
