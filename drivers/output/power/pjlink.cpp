// SPDX-License-Identifier: Apache-2.0
#include "drivers/output/power/pjlink.h"

#include <fmt/format.h>
#include <netdb.h>
#include <openssl/evp.h>
#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <memory>
#include <vector>

#include "common/base/clock.h"
#include "common/base/text.h"
#include "common/base/unique_fd.h"

namespace cyclorama::output {
namespace {

Result<std::string> md5_hex(std::string_view text) {
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned size = 0;
  if (EVP_Digest(text.data(), text.size(), digest.data(), &size, EVP_md5(), nullptr) != 1)
    return Error(ErrorCode::kUnavailable, "OpenSSL has no MD5, which PJLink's passwords need");
  std::string hex;
  for (unsigned i = 0; i < size; ++i) hex += fmt::format("{:02x}", digest[i]);
  return hex;
}

Error not_pjlink(std::string_view line) {
  return Error(ErrorCode::kBadData,
               fmt::format("'{}' is not PJLink class 1; is this the projector's port?", printable(line)));
}

/// A connection for one command.
class Connection {
 public:
  static Result<Connection> dial(const Address& address, TimePoint deadline) {
    addrinfo hints{};
    hints.ai_socktype = SOCK_STREAM;
    addrinfo* found = nullptr;
    const std::string port = fmt::format("{}", address.port);
    if (const int error = ::getaddrinfo(address.host.c_str(), port.c_str(), &hints, &found); error != 0)
      return Error(ErrorCode::kUnavailable, fmt::format("resolving its name: {}", ::gai_strerror(error)));
    const std::unique_ptr<addrinfo, decltype(&::freeaddrinfo)> freed(found, &::freeaddrinfo);
    Error last(ErrorCode::kUnavailable, "it has no address");
    for (const addrinfo* a = found; a != nullptr; a = a->ai_next) {
      Connection made(UniqueFd(::socket(a->ai_family, a->ai_socktype | SOCK_NONBLOCK | SOCK_CLOEXEC, a->ai_protocol)),
                      deadline);
      auto dialled = made.connect(*a);
      if (dialled) return made;
      last = std::move(dialled).error();
    }
    return last;
  }

  /// Reads up to the next carriage return, which is removed.
  Result<std::string> read_line() {
    for (;;) {
      if (const std::size_t end = read_.find('\r'); end != std::string::npos) {
        const std::string line = read_.substr(0, end);
        read_.erase(0, end + 1);
        return line;
      }
      if (read_.size() > pjlink::kMaxLineLength) return not_pjlink(read_);
      TRY(wait(POLLIN));
      std::array<char, 256> bytes{};
      const ssize_t count = ::recv(fd_.get(), bytes.data(), bytes.size(), 0);
      if (count < 0) return unavailable();
      if (count == 0) return Error(ErrorCode::kUnavailable, "it closed the connection");
      read_.append(bytes.data(), static_cast<std::size_t>(count));
    }
  }

  Status write(std::string_view text) {
    // The command is so short that a new connection always accepts all of it at once.
    TRY(wait(POLLOUT));
    if (::send(fd_.get(), text.data(), text.size(), MSG_NOSIGNAL) != static_cast<ssize_t>(text.size()))
      return unavailable();
    return Done{};
  }

 private:
  Connection(UniqueFd fd, TimePoint deadline) : fd_(std::move(fd)), deadline_(deadline) {}

  static Error unavailable() {
    return Error(ErrorCode::kUnavailable, Error::from_errno("it does not answer").message());
  }
  Status connect(const addrinfo& to) {
    if (!fd_.is_open()) return unavailable();
    if (::connect(fd_.get(), to.ai_addr, to.ai_addrlen) == 0) return Done{};
    if (errno != EINPROGRESS) return unavailable();
    TRY(wait(POLLOUT));
    socklen_t size = sizeof errno;
    if (::getsockopt(fd_.get(), SOL_SOCKET, SO_ERROR, &errno, &size) != 0 || errno != 0) return unavailable();
    return Done{};
  }
  Status wait(short events) {
    for (;;) {
      const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline_ - SteadyClock().now());
      pollfd entry{fd_.get(), events, 0};
      const int ready = ::poll(&entry, 1, static_cast<int>(std::max<std::int64_t>(left.count(), 0)));
      if (ready > 0) return Done{};
      if (ready == 0) return Error(ErrorCode::kUnavailable, "it does not answer in time");
      if (errno != EINTR) return unavailable();
    }
  }

