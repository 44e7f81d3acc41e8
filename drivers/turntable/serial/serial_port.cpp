// SPDX-License-Identifier: Apache-2.0
#include "drivers/turntable/serial/serial_port.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/file.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <utility>

namespace cyclorama::turntable {
namespace {

constexpr std::array<std::pair<int, speed_t>, 8> kRates{{{9600, B9600},
                                                         {19200, B19200},
                                                         {38400, B38400},
                                                         {57600, B57600},
                                                         {115200, B115200},
                                                         {230400, B230400},
                                                         {460800, B460800},
                                                         {921600, B921600}}};

Error unplugged() { return Error(ErrorCode::kUnavailable, "it was unplugged"); }

}  // namespace

Result<SerialPort> SerialPort::open(const std::filesystem::path& device, int baud) {
  const auto rate = std::find_if(kRates.begin(), kRates.end(), [&](const auto& entry) { return entry.first == baud; });
  if (rate == kRates.end()) {
    return Error(ErrorCode::kInvalidArgument,
                 fmt::format("no serial line has {} baud; take 9600, 19200, 38400, 57600, 115200, 230400, 460800 or "
                             "921600",
                             baud));
  }
  const std::string doing = fmt::format("opening '{}'", device.string());
  UniqueFd fd(::open(device.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
  if (!fd.is_open()) return Error::from_errno(doing);
  if (::flock(fd.get(), LOCK_EX | LOCK_NB) != 0)
    return Error(ErrorCode::kBusy, doing + ": another program holds it; stop that first");
  termios settings{};
  if (::tcgetattr(fd.get(), &settings) != 0)
    return Error(ErrorCode::kInvalidArgument, doing + ": it is no serial line");
  ::cfmakeraw(&settings);
  settings.c_cflag |= CLOCAL | CREAD;
  settings.c_cflag &= ~(CSTOPB | CRTSCTS | PARENB);
  settings.c_cc[VMIN] = 0;
  settings.c_cc[VTIME] = 0;
  if (::cfsetispeed(&settings, rate->second) != 0 || ::cfsetospeed(&settings, rate->second) != 0 ||
      ::tcsetattr(fd.get(), TCSANOW, &settings) != 0)
    return Error::from_errno(doing);
  return SerialPort(std::move(fd));
}

Status SerialPort::wait_for(short events, TimePoint deadline) const {
  for (;;) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - SteadyClock().now());
    pollfd entry{fd_.get(), events, 0};
    const int ready = ::poll(&entry, 1, static_cast<int>(std::clamp<std::int64_t>(left.count(), 0, 600'000)));
    if (ready < 0 && errno != EINTR) return Error::from_errno("waiting for it");
    if (ready > 0) {
      // Data that arrived before the unplugging can still be read.
      if ((entry.revents & events) != 0) return Done{};
      return unplugged();
    }
    if (ready == 0 && left.count() <= 600'000) return Error(ErrorCode::kTimedOut, "it does not answer in time");
  }
}

Status SerialPort::write_line(std::string_view line, TimePoint deadline) {
  std::string bytes(line);
  bytes += '\n';
  for (std::string_view rest = bytes; !rest.empty();) {
    TRY(wait_for(POLLOUT, deadline));
    const ssize_t count = ::write(fd_.get(), rest.data(), rest.size());
    if (count > 0) rest.remove_prefix(static_cast<std::size_t>(count));
    // Drivers return EIO, ENXIO or ENODEV for a device that is gone.
    if (count < 0 && errno != EAGAIN && errno != EINTR) return unplugged();
  }
  return Done{};
}

Result<std::string> SerialPort::read_line(TimePoint deadline) {
  for (;;) {
    if (auto line = lines_.next()) return *std::move(line);
    if (lines_.is_endless())
      return Error(ErrorCode::kBadData,
                   "it sends bytes that are no lines; is it a motor controller, and its baud rate?");
    TRY(wait_for(POLLIN, deadline));
    std::array<char, 256> bytes{};
    const ssize_t count = ::read(fd_.get(), bytes.data(), bytes.size());
    if (count > 0) lines_.add(std::string_view(bytes.data(), static_cast<std::size_t>(count)));
    if (count == 0 || (count < 0 && errno != EAGAIN && errno != EINTR)) return unplugged();
  }
}

void SerialPort::forget_input() {
  lines_.clear();
  ::tcflush(fd_.get(), TCIFLUSH);
}

}  // namespace cyclorama::turntable
