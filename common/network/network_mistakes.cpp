// SPDX-License-Identifier: Apache-2.0
#include <arpa/inet.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>

#include "common/base/text.h"
#include "common/network/network_settings.h"

namespace cyclorama {
namespace {

constexpr std::size_t kMaxInterfaceName = 15;  // IFNAMSIZ without its zero.
constexpr std::size_t kMaxText = 200;
constexpr std::size_t kMaxServers = 3;  // The resolver uses no more of them.
// The packet filter lets updates out through unprivileged ports alone.
constexpr long long kFirstProxyPort = 1024;
constexpr long long kLastPort = 65535;

/// An address of either family; bytes beyond the family's are zero.
struct IpAddress {
  int family = AF_INET;
  std::array<std::uint8_t, 16> bytes{};

  [[nodiscard]] int bits() const { return family == AF_INET ? 32 : 128; }
  [[nodiscard]] bool bit(int index) const {
    const unsigned byte = bytes.at(static_cast<std::size_t>(index / 8));
    return ((byte >> static_cast<unsigned>(7 - index % 8)) & 1U) != 0;
  }
  /// True if all bits from `first` on are `value`.
  [[nodiscard]] bool ends_with(int first, bool value) const {
    for (int i = first; i < bits(); ++i) {
      if (bit(i) != value) return false;
    }
    return true;
  }
  [[nodiscard]] bool shares(const IpAddress& other, int first_bits) const {
    for (int i = 0; i < first_bits; ++i) {
      if (bit(i) != other.bit(i)) return false;
    }
    return true;
  }
};

std::optional<IpAddress> ip_address(const std::string& text, int family) {
  IpAddress address;
  address.family = family;
  // inet_pton() refuses "192.0.2.07", and a scope such as "%eno1".
  if (text.size() >= kMaxText || ::inet_pton(family, text.c_str(), address.bytes.data()) != 1) return std::nullopt;
  return address;
}

struct Subnet {
  IpAddress address;
  int prefix = 0;
};

std::optional<Subnet> subnet(const std::string& text, int family) {
  const std::size_t slash = text.find('/');
  if (slash == std::string::npos) return std::nullopt;
  const auto address = ip_address(text.substr(0, slash), family);
  const auto prefix = parse_integer(text.substr(slash + 1));
  if (!address || !prefix || *prefix < 1 || *prefix > address->bits()) return std::nullopt;
  return Subnet{*address, static_cast<int>(*prefix)};
}

/// Returns why no computer of a museum can have this address; empty: one can.
std::string why_unusable(const Subnet& subnet) {
  const IpAddress& ip = subnet.address;
  if (ip.family == AF_INET) {
    if (ip.bytes[0] == 0 || ip.bytes[0] == 127 || ip.bytes[0] >= 224) return "which no computer may have";
    if (ip.bytes[0] == 169 && ip.bytes[1] == 254) return "which computers give themselves when there is no network";
    if (subnet.prefix < 31 && ip.ends_with(subnet.prefix, false)) return "which is the network's own";
    if (subnet.prefix < 31 && ip.ends_with(subnet.prefix, true)) return "which calls all computers of its network";
    return "";
  }
  if (ip.bytes[0] == 0xFF || ip.ends_with(0, false)) return "which no computer may have";
  if (ip.bytes[0] == 0xFE && (ip.bytes[1] & 0xC0) == 0x80) return "which is valid on its cable only";
  if (ip.shares(IpAddress{AF_INET6, {}}, 96)) return "which no computer may have";
  return "";
}

bool is_name_of_letters(std::string_view text, std::string_view others) {
  return !text.empty() && std::ranges::all_of(text, [&](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
           others.find(c) != std::string_view::npos;
  });
}

/// True for a host's name of labels that DNS allows (RFC 1123).
bool is_host_name(const std::string& name) {
  if (name.empty() || name.size() > 253) return false;
  std::size_t begin = 0;
  while (begin <= name.size()) {
    const std::size_t end = std::min(name.find('.', begin), name.size());
    const std::string_view label = std::string_view(name).substr(begin, end - begin);
    if (label.size() > 63 || !is_name_of_letters(label, "-") || label.front() == '-' || label.back() == '-')
      return false;
    begin = end + 1;
  }
  // Names of digits alone are addresses with a mistake, such as "192.0.2".
  return name.find_first_not_of("0123456789.") != std::string::npos;
}

bool is_any_address(const std::string& text) { return ip_address(text, AF_INET) || ip_address(text, AF_INET6); }

/// True for a file beside site.toml, or in a folder beside it, as sticks may hold them.
bool is_file_beside(const std::string& text) {
  return text.size() <= kMaxText && is_name_of_letters(text, ".-_/") && text.front() != '/' && text.back() != '/' &&
         std::ranges::count(text, '/') <= 1 && text.find("..") == std::string::npos;
}

class Judge {
 public:
  explicit Judge(const NetworkSettings& network) : network_(network) {}

