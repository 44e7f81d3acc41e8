// SPDX-License-Identifier: Apache-2.0
#include "kiosk/network/network_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <system_error>
#include <utility>

#include "common/base/file.h"

namespace cyclorama::network {
namespace {

namespace fs = std::filesystem;

constexpr const char* kCable = "systemd/network/20-museum-cable.network";
constexpr const char* kVlanDevice = "systemd/network/20-museum-vlan.netdev";
constexpr const char* kVlan = "systemd/network/20-museum-vlan.network";
constexpr const char* kLoginConf = "cyclorama-8021x/login.conf";
constexpr const char* kLoginPlace = "cyclorama-8021x/login.env";
constexpr const char* kProxy = "cyclorama-network/proxy.env";
constexpr std::array kAll{kCable, kVlanDevice, kVlan, kLoginConf, kLoginPlace, kProxy};
constexpr std::size_t kMaxBytes = std::size_t{64} * 1024;

constexpr const char* kHead =
    "# SPDX-License-Identifier: Apache-2.0\n# Made by cyclorama-network from [network] in site.toml.\n";
/// The image's 80-cable.network has the same: nothing waits for the network, and the page is found by its name.
constexpr const char* kCommon = "LLMNR=no\nMulticastDNS=yes\n";

std::string joined(const std::vector<std::string>& texts) {
  std::string line;
  for (const std::string& text : texts) line += (line.empty() ? "" : " ") + text;
  return line;
}

/// Returns the sections on addresses and servers.
std::string addresses(const NetworkSettings& network) {
  const bool is_dhcp4 = network.ipv4 == "dhcp";
  const bool is_automatic6 = network.ipv6 == "automatic";
  std::string text = "[Network]\n";
  // DHCPv6 is begun when a router advertises it, which IPv6AcceptRA suffices for.
  text += fmt::format("DHCP={}\nIPv6AcceptRA={}\nLinkLocalAddressing={}\n", is_dhcp4 ? "ipv4" : "no",
                      is_automatic6 ? "yes" : "no", network.ipv6 == "off" ? "no" : "ipv6");
  text += kCommon;
  for (const std::string& address : {network.ipv4_address, network.ipv6_address})
    if (!address.empty()) text += fmt::format("Address={}\n", address);
  for (const std::string& gateway : {network.ipv4_gateway, network.ipv6_gateway})
    if (!gateway.empty()) text += fmt::format("Gateway={}\n", gateway);
  for (const std::string& server : network.dns) text += fmt::format("DNS={}\n", server);
  // With servers of its own, the cable answers for all names.
  if (!network.dns.empty()) text += "Domains=~.\n";
  if (!network.time_servers.empty()) text += fmt::format("NTP={}\n", joined(network.time_servers));
  const std::string others = (network.dns.empty() ? std::string() : "UseDNS=no\n") +
                             (network.time_servers.empty() ? std::string() : "UseNTP=no\n");
  if (!others.empty()) text += fmt::format("[DHCPv4]\n{}[DHCPv6]\n{}", others, others);
  if (!network.dns.empty()) text += "[IPv6AcceptRA]\nUseDNS=no\n";
  return text;
}

std::string matched(const NetworkSettings& network) {
  // A VLAN's device is of the type ether, too.
  return network.interface.empty() ? "[Match]\nType=ether\nKind=!*\n"
                                   : fmt::format("[Match]\nName={}\n", network.interface);
}

constexpr const char* kLink = "[Link]\nRequiredForOnline=no\n";

/// Returns the text in hexadecimal, which wpa_supplicant takes instead of one in quotation marks; no character of it can
/// end the value.
std::string hex(std::string_view text) {
  std::string digits;
  for (const char c : text) digits += fmt::format("{:02x}", static_cast<unsigned char>(c));
  return digits;
}

Result<fs::path> found(const std::string& name, const char* key, const std::vector<fs::path>& folders) {
  std::error_code ignored;
  for (const fs::path& folder : folders) {
    if (fs::is_regular_file(folder / name, ignored)) return folder / name;
  }
  return Error(ErrorCode::kNotFound,
               fmt::format("site.toml [network.login] {}: there is no file '{}' beside it; add it", key, name));
}

Result<std::string> password_in(const fs::path& file) {
  TRY_ASSIGN(const std::string text, read_text_file(file, kMaxBytes));
  std::string line = text.substr(0, text.find('\n'));
  if (line.ends_with('\r')) line.pop_back();
  if (line.empty()) {
    return Error(ErrorCode::kBadData,
                 "site.toml [network.login] password_file: its first line is empty; write the password there");
  }
  return line;
}

Result<std::string> login_conf(const PortLogin& login, const std::vector<fs::path>& folders) {
  TRY_ASSIGN(const fs::path authority, found(login.authority, "authority", folders));
  // ap_scan: a cable has no access points. eapol_flags: a cable has no keys of its own.
  std::string text = fmt::format(
      "{}ap_scan=0\nnetwork={{\n  key_mgmt=IEEE8021X\n  eapol_flags=0\n  eap={}\n  identity={}\n  ca_cert=\"{}\"\n",
      kHead,
      login.method == "peap"   ? "PEAP"
      : login.method == "ttls" ? "TTLS"
                               : "TLS",
      hex(login.identity), authority.string());
  if (!login.server_name.empty()) text += fmt::format("  domain_match=\"{}\"\n", login.server_name);
  if (login.method == "tls") {
    TRY_ASSIGN(const fs::path certificate, found(login.certificate, "certificate", folders));
    TRY_ASSIGN(const fs::path key, found(login.key, "key", folders));
    text += fmt::format("  client_cert=\"{}\"\n  private_key=\"{}\"\n", certificate.string(), key.string());
  } else {
    TRY_ASSIGN(const fs::path file, found(login.password_file, "password_file", folders));
    TRY_ASSIGN(const std::string password, password_in(file));
    text += fmt::format("  phase2=\"auth=MSCHAPV2\"\n  password={}\n", hex(password));
  }
  return text + "}\n";
}

Status put(const NetworkFile& file, const fs::path& run) {
  const fs::path path = run / file.path;
  std::error_code failed;
  fs::create_directories(path.parent_path(), failed);
  if (failed) return Error(ErrorCode::kSystem, fmt::format("'{}': {}", path.parent_path().string(), failed.message()));
  if (file.is_secret) fs::permissions(path.parent_path(), fs::perms::owner_all, failed);
  if (failed) return Error(ErrorCode::kSystem, fmt::format("'{}': {}", path.parent_path().string(), failed.message()));
  return write_file_atomically(path, std::string_view(file.content));
}

}  // namespace

Result<std::vector<NetworkFile>> network_files(const NetworkSettings& network, const std::vector<fs::path>& folders) {
  std::vector<NetworkFile> files;
  NetworkSettings on_cable = network;
  on_cable.proxy.clear();
  on_cable.login = {};
  // Without settings, the image's own 80-cable.network holds.
  if (network.vlan != 0) {
    files.push_back(
        {kVlanDevice, fmt::format("{}[NetDev]\nName=museum-vlan\nKind=vlan\n[VLAN]\nId={}\n", kHead, network.vlan)});
    files.push_back({kVlan, fmt::format("{}[Match]\nName=museum-vlan\n{}{}", kHead, kLink, addresses(network))});
    files.push_back({kCable, fmt::format("{}{}{}[Network]\nVLAN=museum-vlan\nDHCP=no\nIPv6AcceptRA=no\n"
                                         "LinkLocalAddressing=no\n",
                                         kHead, matched(network), kLink)});
  } else if (!(on_cable == NetworkSettings{})) {
    files.push_back({kCable, kHead + matched(network) + kLink + addresses(network)});
  }
  if (!network.proxy.empty()) files.push_back({kProxy, fmt::format("{}https_proxy={}\n", kHead, network.proxy)});
  if (!network.login.method.empty()) {
    TRY_ASSIGN(std::string conf, login_conf(network.login, folders));
    files.push_back({kLoginConf, std::move(conf), true});
    files.push_back({kLoginPlace, fmt::format("{}INTERFACE={}\n", kHead, network.interface)});
  }
  return files;
}

Result<std::vector<std::string>> put_network_files(const std::vector<NetworkFile>& files, const fs::path& run) {
  std::vector<std::string> changed;
  for (const char* const path : kAll) {
    const auto wanted = std::ranges::find(files, fs::path(path), &NetworkFile::path);
    const auto present = read_text_file(run / path, kMaxBytes);
    if (wanted == files.end()) {
      std::error_code failed;
      if (fs::remove(run / path, failed)) changed.push_back(fs::path(path).filename().string());
      if (failed) return Error(ErrorCode::kSystem, fmt::format("removing '{}': {}", path, failed.message()));
    } else if (!present || *present != wanted->content) {
      TRY(put(*wanted, run));
      changed.push_back(fs::path(path).filename().string());
    }
  }
  return changed;
}

}  // namespace cyclorama::network
