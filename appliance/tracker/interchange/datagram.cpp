// SPDX-License-Identifier: Apache-2.0
#include "appliance/tracker/interchange/datagram.h"

#include <fmt/format.h>
#include <netdb.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <cerrno>
#include <memory>
#include <utility>

#include "common/base/address.h"

namespace cyclorama::tracker {
namespace {

struct FreeAddresses {
  void operator()(addrinfo* addresses) const { freeaddrinfo(addresses); }
};
using Addresses = std::unique_ptr<addrinfo, FreeAddresses>;

Result<Addresses> resolve(const std::string& text) {
  TRY_ASSIGN(const Address address, parse_address(text));
  addrinfo hints{};
  hints.ai_socktype = SOCK_DGRAM;
  addrinfo* found = nullptr;
  const int code = getaddrinfo(address.host.c_str(), std::to_string(address.port).c_str(), &hints, &found);
  if (code != 0)
    return Error(ErrorCode::kInvalidArgument, fmt::format("'{}' is no address: {}", text, gai_strerror(code)));
  return Addresses(found);
}

Result<UniqueFd> make_socket(const addrinfo& address, const std::string& text) {
  UniqueFd fd(::socket(address.ai_family, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  if (fd.get() < 0) return Error::from_errno(fmt::format("opening a socket for '{}'", text));
  return fd;
}

}  // namespace

Result<DatagramSender> DatagramSender::open(const std::string& address) {
  TRY_ASSIGN(const Addresses addresses, resolve(address));
  TRY_ASSIGN(UniqueFd fd, make_socket(*addresses, address));
  if (::connect(fd.get(), addresses->ai_addr, addresses->ai_addrlen) != 0)
    return Error::from_errno(fmt::format("sending to '{}'", address));
  return DatagramSender(std::move(fd));
}

void DatagramSender::send(std::span<const std::byte> datagram) const {
  if (!datagram.empty()) static_cast<void>(::send(fd_.get(), datagram.data(), datagram.size(), MSG_NOSIGNAL));
}

Result<DatagramReceiver> DatagramReceiver::open(const std::string& address) {
  TRY_ASSIGN(const Addresses addresses, resolve(address));
  TRY_ASSIGN(UniqueFd fd, make_socket(*addresses, address));
  if (::bind(fd.get(), addresses->ai_addr, addresses->ai_addrlen) != 0)
    return Error::from_errno(fmt::format("listening at '{}'", address));
  return DatagramReceiver(std::move(fd));
}

std::optional<std::vector<std::byte>> DatagramReceiver::receive() const {
  std::vector<std::byte> bytes(kMaxDatagramBytes);
  const ssize_t size = ::recv(fd_.get(), bytes.data(), bytes.size(), MSG_TRUNC);
  if (size < 0 || static_cast<std::size_t>(size) > bytes.size()) return std::nullopt;
  bytes.resize(static_cast<std::size_t>(size));
  return bytes;
}

int DatagramReceiver::port() const {
  sockaddr_storage storage{};
  socklen_t length = sizeof storage;
  if (::getsockname(fd_.get(), reinterpret_cast<sockaddr*>(&storage), &length) != 0) return 0;
  const bool is_v6 = storage.ss_family == AF_INET6;
  return ntohs(is_v6 ? reinterpret_cast<const sockaddr_in6&>(storage).sin6_port
                     : reinterpret_cast<const sockaddr_in&>(storage).sin_port);
}

}  // namespace cyclorama::tracker