  std::vector<NetworkMistake> run() {
    check_interface();
    check_family("ipv4", network_.ipv4, network_.ipv4_address, network_.ipv4_gateway, AF_INET);
    check_family("ipv6", network_.ipv6, network_.ipv6_address, network_.ipv6_gateway, AF_INET6);
    check_servers();
    check_proxy();
    check_login();
    return std::move(mistakes_);
  }

 private:
  void refuse(const std::string& key, std::string sentence) { mistakes_.push_back({key, std::move(sentence)}); }

  void check_interface() {
    const std::string& name = network_.interface;
    const bool is_name = name.size() <= kMaxInterfaceName && is_name_of_letters(name, "-_.");
    if (!name.empty() && !is_name) {
      refuse("interface",
             fmt::format("is '{}', which is no name of a cable; choose one that this computer has, such as "
                         "\"eno1\"",
                         printable(name)));
    } else if (name == "lo" || name == kMuseumVlan) {
      refuse("interface", fmt::format("is '{}', which is no cable; choose the one to the museum's network", name));
    } else if (name.empty() && (network_.vlan != 0 || network_.ipv4 == "static" || network_.ipv6 == "static" ||
                                !network_.login.method.empty())) {
      refuse("interface", "is missing; a fixed address, a VLAN or a login belongs to one cable, so name it");
    }
    if (network_.vlan < 0 || network_.vlan > 4094)
      refuse("vlan", fmt::format("is {}; a VLAN has a number from 1 to 4094, and 0 means none", network_.vlan));
    if (network_.ipv4 == "off" && network_.ipv6 == "off")
      refuse("ipv4", "is off like ipv6, so nobody could reach this computer; use one of them");
  }

  void check_family(const std::string& key, const std::string& way, const std::string& address,
                    const std::string& gateway, int family) {
    const bool is_4 = family == AF_INET;
    const char* const example = is_4 ? "192.0.2.7/24" : "2001:db8::7/64";
    const std::vector<std::string> ways = is_4 ? std::vector<std::string>{"dhcp", "static", "off"}
                                               : std::vector<std::string>{"automatic", "static", "off"};
    if (std::ranges::find(ways, way) == ways.end())
      return refuse(key, fmt::format("is '{}'; choose {}, static or off", printable(way), ways.front()));
    if (way != "static") {
      for (const auto& [what, value] : {std::pair{"_address", &address}, std::pair{"_gateway", &gateway}}) {
        if (!value->empty())
          refuse(key + what, fmt::format("belongs to a fixed address; write {} = \"static\", or leave it out", key));
      }
      return;
    }
    const auto own = subnet(address, family);
    if (!own) {
      refuse(key + "_address", address.empty() ? fmt::format("is missing; write the address, with the network's length "
                                                             "after a slash, such as \"{}\"",
                                                             example)
                                               : fmt::format("is '{}', which is no such address with the network's "
                                                             "length after a slash; write one such as \"{}\"",
                                                             printable(address), example));
    } else if (const std::string why = why_unusable(*own); !why.empty()) {
      refuse(key + "_address",
             fmt::format("is '{}', {}; take the one that the museum's network has for this computer", address, why));
    }
    check_gateway(key + "_gateway", gateway, own, family);
  }

  void check_gateway(const std::string& key, const std::string& gateway, const std::optional<Subnet>& own, int family) {
    if (gateway.empty()) return;  // The farm may be in the museum, so that no router is needed.
    const auto router = ip_address(gateway, family);
    if (!router) {
      return refuse(
          key, fmt::format("is '{}', which is no {} address; write the router's, such as \"{}\"", printable(gateway),
                           family == AF_INET ? "IPv4" : "IPv6", family == AF_INET ? "192.0.2.1" : "2001:db8::1"));
    }
    const bool is_link_local = family == AF_INET6 && router->bytes[0] == 0xFE && (router->bytes[1] & 0xC0) == 0x80;
    if (!own || is_link_local) return;
    if (!router->shares(own->address, own->prefix)) {
      refuse(key, fmt::format("is '{}', which is not in this computer's network of /{}; look at both numbers", gateway,
                              own->prefix));
    } else if (router->bytes == own->address.bytes) {
      refuse(key, fmt::format("is '{}', which is this computer's own address; write the router's", gateway));
    }
  }