  UniqueFd fd_;
  TimePoint deadline_;
  std::string read_;
};

/// Sends one command and returns the answer. `command` includes its parameter: "POWR ?".
Result<std::string> exchange(const PjlinkProjector& projector, std::string_view command,
                             std::chrono::milliseconds timeout) {
  TRY_ASSIGN(Connection connection, Connection::dial(projector.address, SteadyClock().now() + timeout));
  TRY_ASSIGN(const std::string greeting, connection.read_line());
  TRY_ASSIGN(const std::string authority, pjlink::authorise(greeting, projector.password));
  TRY(connection.write(fmt::format("{}%1{}\r", authority, command)));
  return connection.read_line();
}

Error said(const PjlinkProjector& projector, Error error) {
  return std::move(error).while_doing(
      fmt::format("projector at {}:{}", projector.address.host, projector.address.port));
}

}  // namespace

namespace pjlink {

Result<std::string> authorise(std::string_view greeting, std::string_view password) {
  constexpr std::string_view kOpen = "PJLINK 0";
  constexpr std::string_view kLocked = "PJLINK 1 ";
  if (greeting == kOpen) return std::string();
  const std::string_view challenge = greeting.substr(std::min(greeting.size(), kLocked.size()));
  const auto is_hex = [](unsigned char c) { return std::isxdigit(c) != 0; };
  if (!greeting.starts_with(kLocked) || challenge.size() != 8 ||
      !std::all_of(challenge.begin(), challenge.end(), is_hex))
    return not_pjlink(greeting);
  if (password.empty())
    return Error(ErrorCode::kInvalidArgument,
                 "it wants a password; name a file that holds it: --password-file, or "
                 "pjlink_password_file in installation.toml");
  return md5_hex(std::string(challenge) + std::string(password));
}

Result<std::string> parse_answer(std::string_view line, std::string_view command) {
  const std::string head = fmt::format("%1{}=", command);
  if (line == "PJLINK ERRA") return Error(ErrorCode::kInvalidArgument, "it refuses the password");
  if (!line.starts_with(head) || line.size() > kMaxLineLength || line.size() == head.size()) return not_pjlink(line);
  const std::string_view value = line.substr(head.size());
  if (value == "ERR1" || value == "ERR2") return Error(ErrorCode::kBadData, "it does not know that command");
  if (value == "ERR3")
    return Error(ErrorCode::kUnavailable, "it cannot do that now; it may be cooling down or warming up");
  if (value == "ERR4") return Error(ErrorCode::kSystem, "it reports a failure; look at its own display");
  return std::string(value);
}

Result<ProjectorPower> parse_power(std::string_view line) {
  const auto value = parse_answer(line);
  if (!value) return value.error();
  switch (value->size() == 1 ? value->front() : '?') {
    case '0':
      return ProjectorPower::kOff;
    case '1':
      return ProjectorPower::kOn;
    case '2':
      return ProjectorPower::kCooling;
    case '3':
      return ProjectorPower::kWarming;
    default:
      break;
  }
  return not_pjlink(line);
}

Result<ProjectorErrors> parse_errors(std::string_view line) {
  TRY_ASSIGN(const std::string value, parse_answer(line, "ERST"));
  ProjectorErrors errors;
  if (value.size() != errors.of.size()) return not_pjlink(line);
  for (std::size_t i = 0; i < value.size(); ++i) {
    if (value[i] < '0' || value[i] > '2') return not_pjlink(line);
    errors.of[i] = static_cast<ProjectorErrors::Kind>(value[i] - '0');
  }
  return errors;
}

}  // namespace pjlink

std::string_view text_of(ProjectorPower power) {
  switch (power) {
    case ProjectorPower::kOff:
      return "off";
    case ProjectorPower::kOn:
      return "on";
    case ProjectorPower::kCooling:
      return "cooling down";
    case ProjectorPower::kWarming:
      break;
  }
  return "warming up";
}

Result<ProjectorPower> query_power(const PjlinkProjector& projector, std::chrono::milliseconds timeout) {
  auto line = exchange(projector, "POWR ?", timeout);
  if (!line) return said(projector, std::move(line).error());
  auto power = pjlink::parse_power(*line);
  if (!power) return said(projector, std::move(power).error());
  return power;
}

Result<ProjectorErrors> query_errors(const PjlinkProjector& projector, std::chrono::milliseconds timeout) {
  auto line = exchange(projector, "ERST ?", timeout);
  if (!line) return said(projector, std::move(line).error());
  auto errors = pjlink::parse_errors(*line);
  if (!errors) return said(projector, std::move(errors).error());
  return errors;
}

Status set_power(const PjlinkProjector& projector, bool is_on, std::chrono::milliseconds timeout) {
  auto line = exchange(projector, is_on ? "POWR 1" : "POWR 0", timeout);
  if (!line) return said(projector, std::move(line).error());
  auto answer = pjlink::parse_answer(*line);
  if (!answer) return said(projector, std::move(answer).error());
  if (*answer != "OK") return said(projector, not_pjlink(*line));
  return Done{};
}

}  // namespace cyclorama::output
