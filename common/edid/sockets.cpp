// SPDX-License-Identifier: Apache-2.0
#include "common/edid/sockets.h"

#include <fmt/format.h>

#include <algorithm>
#include <tuple>

#include "common/base/file.h"

namespace cyclorama {

std::vector<Socket> list_sockets(const std::filesystem::path& drm) {
  constexpr std::size_t kMaxBytes = 1 << 16;
  std::vector<Socket> sockets;
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator(drm, ignored)) {
    const std::string name = entry.path().filename().string();
    const std::size_t dash = name.find('-');
    if (!name.starts_with("card") || dash == std::string::npos) continue;
    Socket socket{name.substr(0, dash), name.substr(dash + 1)};
    // A connector that vanishes meanwhile is one that is not connected.
    const auto status = read_text_file(entry.path() / "status", kMaxBytes);
    socket.is_connected = status && status->starts_with("connected");
    if (const auto edid = read_edid_file(entry.path() / "edid"); edid) socket.edid = *edid;
    sockets.push_back(std::move(socket));
  }
  std::sort(sockets.begin(), sockets.end(), [](const Socket& a, const Socket& b) {
    return std::tie(a.card, a.connector) < std::tie(b.card, b.connector);
  });
  return sockets;
}

std::string text_of_connected(std::span<const Socket> sockets) {
  const bool has_cards =
      std::any_of(sockets.begin(), sockets.end(), [&](const Socket& s) { return s.card != sockets.front().card; });
  std::string text;
  for (const Socket& socket : sockets) {
    if (!socket.is_connected) continue;
    if (!text.empty()) text += ", ";
    if (has_cards) text += socket.card + " ";
    if (!socket.edid) {
      text += socket.connector + " (no EDID)";
      continue;
    }
    const std::string model =
        socket.edid->model.empty() ? fmt::format("{:04x}", socket.edid->product) : socket.edid->model;
    const std::string serial =
        socket.edid->serial.empty() ? "no serial" : fmt::format("serial \"{}\"", socket.edid->serial);
    text += fmt::format("{} ({} {}, {})", socket.connector, socket.edid->maker, model, serial);
  }
  return text.empty() ? "nothing" : text;
}

}  // namespace cyclorama
