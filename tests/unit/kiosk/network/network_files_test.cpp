// SPDX-License-Identifier: Apache-2.0
#include "kiosk/network/network_files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>

#include "common/base/file.h"

namespace cyclorama::network {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

class NetworkFiles : public testing::Test {
 protected:
  NetworkFiles() {
    std::string pattern = fs::temp_directory_path() / "network_files_XXXXXX";
    folder_ = ::mkdtemp(pattern.data());
  }
  ~NetworkFiles() override { fs::remove_all(folder_); }

  std::string content(const NetworkSettings& network, const std::string& name) {
    const auto files = network_files(network, {folder_});
    EXPECT_TRUE(files) << files.error().message();
    for (const NetworkFile& file : *files) {
      if (file.path.filename() == name) return file.content;
    }
    return "";
  }
  void write(const std::string& name, std::string_view text) {
    ASSERT_TRUE(write_file_atomically(folder_ / name, text));
  }

  fs::path folder_;
};

NetworkSettings fixed() {
  NetworkSettings network;
  network.interface = "eno1";
  network.ipv4 = "static";
  network.ipv4_address = "192.0.2.7/24";
  network.ipv4_gateway = "192.0.2.1";
  network.dns = {"192.0.2.53"};
  network.time_servers = {"time.example", "192.0.2.5"};
  return network;
}

TEST_F(NetworkFiles, leave_the_image_its_own_network_by_default) {
  EXPECT_THAT(*network_files({}, {folder_}), IsEmpty());
  NetworkSettings proxied;
  proxied.proxy = "http://proxy.example:3128";
  EXPECT_EQ(network_files(proxied, {folder_})->size(), 1U) << "a proxy changes no cable";
  EXPECT_THAT(content(proxied, "proxy.env"), HasSubstr("\nhttps_proxy=http://proxy.example:3128\n"));
}

TEST_F(NetworkFiles, give_a_cable_its_address_and_servers) {
  const std::string cable = content(fixed(), "20-museum-cable.network");
  for (const char* const line : {"[Match]\nName=eno1\n", "\nDHCP=no\n", "\nAddress=192.0.2.7/24\n",
                                 "\nGateway=192.0.2.1\n", "\nDNS=192.0.2.53\n", "\nNTP=time.example 192.0.2.5\n",
                                 "\nIPv6AcceptRA=yes\n", "[IPv6AcceptRA]\nUseDNS=no\n", "\nMulticastDNS=yes\n"})
    EXPECT_THAT(cable, HasSubstr(line));
}

TEST_F(NetworkFiles, put_addresses_on_the_vlan_and_none_on_its_cable) {
  NetworkSettings network = fixed();
  network.vlan = 42;
  EXPECT_THAT(content(network, "20-museum-vlan.netdev"), HasSubstr("Kind=vlan\n[VLAN]\nId=42\n"));
  EXPECT_THAT(content(network, "20-museum-vlan.network"), HasSubstr("Address=192.0.2.7/24"));
  const std::string cable = content(network, "20-museum-cable.network");
  EXPECT_THAT(cable, HasSubstr("VLAN=museum-vlan"));
  EXPECT_THAT(cable, Not(HasSubstr("192.0.2.7")));
}

TEST_F(NetworkFiles, hold_the_login_so_that_no_password_can_end_its_value) {
  NetworkSettings network;
  network.interface = "eno1";
  network.login = {"peap", "kiosk", "password", "radius.pem", "radius.example", "", ""};
  write("password", "a\"}\nb");
  write("radius.pem", "x");
  const std::string conf = content(network, "login.conf");
  EXPECT_THAT(conf, HasSubstr("\n  password=61227d\n")) << "the first line, in hexadecimal";
  EXPECT_THAT(conf, HasSubstr("\n  identity=6b696f736b\n"));
  EXPECT_THAT(conf, HasSubstr("ca_cert=\"" + (folder_ / "radius.pem").string() + "\""));
  EXPECT_THAT(content(network, "login.env"), HasSubstr("\nINTERFACE=eno1\n"));
  fs::remove(folder_ / "radius.pem");
  const auto missing = network_files(network, {folder_});
  ASSERT_FALSE(missing);
  EXPECT_THAT(missing.error().message(), HasSubstr("[network.login] authority: there is no file 'radius.pem'"));
}

TEST_F(NetworkFiles, change_only_what_differs_and_go_with_their_settings) {
  NetworkSettings network = fixed();
  network.login = {"peap", "kiosk", "password", "radius.pem", "", "", ""};
  write("password", "secret");
  write("radius.pem", "x");
  const fs::path run = folder_ / "run";
  const auto files = network_files(network, {folder_});
  ASSERT_TRUE(files);
  EXPECT_THAT(*put_network_files(*files, run), ElementsAre("20-museum-cable.network", "login.conf", "login.env"));
  EXPECT_THAT(*put_network_files(*files, run), IsEmpty());
  struct stat secret {};
  struct stat open {};
  ASSERT_EQ(::stat((run / "cyclorama-8021x").c_str(), &secret), 0);
  ASSERT_EQ(::stat((run / "systemd/network/20-museum-cable.network").c_str(), &open), 0);
  EXPECT_EQ(secret.st_mode & 0777U, 0700U);
  EXPECT_EQ(open.st_mode & 0777U, 0644U) << "systemd-networkd is not root";
  EXPECT_THAT(*put_network_files({}, run), ElementsAre("20-museum-cable.network", "login.conf", "login.env"));
  EXPECT_TRUE(fs::is_empty(run / "systemd/network"));
}

}  // namespace
}  // namespace cyclorama::network
