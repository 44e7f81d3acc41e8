// SPDX-License-Identifier: Apache-2.0
#include "common/network/network_settings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace cyclorama {
namespace {

using testing::HasSubstr;

NetworkSettings fixed() {
  NetworkSettings network;
  network.interface = "eno1";
  network.ipv4 = "static";
  network.ipv4_address = "192.0.2.7/24";
  network.ipv4_gateway = "192.0.2.1";
  network.ipv6 = "static";
  network.ipv6_address = "2001:db8::7/64";
  network.ipv6_gateway = "fe80::1";
  network.dns = {"192.0.2.53", "2001:db8::53"};
  network.time_servers = {"time.museum.example", "192.0.2.5"};
  network.proxy = "http://proxy.museum.example:3128";
  return network;
}

NetworkSettings with_login(const std::string& method) {
  NetworkSettings network;
  network.interface = "eno1";
  network.login.method = method;
  network.login.identity = "kiosk@museum.example";
  network.login.authority = "radius.pem";
  if (method == "tls") {
    network.login.certificate = "8021x/kiosk.pem";
    network.login.key = "8021x/kiosk-key.pem";
  } else {
    network.login.password_file = "8021x-password";
  }
  return network;
}

/// Returns "KEY SENTENCE" of the only mistake.
std::string mistake(const NetworkSettings& network) {
  const auto mistakes = mistakes_of(network);
  EXPECT_LE(mistakes.size(), 1U) << mistakes[0].key << " and " << mistakes[1].key;
  return mistakes.empty() ? "" : mistakes[0].key + " " + mistakes[0].sentence;
}

TEST(NetworkSettings, of_all_kinds_are_accepted) {
  EXPECT_EQ(mistake(NetworkSettings{}), "");
  EXPECT_EQ(mistake(fixed()), "");
  for (const char* const method : {"peap", "ttls", "tls"}) EXPECT_EQ(mistake(with_login(method)), "");
  NetworkSettings only_6;
  only_6.ipv4 = "off";
  EXPECT_EQ(mistake(only_6), "") << "a museum without IPv4";
  NetworkSettings closed = fixed();
  closed.ipv4_gateway = closed.ipv6_gateway = "";
  EXPECT_EQ(mistake(closed), "") << "a network without a gateway";
  NetworkSettings pair = fixed();
  pair.ipv4_address = "192.0.2.0/31";
  EXPECT_EQ(mistake(pair), "") << "both addresses of a /31 are computers'";
}

struct Wrong {
  const char* name;
  void (*spoil)(NetworkSettings*);
  const char* expected;
};

TEST(NetworkSettings, have_one_clear_sentence_for_each_wrong_value) {
  const std::vector<Wrong> cases{
      {"no length", [](auto* n) { n->ipv4_address = "192.0.2.7"; }, "ipv4_address is '192.0.2.7', which is no such"},
      {"no address", [](auto* n) { n->ipv4_address = ""; }, "ipv4_address is missing"},
      {"IPv6 for IPv4", [](auto* n) { n->ipv4_address = "2001:db8::7/64"; }, "ipv4_address is '2001:db8::7/64'"},
      {"length 33", [](auto* n) { n->ipv4_address = "192.0.2.7/33"; }, "ipv4_address is '192.0.2.7/33'"},
      {"octal", [](auto* n) { n->ipv4_address = "192.0.02.7/24"; }, "ipv4_address is '192.0.02.7/24'"},
      {"network", [](auto* n) { n->ipv4_address = "192.0.2.0/24"; }, "which is the network's own"},
      {"broadcast", [](auto* n) { n->ipv4_address = "192.0.2.255/24"; }, "which calls all computers"},
      {"multicast",
       [](auto* n) {
         n->ipv4_address = "224.0.0.7/24";
         n->ipv4_gateway = "";
       },
       "no computer may have"},
      {"link local", [](auto* n) { n->ipv6_address = "fe80::7/64"; }, "valid on its cable only"},
      {"unspecified", [](auto* n) { n->ipv6_address = "::/64"; }, "no computer may have"},
      {"scope", [](auto* n) { n->ipv6_address = "2001:db8::7%eno1/64"; }, "ipv6_address is '2001:db8::7%eno1/64'"},
      {"far router", [](auto* n) { n->ipv4_gateway = "192.0.3.1"; }, "ipv4_gateway is '192.0.3.1', which is not in"},
      {"own router", [](auto* n) { n->ipv4_gateway = "192.0.2.7"; }, "this computer's own address"},
      {"router's name", [](auto* n) { n->ipv4_gateway = "router"; }, "ipv4_gateway is 'router', which is no IPv4"},
      {"DNS by name", [](auto* n) { n->dns = {"dns.example"}; }, "dns has 'dns.example'"},
      {"no DNS", [](auto* n) { n->dns = {}; }, "dns is missing"},
      {"four DNS",
       [](auto* n) {
         n->dns = {"192.0.2.1", "192.0.2.2", "192.0.2.3", "192.0.2.4"};
       },
       "dns has more"},
      {"time", [](auto* n) { n->time_servers = {"192.0.2"}; }, "time_servers has '192.0.2'"},
      {"time with a space", [](auto* n) { n->time_servers = {"a b"}; }, "time_servers has 'a b'"},
      {"no cable", [](auto* n) { n->interface = ""; }, "interface is missing"},
      {"long cable", [](auto* n) { n->interface = "eno1234567890123"; }, "interface is 'eno1234567890123'"},
      {"section", [](auto* n) { n->interface = "e]\n[x"; }, "interface is 'e"},
      {"loopback", [](auto* n) { n->interface = "lo"; }, "interface is 'lo', which is no cable"},
      {"VLAN 4095", [](auto* n) { n->vlan = 4095; }, "vlan is 4095"},
      {"proxy without a port", [](auto* n) { n->proxy = "http://proxy"; }, "proxy is 'http://proxy'"},
      {"proxy by https", [](auto* n) { n->proxy = "https://proxy:3128"; }, "proxy is 'https://proxy:3128'"},
      {"closed proxy", [](auto* n) { n->proxy = "http://proxy:80"; }, "proxy has the port 80"},
      {"unused address",
       [](auto* n) {
         n->ipv4 = "dhcp";
         n->ipv4_gateway = "";
       },
       "ipv4_address belongs to a fixed"},
      {"unknown way", [](auto* n) { n->ipv6 = "slaac"; }, "ipv6 is 'slaac'; choose automatic, static or off"},
  };
  for (const Wrong& wrong : cases) {
    NetworkSettings network = fixed();
    wrong.spoil(&network);
    EXPECT_THAT(mistake(network), HasSubstr(wrong.expected)) << wrong.name;
  }
  NetworkSettings nothing;
  nothing.ipv4 = nothing.ipv6 = "off";
  nothing.dns = {"192.0.2.53"};
  EXPECT_THAT(mistake(nothing), HasSubstr("ipv4 is off like ipv6"));
}

TEST(NetworkSettings, name_what_a_login_lacks) {
  const std::vector<Wrong> cases{
      {"method", [](auto* n) { n->login.method = "md5"; }, "login.method is 'md5'"},
      {"identity", [](auto* n) { n->login.identity = ""; }, "login.identity is missing"},
      {"quoted identity", [](auto* n) { n->login.identity = "a\"b"; }, "login.identity has characters"},
      {"authority", [](auto* n) { n->login.authority = ""; }, "login.authority is missing; peap needs it"},
      {"password", [](auto* n) { n->login.password_file = ""; }, "login.password_file is missing"},
      {"outside", [](auto* n) { n->login.authority = "../../etc/shadow"; }, "login.authority names no file"},
      {"absolute", [](auto* n) { n->login.authority = "/etc/shadow"; }, "login.authority names no file"},
      {"key", [](auto* n) { n->login.key = "k.pem"; }, "login.key is not used by peap"},
      {"server", [](auto* n) { n->login.server_name = "a\"b"; }, "login.server_name is 'a\"b'"},
  };
  for (const Wrong& wrong : cases) {
    NetworkSettings network = with_login("peap");
    wrong.spoil(&network);
    EXPECT_THAT(mistake(network), HasSubstr(wrong.expected)) << wrong.name;
  }
}

TEST(NetworkSettings, are_the_same_after_a_file) {
  for (const NetworkSettings& network : {NetworkSettings{}, fixed(), with_login("tls"), with_login("ttls")}) {
    const std::string text = network_toml(network);
    const auto read = parse_network_settings(text, "site.toml");
    ASSERT_TRUE(read) << read.error().message() << "\n" << text;
    EXPECT_EQ(*read, network) << text;
  }
  EXPECT_EQ(network_toml({}), "");
}

TEST(NetworkSettings, are_refused_with_file_line_and_remedy) {
  const auto read = [](const std::string& text) { return parse_network_settings(text, "site.toml"); };
  const auto wrong = read("[farm]\n[network]\ninterface = \"eno1\"\nipv4 = \"static\"\nipv4_address = \"192.0.2\"\n");
  ASSERT_FALSE(wrong);
  EXPECT_THAT(wrong.error().message(), HasSubstr("site.toml:5: network.ipv4_address: is '192.0.2'"));
  const auto login = read("[network]\ninterface = \"eno1\"\n[network.login]\nmethod = \"peap\"\nidentity = \"a\"\n");
  ASSERT_FALSE(login);
  EXPECT_THAT(login.error().message(), HasSubstr("password_file: is missing; peap needs it"));
  const auto unknown = read("[network]\nvlna = 7\n");
  ASSERT_FALSE(unknown);
  EXPECT_THAT(unknown.error().message(), HasSubstr("network.vlna: is not a setting; did you mean 'vlan'"));
}

}  // namespace
}  // namespace cyclorama
