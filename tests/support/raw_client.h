// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/time.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <string>
#include <string_view>

#include "common/base/check.h"
#include "common/base/unique_fd.h"

namespace cyclorama {

/// A client of a test that sends any bytes it likes to an HTTP server.
class RawClient {
 public:
  RawClient(const char* address, int port) : socket_(::socket(is_v6(address) ? AF_INET6 : AF_INET, SOCK_STREAM, 0)) {
    CHECK(socket_.is_open());
    const timeval timeout{20, 0};
    CHECK(::setsockopt(socket_.get(), SOL_SOCKET, SO_RCVTIMEO, &timeout, sizeof timeout) == 0);
    sockaddr_in6 six{};
    sockaddr_in four{};
    six.sin6_family = AF_INET6;
    six.sin6_port = htons(static_cast<std::uint16_t>(port));
    four.sin_family = AF_INET;
    four.sin_port = six.sin6_port;
    int connected = -1;
    if (is_v6(address)) {
      CHECK(::inet_pton(AF_INET6, address, &six.sin6_addr) == 1);
      connected = ::connect(socket_.get(), reinterpret_cast<const sockaddr*>(&six), sizeof six);
    } else {
      CHECK(::inet_pton(AF_INET, address, &four.sin_addr) == 1);
      connected = ::connect(socket_.get(), reinterpret_cast<const sockaddr*>(&four), sizeof four);
    }
    CHECK(connected == 0);
  }

  /// A server that has closed the connection is no failure.
  void send(std::string_view bytes) const {
    static_cast<void>(::send(socket_.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL));
  }
  /// Returns what arrives next; empty at the end.
  [[nodiscard]] std::string some() const {
    std::array<char, 4096> bytes;
    const ssize_t count = ::recv(socket_.get(), bytes.data(), bytes.size(), 0);
    return {bytes.data(), static_cast<std::size_t>(std::max<ssize_t>(count, 0))};
  }
  /// Returns one whole answer; what has arrived if the connection ends before.
  std::string answer() {
    for (;;) {
      const std::size_t head = received_.find("\r\n\r\n");
      if (head != std::string::npos) {
        const std::size_t whole = head + 4 + content_length(received_.substr(0, head));
        if (received_.size() >= whole) {
          std::string answer = received_.substr(0, whole);
          received_.erase(0, whole);
          return answer;
        }
      }
      const std::string more = some();
      if (more.empty()) return received_;
      received_ += more;
    }
  }
  /// Waits until something arrives or the server closes the connection. Returns false if neither happens in time.
  [[nodiscard]] bool is_readable(int timeout_ms) const {
    pollfd entry{socket_.get(), POLLIN, 0};
    return ::poll(&entry, 1, timeout_ms) == 1;
  }
  /// Waits for the server to close the connection. Returns false if it sends something or does nothing for 20 s.
  [[nodiscard]] bool is_closed() const {
    char byte = 0;
    const ssize_t count = ::recv(socket_.get(), &byte, 1, 0);
    return count == 0 || (count < 0 && errno == ECONNRESET);
  }

 private:
  static bool is_v6(std::string_view address) { return address.find(':') != std::string_view::npos; }
  static std::size_t content_length(const std::string& head) {
    constexpr std::string_view kName = "Content-Length: ";
    const std::size_t at = head.find(kName);
    std::size_t length = 0;
    if (at != std::string::npos) {
      std::from_chars(head.data() + at + kName.size(), head.data() + head.size(), length);
    }
    return length;
  }

  UniqueFd socket_;
  std::string received_;
};

}  // namespace cyclorama
