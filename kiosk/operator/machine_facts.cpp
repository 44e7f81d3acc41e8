// SPDX-License-Identifier: Apache-2.0
#include "kiosk/operator/machine_facts.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <sys/sysmacros.h>
#include <sys/timex.h>

#include <algorithm>
#include <cerrno>
#include <string>
#include <system_error>

#include "common/base/file.h"
#include "common/base/text.h"
#include "common/base/unique_fd.h"
#include "kiosk/operator/kernel_file.h"
#include "kiosk/provision/provisioning_report.h"

namespace cyclorama::operations {
namespace {

namespace fs = std::filesystem;

constexpr double kColdest_c = -60.0;  // Unconnected sensors report absurd values.
constexpr double kHottest_c = 150.0;

std::optional<double> degrees_of(const fs::path& path) {
  const auto text = read_kernel_file(path);
  if (!text) return std::nullopt;
  const auto millidegrees = parse_integer(std::string_view(*text).substr(0, text->find_first_of("\r\n")));
  if (!millidegrees) return std::nullopt;
  const double degrees = 1e-3 * static_cast<double>(*millidegrees);
  return degrees > kColdest_c && degrees < kHottest_c ? std::optional(degrees) : std::nullopt;
}

std::optional<double> critical_of(const fs::path& zone) {
  for (int i = 0; i < 12; ++i) {
    const std::string point = "trip_point_" + std::to_string(i);
    const auto kind = read_kernel_file(zone / (point + "_type"));
    if (!kind) return std::nullopt;
    if (kind->starts_with("critical")) return degrees_of(zone / (point + "_temp"));
  }
  return std::nullopt;
}

void read_temperature(const fs::path& root, MachineFacts* ret) {
  std::error_code failed;
  for (fs::directory_iterator entry(root / "sys/class/thermal", failed), end; !failed && entry != end;
       entry.increment(failed)) {
    if (!entry->path().filename().string().starts_with("thermal_zone")) continue;
    const auto degrees = degrees_of(entry->path() / "temp");
    if (!degrees || (ret->warmest_c && *ret->warmest_c >= *degrees)) continue;
    ret->warmest_c = degrees;
    ret->critical_c = critical_of(entry->path());
  }
}

/// Reads the state written by the image's script that mounts /var: "encrypted", "plain: Secure Boot is off", "in
/// memory: the disk cannot be read".
void read_var(const fs::path& root, MachineFacts* ret) {
  const auto said = read_kernel_file(root / "run/cyclorama/var");
  if (!said) return;
  const std::string line = printable(said->substr(0, said->find('\n')), 200);
  const auto reason_after = [&](std::string_view state) {
    return line.starts_with(state) ? line.substr(state.size()) : std::string();
  };
  ret->is_encrypted = line == "encrypted";
  ret->unencrypted = reason_after("plain: ");
  ret->only_in_memory = reason_after("in memory: ");
}

/// Reads what the same script found in the firmware's variables.
void read_secure_boot(const fs::path& root, MachineFacts* ret) {
  const auto said = read_kernel_file(root / "run/cyclorama/secure-boot");
  if (!said) return;
  const std::string_view word = std::string_view(*said).substr(0, said->find('\n'));
  ret->secure_boot = word == "on"      ? SecureBoot::kOn
                     : word == "setup" ? SecureBoot::kSetupMode
                     : word == "off"   ? SecureBoot::kOff
                                       : SecureBoot::kUnknown;
}

/// Reads the count of the whole processor package, which the first core reports.
void read_throttling(const fs::path& root, MachineFacts* ret) {
  const auto text = read_kernel_file(root / "sys/devices/system/cpu/cpu0/thermal_throttle/package_throttle_count");
  const auto count = text ? parse_integer(std::string_view(*text).substr(0, text->find('\n'))) : std::nullopt;
  if (count && *count > 0) ret->slowed_by_heat = static_cast<std::uint64_t>(*count);
}

void read_clock(const fs::path& root, MachineFacts* ret) {
  std::error_code failed;
  if (fs::exists(root / "run/systemd/timesync/synchronized", failed)) {
    ret->is_clock_set = true;
    return;
  }
  if (root != "/") {
    ret->is_clock_set = false;
    return;
  }
  timex state{};
  const int answer = ::adjtimex(&state);  // The call only reads, but a sandbox may refuse it.
  if (answer >= 0) ret->is_clock_set = (state.status & STA_UNSYNC) == 0;
}

void read_memory(const fs::path& root, MachineFacts* ret) {
  const auto text = read_kernel_file(root / "proc/meminfo");
  if (!text) return;
  const auto kilobytes = [&](const std::string& key) -> std::optional<double> {
    const std::size_t at = text->find(key + ":");
    if (at == std::string::npos) return std::nullopt;
    const std::size_t first = text->find_first_of("0123456789", at);
    const std::size_t last = first == std::string::npos ? first : text->find_first_not_of("0123456789", first);
    if (last == std::string::npos) return std::nullopt;
    return parse_double(std::string_view(*text).substr(first, last - first));
  };
  const auto total = kilobytes("MemTotal");
  const auto available = kilobytes("MemAvailable");
  if (total && available && *total > 0.0) ret->memory_free_share = *available / *total;
}

/// Returns true when ext4 refuses all access after an error, until it is mounted again; kernels before 6.11 allow
/// reading.
bool is_shut(const fs::path& state) {
  const UniqueFd fd(::open((state / provision::kProvisioningReportFile).c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  return !fd.is_open() && errno == EIO;
}

/// Reads the file system's own state, which follows " - " in proc(5)'s mountinfo. statvfs() would report the state of
/// the mount, which is read-only if the service may not write to it (ProtectSystem=), although the disk is well.
bool is_file_system_read_only(const fs::path& state, const fs::path& root) {
  struct stat info {};
  const auto mounts = read_kernel_file(root / "proc/self/mountinfo");
  if (!mounts || ::stat(state.c_str(), &info) != 0) return false;
  const std::string device = fmt::format(" {}:{} ", major(info.st_dev), minor(info.st_dev));
  for (std::size_t begin = 0; begin < mounts->size();) {
    const std::size_t end = std::min(mounts->find('\n', begin), mounts->size());
    const std::string_view line = std::string_view(*mounts).substr(begin, end - begin);
    begin = end + 1;
    const std::size_t own = line.find(" - ");
    if (own == std::string_view::npos || line.substr(0, own).find(device) == std::string_view::npos) continue;
    const std::string_view options = line.substr(line.rfind(' ') + 1);
    return options == "ro" || options.starts_with("ro,");
  }
  return false;
}

}  // namespace

MachineFacts read_machine_facts(const fs::path& state, const fs::path& root) {
  MachineFacts facts;
  struct statvfs disk {};
  if (::statvfs(state.c_str(), &disk) == 0) {
    facts.disk_free_bytes = std::uint64_t{disk.f_bavail} * disk.f_frsize;
    facts.disk_bytes = std::uint64_t{disk.f_blocks} * disk.f_frsize;
    facts.is_read_only = is_file_system_read_only(state, root) || is_shut(state);
  }
  read_var(root, &facts);
  read_secure_boot(root, &facts);
  read_temperature(root, &facts);
  read_throttling(root, &facts);
  read_clock(root, &facts);
  read_memory(root, &facts);
  return facts;
}

}  // namespace cyclorama::operations
