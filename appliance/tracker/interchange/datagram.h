// SPDX-License-Identifier: Apache-2.0
/// Datagrams over UDP, by IPv6 or IPv4. Nothing of it blocks: who is not there does not get them.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "common/base/unique_fd.h"

namespace cyclorama::tracker {

/// Thread-bound.
class DatagramSender {
 public:
  /// kInvalidArgument  not HOST:PORT, or a host that nobody knows.     kSystem
  static Result<DatagramSender> open(const std::string& address);
  /// What the network does not take now is lost, as any datagram may be.
  void send(std::span<const std::byte> datagram) const;

 private:
  explicit DatagramSender(UniqueFd fd) : fd_(std::move(fd)) {}
  UniqueFd fd_;
};

/// Thread-bound.
class DatagramReceiver {
 public:
  /// "[::1]:3883", "[::]:9000". kInvalidArgument  as above.     kBusy  somebody else has the port.     kSystem
  static Result<DatagramReceiver> open(const std::string& address);
  /// The next one that is there; nothing: none is, or it was larger than kMaxDatagramBytes.
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
