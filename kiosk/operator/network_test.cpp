// SPDX-License-Identifier: Apache-2.0
#include "kiosk/operator/network_test.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <netdb.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <memory>
#include <optional>

#include "common/base/address.h"
#include "common/base/text.h"
#include "common/base/unique_fd.h"

namespace cyclorama::operations {
namespace {

constexpr int kTries = 5;
constexpr double kFarAway_ms = 100.0;
constexpr const char* kCable =
    "See that the network's cable is in and its lamp is lit; ask the museum's network people.";

using Addresses = std::unique_ptr<addrinfo, void (*)(addrinfo*)>;

/// Returns the families of this computer's outside addresses: "IPv6", "IPv4", both, or nothing.
std::string families() {
  ifaddrs* list = nullptr;
  if (::getifaddrs(&list) != 0) return "";
  const std::unique_ptr<ifaddrs, void (*)(ifaddrs*)> owner(list, ::freeifaddrs);
  bool has_6 = false;
  bool has_4 = false;
  for (const ifaddrs* one = list; one != nullptr; one = one->ifa_next) {
    if (one->ifa_addr == nullptr || (one->ifa_flags & IFF_LOOPBACK) != 0 || (one->ifa_flags & IFF_UP) == 0) continue;
    if (one->ifa_addr->sa_family == AF_INET) has_4 = true;
    if (one->ifa_addr->sa_family != AF_INET6) continue;
    sockaddr_in6 address{};
    std::memcpy(&address, one->ifa_addr, sizeof address);
    has_6 = has_6 || !IN6_IS_ADDR_LINKLOCAL(&address.sin6_addr);
  }
  return has_6 && has_4 ? "IPv6 and IPv4" : has_6 ? "IPv6" : has_4 ? "IPv4" : "";
}

/// Returns the time that a connection takes; nothing if it fails.
std::optional<Duration> connected(const addrinfo& to, Duration longest, int* ret_errno) {
  const UniqueFd fd(::socket(to.ai_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  *ret_errno = errno;
  if (!fd.is_open()) return std::nullopt;
  const TimePoint begin = SteadyClock().now();
  if (::connect(fd.get(), to.ai_addr, to.ai_addrlen) != 0 && errno != EINPROGRESS) {
    *ret_errno = errno;
    return std::nullopt;
  }
  pollfd waiting{fd.get(), POLLOUT, 0};
  const auto milliseconds = std::chrono::duration_cast<std::chrono::milliseconds>(longest).count();
  if (::poll(&waiting, 1, static_cast<int>(milliseconds)) <= 0) {
    *ret_errno = ETIMEDOUT;
    return std::nullopt;
  }
  socklen_t size = sizeof *ret_errno;
  ::getsockopt(fd.get(), SOL_SOCKET, SO_ERROR, ret_errno, &size);
  if (*ret_errno != 0) return std::nullopt;
  return SteadyClock().now() - begin;
}

const char* remedy_for(int error) {
  switch (error) {
    case ECONNREFUSED:
      return "The farm's computer answers, but its program does not run: tell those who run the farm.";
    case ENETUNREACH:
    case EHOSTUNREACH:
    case EADDRNOTAVAIL:
      return "This network knows no way there. The farm is reached by IPv6: ask the museum's network people for it.";
    default:
      return "Nobody answers. Ask the museum's network people whether a firewall stops it, and those who run the farm "
             "whether it is on.";
  }
}

Check farm_check(const std::string& coordinator, std::size_t number, Duration longest) {
  Check check{fmt::format("farm-{}", number), fmt::format("Farm {}", printable(coordinator, 100)), CheckLevel::kFault,
              "", ""};
  const auto address = parse_address(coordinator);
  if (!address) {
    check.sentence = address.error().message();
    check.remedy = "Correct [farm] coordinators in site.toml.";
    return check;
  }
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  const int failed = ::getaddrinfo(address->host.c_str(), std::to_string(address->port).c_str(), &hints, &found);
  if (failed != 0 || found == nullptr) {
    check.sentence = fmt::format("Its name cannot be found: {}.", ::gai_strerror(failed));
    check.remedy = "See that the name is right in site.toml; else ask the museum's network people for a name server.";
    return check;
  }
  const Addresses owner(found, ::freeaddrinfo);
  int error = 0;
  for (const addrinfo* to = found; to != nullptr; to = to->ai_next) {
    std::vector<double> times_ms;
    for (int i = 0; i < kTries; ++i) {
      const auto time = connected(*to, longest, &error);
      if (!time) break;
      times_ms.push_back(to_milliseconds(*time));
    }
    if (times_ms.size() < kTries) continue;
    std::sort(times_ms.begin(), times_ms.end());
    const double middle = times_ms[kTries / 2];
    check.level = middle > kFarAway_ms ? CheckLevel::kWarning : CheckLevel::kOk;
    check.sentence =
        fmt::format("It answers over {}, in {:.1f} ms ({:.1f} to {:.1f}).", to->ai_family == AF_INET6 ? "IPv6" : "IPv4",
                    middle, times_ms.front(), times_ms.back());
    if (check.level != CheckLevel::kOk)
      check.remedy = "The round trip is long: turning is still smooth, but walking responds late.";
    return check;
  }
  check.sentence = fmt::format("It cannot be reached: {}.", std::strerror(error));
  check.remedy = remedy_for(error);
  return check;
}

}  // namespace

std::vector<Check> test_network(const std::vector<std::string>& farm, const MachineFacts& machine, Duration longest) {
  std::vector<Check> checks;
  const std::string have = families();
  const bool is_far =
      std::any_of(farm.begin(), farm.end(), [](const std::string& coordinator) { return !is_loopback(coordinator); });
  checks.push_back({"address", "This computer's address", have.empty() && is_far ? CheckLevel::kFault : CheckLevel::kOk,
                    have.empty() ? "It has none on any network." : fmt::format("It has one of {}.", have),
                    have.empty() && is_far ? kCable : ""});
  for (std::size_t i = 0; i < farm.size(); ++i) {
    if (!is_unix_socket(farm[i])) checks.push_back(farm_check(farm[i], i + 1, longest));
  }
  if (farm.empty()) {
    checks.push_back({"farm", "Farm", CheckLevel::kWarning, "No farm is named in the settings.",
                      "Name it in site.toml: [farm] coordinators = [\"[2001:db8::1]:7401\"]."});
  }
  if (machine.is_clock_set) {
    const bool is_set = *machine.is_clock_set;
    checks.push_back({"time", "Time server", is_set ? CheckLevel::kOk : CheckLevel::kWarning,
                      is_set ? "It has set the clock." : "None has set the clock since the start.",
                      is_set ? "" : "Ask the museum's network people to let time (NTP, port 123) through."});
  }
  return checks;
}

}  // namespace cyclorama::operations
