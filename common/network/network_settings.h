// SPDX-License-Identifier: Apache-2.0
/// How a museum's computer joins the museum's network. From site.toml:
///
///   # site.toml
///   [network]                     # Left out: addresses from the network, on every cable.
///   interface = "eno1"            # The cable's name; needed by what is not automatic.
///   ipv4 = "static"               # "dhcp", "static" or "off".
///   ipv4_address = "192.0.2.7/24"
///   ipv4_gateway = "192.0.2.1"
///   ipv6 = "automatic"            # By SLAAC and DHCPv6, as the router says; "static" or "off".
///   dns = ["192.0.2.53"]
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/result.h"

namespace cyclorama {

/// 802.1X on the cable. Files lie beside site.toml.
struct PortLogin {
  std::string method{};         ///< "peap", "ttls" or "tls"; empty: the port requires no login.
  std::string identity{};       ///< Such as "kiosk@museum.example".
  std::string password_file{};  ///< For peap and ttls: its first line is the password.
  std::string authority{};      ///< Certificate by which the network proves itself.
  std::string server_name{};    ///< Name in that certificate's holder; empty: any holder of one.
  std::string certificate{};    ///< For tls.
  std::string key{};            ///< For tls.

  friend bool operator==(const PortLogin&, const PortLogin&) = default;
};

/// The texts of [network], as people write them. A value; mistakes_of() judges it.
struct NetworkSettings {
  std::string interface {};
  int vlan = 0;  ///< 0: none.
  std::string ipv4 = "dhcp";
  std::string ipv4_address{};
  std::string ipv4_gateway{};
  std::string ipv6 = "automatic";
  std::string ipv6_address{};
  std::string ipv6_gateway{};
  std::vector<std::string> dns{};           ///< Empty: those that the network names.
  std::vector<std::string> time_servers{};  ///< Empty: those that the network names, else Debian's.
  std::string proxy{};                      ///< For updates from the farm, "http://HOST:PORT"; empty: none.
  PortLogin login{};

  friend bool operator==(const NetworkSettings&, const NetworkSettings&) = default;
};

/// A mistake, by the key of the value that has to change.
struct NetworkMistake {
  std::string key;       ///< "ipv4_gateway", "login.identity".
  std::string sentence;  ///< Continues the key: "is '192.0.2', which ...; write ...".
};

/// Returns the mistakes in the order of the keys; at most one for each key.
[[nodiscard]] std::vector<NetworkMistake> mistakes_of(const NetworkSettings& network);

/// Reads [network] and ignores the tables of other programs. Errors: those of Config::read() and Config::finish().
Result<NetworkSettings> read_network_settings(const std::filesystem::path& site);
Result<NetworkSettings> parse_network_settings(std::string_view text, const std::string& name);

/// Returns the table as site.toml has it, without the values that are the defaults; empty if all are.
/// Precondition: there is no mistake.
[[nodiscard]] std::string network_toml(const NetworkSettings& network);

}  // namespace cyclorama
