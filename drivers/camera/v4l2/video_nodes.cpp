// SPDX-License-Identifier: Apache-2.0
#include "drivers/camera/v4l2/video_nodes.h"

#include <fmt/format.h>
#include <linux/videodev2.h>

#include <map>
#include <optional>
#include <utility>

namespace cyclorama::camera {
namespace {

/// The kernel numbers up to 256 devices. Trying each requires neither udev nor a listing of /dev.
constexpr int kNodes = 256;

std::string node_path(int number) { return fmt::format("/dev/video{}", number); }

/// Calls `visit(NamedDevice)` for every camera, lowest number first, until `visit` returns false, and `fail(path,
/// Error)` for each device that exists but cannot be inspected.
template <typename Visit, typename Fail>
void for_each_camera(Visit visit, Fail fail) {
  std::map<std::string, int> at_port;
  for (int number = 0; number < kNodes; ++number) {
    auto device = VideoDevice::open(node_path(number));
    if (!device) {
      // Absent numbers and devices that are not cameras are skipped silently.
      if (device.error().code() != ErrorCode::kNotFound) fail(node_path(number), device.error());
      continue;
    }
    const int before = at_port[device->port()]++;
    const std::string port_path = before == 0 ? device->port() : fmt::format("{}+{}", device->port(), before);
    if (!visit(NamedDevice{*std::move(device), port_path})) return;
  }
}

Result<NamedDevice> open_path(const std::string& path) {
  TRY_ASSIGN(VideoDevice device, VideoDevice::open(path));
  std::string port_path = device.port();
  for_each_camera(
      [&](const NamedDevice& other) {
        if (other.device.number() != device.number()) return true;
        port_path = other.port_path;
        return false;
      },
      [](const std::string&, const Error&) {});
  return NamedDevice{std::move(device), std::move(port_path)};
}

std::string sends_of(const VideoDevice& device) {
  const PicturePreference preferred;
  const auto offers = device.offers(preferred);
  if (!offers) return "";
  const auto chosen = choose_picture(*offers, preferred);
  return chosen ? describe((*offers)[*chosen]) : "";
}

}  // namespace

Result<NamedDevice> open_video_device(std::string_view where) {
  if (where.starts_with("/")) return open_path(std::string(where));
  std::optional<NamedDevice> found;
  std::string others;
  std::optional<Error> failure;
  for_each_camera(
      [&](NamedDevice&& camera) {
        if (where.empty() || camera.port_path == where) {
          found.emplace(std::move(camera));
          return false;
        }
        others += fmt::format("{}{}", others.empty() ? "" : ", ", camera.port_path);
        return true;
      },
      [&](const std::string&, const Error& error) {
        if (!failure) failure = error;
      });
  if (found) return *std::move(found);
  if (others.empty() && failure) return *failure;
  return Error(ErrorCode::kNotFound,
               fmt::format("no camera {}{}; there {}", where.empty() ? "is plugged in" : "at port ", where,
                           others.empty() ? "is none" : "are cameras at " + others));
}

std::vector<ListedCamera> list_v4l2_cameras() {
  std::vector<ListedCamera> cameras;
  for_each_camera(
      [&](const NamedDevice& camera) {
        ListedCamera listed{"v4l2:" + camera.port_path, camera.device.name(), camera.device.path(),
                            sends_of(camera.device), ""};
        if (listed.sends.empty()) listed.problem = "it offers no pixels that can be read";
        cameras.push_back(std::move(listed));
        return true;
      },
      [&](const std::string& path, const Error& error) {
        cameras.push_back({"v4l2:" + path, "", path, "", error.message()});
      });
  return cameras;
}

}  // namespace cyclorama::camera
