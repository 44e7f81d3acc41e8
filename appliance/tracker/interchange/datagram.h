// SPDX-License-Identifier: Apache-2.0
/// UDP datagrams over IPv6 or IPv4. No call blocks; a datagram to an absent receiver is lost.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "common/base/unique_fd.h"

namespace cyclorama::tracker {

/// Sends datagrams to one address. Thread-bound.
class DatagramSender {
 public:
  /// Errors: kInvalidArgument if the address is not HOST:PORT, or the host is unknown; kSystem for other failures.
  static Result<DatagramSender> open(const std::string& address);
  /// Sends a datagram. It is lost if the network does not take it now, as any datagram may be.
  void send(std::span<const std::byte> datagram) const;

 private:
  explicit DatagramSender(UniqueFd fd) : fd_(std::move(fd)) {}
  UniqueFd fd_;
};

/// Receives datagrams at one port. Thread-bound.
class DatagramReceiver {
 public:
  /// Listens at an address such as "[::1]:3883" or "[::]:9000". Errors: those of DatagramSender::open(); kBusy if the
  /// port is taken.
  static Result<DatagramReceiver> open(const std::string& address);
  /// Returns the next datagram; empty if there is none, or it exceeds kMaxDatagramBytes.
  std::optional<std::vector<std::byte>> receive() const;
  static constexpr std::size_t kMaxDatagramBytes = 65535;
  /// For poll().
  [[nodiscard]] int fd() const { return fd_.get(); }
  [[nodiscard]] int port() const;

 private:
  explicit DatagramReceiver(UniqueFd fd) : fd_(std::move(fd)) {}
  UniqueFd fd_;
};

}  // namespace cyclorama::tracker
