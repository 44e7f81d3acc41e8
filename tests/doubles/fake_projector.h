// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>

#include <array>
#include <atomic>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "common/base/check.h"
#include "common/base/unique_fd.h"

namespace cyclorama {

/// The network port of a projector, on this machine: sends a greeting, reads one line, and answers. Thread-safe.
class FakeProjector {
 public:
  /// Returns the answer to a line, which has no carriage return. An empty answer closes the connection.
  using Answer = std::function<std::string(const std::string& line)>;
  FakeProjector(std::string greeting, Answer answer) : greeting_(std::move(greeting)), answer_(std::move(answer)) {
    listener_ = UniqueFd(::socket(AF_INET6, SOCK_STREAM | SOCK_CLOEXEC, 0));
    sockaddr_in6 here{};
    here.sin6_family = AF_INET6;
    here.sin6_addr = in6addr_loopback;
    socklen_t size = sizeof here;
    CHECK(::bind(listener_.get(), reinterpret_cast<sockaddr*>(&here), size) == 0);
    CHECK(::listen(listener_.get(), 4) == 0);
    CHECK(::getsockname(listener_.get(), reinterpret_cast<sockaddr*>(&here), &size) == 0);
    port_ = ntohs(here.sin6_port);
    thread_ = std::jthread([this](const std::stop_token& stop) { serve(stop); });
  }
  [[nodiscard]] int port() const { return port_; }
  [[nodiscard]] std::vector<std::string> heard() const {
    const std::lock_guard lock(mutex_);
    return heard_;
  }

 private:
  void serve(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      pollfd entry{listener_.get(), POLLIN, 0};
      if (::poll(&entry, 1, 10) <= 0) continue;
      const UniqueFd client(::accept4(listener_.get(), nullptr, nullptr, SOCK_CLOEXEC));
      send(client, greeting_);
      std::string line;
      for (char c = 0; ::recv(client.get(), &c, 1, 0) == 1 && c != '\r';) line += c;
      if (line.empty()) continue;
      {
        const std::lock_guard lock(mutex_);
        heard_.push_back(line);
      }
      send(client, answer_(line));
    }
  }
  static void send(const UniqueFd& client, const std::string& text) {
    [[maybe_unused]] const auto n = ::send(client.get(), text.data(), text.size(), MSG_NOSIGNAL);
  }

  std::string greeting_;
  Answer answer_;
  UniqueFd listener_;
  int port_ = 0;
  mutable std::mutex mutex_;
  std::vector<std::string> heard_;
  std::jthread thread_;  // Last member, because the thread uses all others.
};

}  // namespace cyclorama