  void check_servers() {
    if (network_.dns.size() > kMaxServers) refuse("dns", "has more than three servers; name up to three");
    for (const std::string& server : network_.dns) {
      if (is_any_address(server)) continue;
      refuse("dns",
             fmt::format("has '{}', which is no address; a name server cannot be looked up by its name, so write "
                         "one such as \"192.0.2.53\"",
                         printable(server)));
      break;
    }
    const bool is_told = network_.ipv4 == "dhcp" || network_.ipv6 == "automatic";
    if (network_.dns.empty() && !is_told)
      refuse("dns", "is missing; fixed addresses bring no name servers, so write the museum's");
    if (network_.time_servers.size() > kMaxServers)
      refuse("time_servers", "has more than three servers; name up to three");
    for (const std::string& server : network_.time_servers) {
      if (is_any_address(server) || is_host_name(server)) continue;
      return refuse("time_servers", fmt::format("has '{}', which is neither an address nor a name; write one such as "
                                                "\"time.museum.example\"",
                                                printable(server)));
    }
  }

  void check_proxy() {
    constexpr std::string_view kScheme = "http://";
    if (network_.proxy.empty()) return;
    const std::string place = network_.proxy.starts_with(kScheme) ? network_.proxy.substr(kScheme.size()) : "";
    const std::size_t colon = place.rfind(':');
    const bool has_port = colon != std::string::npos;
    std::string host = place.substr(0, colon);
    const bool is_v6 = host.starts_with('[') && host.ends_with(']');
    if (is_v6) host = host.substr(1, host.size() - 2);
    const long long port = has_port ? parse_integer(place.substr(colon + 1)).value_or(0) : 0;
    const bool is_host =
        is_v6 ? ip_address(host, AF_INET6).has_value() : ip_address(host, AF_INET).has_value() || is_host_name(host);
    if (!is_host || port < 1 || port > kLastPort) {
      refuse("proxy", fmt::format("is '{}', which is no proxy; write one such as \"http://proxy.museum.example:3128\"",
                                  printable(network_.proxy)));
    } else if (port < kFirstProxyPort) {
      refuse("proxy", fmt::format("has the port {}, which this computer's packet filter closes; use the proxy's port "
                                  "above 1023",
                                  port));
    }
  }

  void check_login() {
    const PortLogin& login = network_.login;
    if (login == PortLogin{}) return;
    if (login.method != "peap" && login.method != "ttls" && login.method != "tls")
      return refuse("login.method", fmt::format("is '{}'; choose peap, ttls or tls", printable(login.method)));
    if (login.identity.empty() || login.identity.size() > kMaxText ||
        std::ranges::any_of(login.identity, [](char c) { return c <= ' ' || c > '~' || c == '"' || c == '\\'; })) {
      refuse("login.identity", login.identity.empty()
                                   ? "is missing; write the name that the network knows this computer by"
                                   : "has characters that a login's name cannot have; write letters, digits and marks, "
                                     "without spaces and quotation marks");
    }
    const bool is_tls = login.method == "tls";
    check_file("login.password_file", login.password_file, !is_tls, login.method);
    check_file("login.authority", login.authority, true, login.method);
    if (!login.server_name.empty() && !is_host_name(login.server_name))
      refuse("login.server_name", fmt::format("is '{}', which is no host's name; write the one in the certificate of "
                                              "the network's login server",
                                              printable(login.server_name)));
    check_file("login.certificate", login.certificate, is_tls, login.method);
    check_file("login.key", login.key, is_tls, login.method);
  }

  void check_file(const std::string& key, const std::string& file, bool is_needed, const std::string& method) {
    if (file.empty() && is_needed) {
      refuse(key, fmt::format("is missing; {} needs it, so name the file beside site.toml", method));
    } else if (!file.empty() && !is_needed) {
      refuse(key, fmt::format("is not used by {}; leave it out", method));
    } else if (!file.empty() && !is_file_beside(file)) {
      refuse(key,
             "names no file beside site.toml; a name has letters, digits, '.', '-' and '_', in at most one folder");
    }
  }

  static constexpr const char* kMuseumVlan = "museum-vlan";

  const NetworkSettings& network_;
  std::vector<NetworkMistake> mistakes_;
};

}  // namespace

std::vector<NetworkMistake> mistakes_of(const NetworkSettings& network) { return Judge(network).run(); }

}  // namespace cyclorama
