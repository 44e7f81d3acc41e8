// SPDX-License-Identifier: Apache-2.0
#include "common/network/network_settings.h"

#include <fmt/format.h>

#include "common/config/config.h"

namespace cyclorama {
namespace {

constexpr Range kVlans{0, 4094};

NetworkSettings settings_in(ConfigTable* table) {
  NetworkSettings network;
  network.interface = table->text("interface", network.interface);
  network.vlan = table->integer("vlan", kVlans, network.vlan);
  network.ipv4 = table->choice("ipv4", {"dhcp", "static", "off"}, network.ipv4);
  network.ipv4_address = table->text("ipv4_address", "");
  network.ipv4_gateway = table->text("ipv4_gateway", "");
  network.ipv6 = table->choice("ipv6", {"automatic", "static", "off"}, network.ipv6);
  network.ipv6_address = table->text("ipv6_address", "");
  network.ipv6_gateway = table->text("ipv6_gateway", "");
  network.dns = table->texts("dns", std::vector<std::string>{});
  network.time_servers = table->texts("time_servers", std::vector<std::string>{});
  network.proxy = table->text("proxy", "");
  return network;
}

PortLogin login_in(ConfigTable* table) {
  PortLogin login;
  login.method = table->choice("method", {"peap", "ttls", "tls"});
  login.identity = table->text("identity", "");
  login.password_file = table->text("password_file", "");
  login.authority = table->text("authority", "");
  login.server_name = table->text("server_name", "");
  login.certificate = table->text("certificate", "");
  login.key = table->text("key", "");
  return login;
}

Result<NetworkSettings> settings_of(Config config) {
  ConfigTable root = config.root();
  for (const char* const others : {"display", "farm", "hours", "picture", "tour", "update", "walk"})
    static_cast<void>(root.has(others));
  if (!root.has("network")) {
    TRY(config.finish());
    return NetworkSettings{};
  }
  ConfigTable table = root.table("network");
  NetworkSettings network = settings_in(&table);
  if (table.has("login")) {
    ConfigTable login = table.table("login");
    network.login = login_in(&login);
  }
  // A value that is no text at all, or no number, is reported instead of what follows from it.
  TRY(config.finish());
  for (const NetworkMistake& mistake : mistakes_of(network)) {
    constexpr std::string_view kLogin = "login.";
    if (mistake.key.starts_with(kLogin)) {
      table.table("login").refuse(mistake.key.substr(kLogin.size()), mistake.sentence);
    } else {
      table.refuse(mistake.key, mistake.sentence);
    }
  }
  TRY(config.finish());
  return network;
}

std::string list_of(const std::vector<std::string>& texts) {
  std::string list;
  for (const std::string& text : texts) list += fmt::format("{}\"{}\"", list.empty() ? "" : ", ", text);
  return "[" + list + "]";
}

}  // namespace

Result<NetworkSettings> read_network_settings(const std::filesystem::path& site) {
  TRY_ASSIGN(Config config, Config::read(site));
  return settings_of(std::move(config));
}

Result<NetworkSettings> parse_network_settings(std::string_view text, const std::string& name) {
  TRY_ASSIGN(Config config, Config::parse(text, name));
  return settings_of(std::move(config));
}

std::string network_toml(const NetworkSettings& network) {
  const NetworkSettings usual;
  if (network == usual) return "";
  std::string text = "[network]\n";
  // No value has a quotation mark or a backslash: mistakes_of() refuses them.
  const auto add = [&](const char* key, const std::string& value, const std::string& omitted) {
    if (value != omitted) text += fmt::format("{} = \"{}\"\n", key, value);
  };
  add("interface", network.interface, "");
  if (network.vlan != 0) text += fmt::format("vlan = {}\n", network.vlan);
  add("ipv4", network.ipv4, usual.ipv4);
  add("ipv4_address", network.ipv4_address, "");
  add("ipv4_gateway", network.ipv4_gateway, "");
  add("ipv6", network.ipv6, usual.ipv6);
  add("ipv6_address", network.ipv6_address, "");
  add("ipv6_gateway", network.ipv6_gateway, "");
  if (!network.dns.empty()) text += fmt::format("dns = {}\n", list_of(network.dns));
  if (!network.time_servers.empty()) text += fmt::format("time_servers = {}\n", list_of(network.time_servers));
  add("proxy", network.proxy, "");
  if (network.login.method.empty()) return text;
  text += "[network.login]\n";
  add("method", network.login.method, "");
  add("identity", network.login.identity, "");
  add("password_file", network.login.password_file, "");
  add("authority", network.login.authority, "");
  add("server_name", network.login.server_name, "");
  add("certificate", network.login.certificate, "");
  add("key", network.login.key, "");
  return text;
}

}  // namespace cyclorama
