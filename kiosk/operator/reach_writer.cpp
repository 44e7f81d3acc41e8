// SPDX-License-Identifier: Apache-2.0
#include "kiosk/operator/reach_writer.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <netinet/in.h>
#include <unistd.h>

#include <array>
#include <cstring>
#include <memory>
#include <string_view>
#include <utility>

#include "common/base/file.h"
#include "common/base/text.h"
#include "kiosk/operator/login_checks.h"

namespace cyclorama::operations {
namespace {

constexpr std::size_t kMaxName = 60;
constexpr Duration kWallCodeLife = std::chrono::minutes(10);

std::string host_name() {
  std::array<char, 256> name{};
  return ::gethostname(name.data(), name.size() - 1) == 0 ? std::string(name.data()) : "";
}

std::string page_address(const std::string& host, int port) {
  const bool is_v6 = host.find(':') != std::string::npos;
  return is_v6 ? fmt::format("https://[{}]:{}/", host, port) : fmt::format("https://{}:{}/", host, port);
}

}  // namespace

std::vector<std::string> outside_addresses() {
  ifaddrs* list = nullptr;
  if (::getifaddrs(&list) != 0) return {};
  const std::unique_ptr<ifaddrs, void (*)(ifaddrs*)> owner(list, ::freeifaddrs);
  std::vector<std::string> four;
  std::vector<std::string> six;
  for (const ifaddrs* one = list; one != nullptr; one = one->ifa_next) {
    if (one->ifa_addr == nullptr || (one->ifa_flags & IFF_LOOPBACK) != 0 || (one->ifa_flags & IFF_UP) == 0) continue;
    std::array<char, INET6_ADDRSTRLEN> text{};
    if (one->ifa_addr->sa_family == AF_INET) {
      sockaddr_in address{};
      std::memcpy(&address, one->ifa_addr, sizeof address);
      if (ntohl(address.sin_addr.s_addr) >> 16 == 0xA9FE) continue;  // 169.254.0.0/16.
      if (::inet_ntop(AF_INET, &address.sin_addr, text.data(), text.size()) != nullptr) four.emplace_back(text.data());
    } else if (one->ifa_addr->sa_family == AF_INET6) {
      sockaddr_in6 address{};
      std::memcpy(&address, one->ifa_addr, sizeof address);
      if (IN6_IS_ADDR_LINKLOCAL(&address.sin6_addr)) continue;
      if (::inet_ntop(AF_INET6, &address.sin6_addr, text.data(), text.size()) != nullptr) six.emplace_back(text.data());
    }
  }
  four.insert(four.end(), six.begin(), six.end());
  return four;
}

std::string outside_page(int port) {
  const std::vector<std::string> all = outside_addresses();
  return all.empty() ? "" : page_address(all.front(), port);
}

Status ReachWriter::write(bool answers, TimePoint now) {
  if (sessions_ != nullptr && (reach_.wall_code.empty() || now - code_from_ >= kWallCodeLife)) {
    TRY_ASSIGN(reach_.wall_code, sessions_->renew_wall_code());
    code_from_ = now;
  }
  const std::string name = name_of(options_.museum);
  reach_.name = printable(name.empty() ? host_name() : name, kMaxName);
  reach_.version = CYCLORAMA_VERSION;
  reach_.language = language_of(options_.museum);
  reach_.fingerprint = options_.fingerprint;
  reach_.has_pin = sessions_ == nullptr || has_pin(options_.museum);
  reach_.addresses.clear();
  for (const std::string& address : outside_addresses()) {
    reach_.addresses.push_back(page_address(address, options_.port));
  }
  if (answers && !reach_.addresses.empty()) reach_.answered_at = now;
  // After the addresses, since a name takes longer to be found, where it is found at all.
  const std::string host = options_.has_mdns && !reach_.addresses.empty() ? host_name() : "";
  if (!host.empty()) reach_.addresses.push_back(fmt::format("https://{}.local:{}/", host, options_.port));
  return write_file_atomically(options_.file, std::string_view(to_json(reach_)));
}

}  // namespace cyclorama::operations
