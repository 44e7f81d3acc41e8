// SPDX-License-Identifier: Apache-2.0
#include "kiosk/renewal/renew_certificate.h"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <sys/stat.h>

#include <system_error>
#include <utility>

#include "common/base/file.h"
#include "common/base/private_file.h"
#include "common/wire/certificate_request.h"

namespace cyclorama::renewal {
namespace {

namespace fs = std::filesystem;
using Kind = RenewalOutcome::Kind;

constexpr std::size_t kMaxPemBytes = std::size_t{64} * 1024;

std::string day(std::chrono::sys_seconds time) {
  return fmt::format("{:%Y-%m-%d}", fmt::gmtime(std::chrono::system_clock::to_time_t(time)));
}

/// Returns the key that an earlier night has made, unless it is in use by now; else a new one.
Result<std::string> next_key(const fs::path& file, const fs::path& in_use, const Identity& who) {
  const auto kept = read_text_file(file, kMaxPemBytes);
  const auto used = read_text_file(in_use, kMaxPemBytes);
  if (kept && used && *kept != *used && certificate_request(*kept, who)) return *kept;
  TRY_ASSIGN(std::string made, new_private_key());
  TRY(write_private_file(file, made));
  return made;
}

void forget(const RenewalOrder& order) {
  std::error_code ignored;
  fs::remove(order.folder / "next.key", ignored);
  fs::remove_all(order.folder / kRenewedFolder, ignored);
}

/// Writes the next pair into a folder of its own, and checks it there as every program does.
Status keep(const RenewalOrder& order, const Identity& who, std::chrono::sys_seconds end, const std::string& key,
            const std::string& certificate) {
  const fs::path folder = order.folder / kRenewedFolder;
  const fs::path made = order.folder / "renewed.new";
  std::error_code failed;
  fs::remove_all(made, failed);
  fs::remove_all(folder, failed);
  if (::mkdir(made.c_str(), 0700) != 0) return Error::from_errno(fmt::format("making '{}'", made.string()));
  TRY(write_private_file(made / kKeyFile, key));
  TRY(write_file_atomically(made / kCertificateFile, std::string_view(certificate)));
  const auto owner = check({order.tls.authority, made / kCertificateFile, made / kKeyFile});
  if (!owner)
    return Error(ErrorCode::kBadData, fmt::format("the farm's answer is not used: {}", owner.error().message()));
  if (owner->role != who.role || owner->name != who.name) {
    return Error(ErrorCode::kBadData,
                 fmt::format("the farm's answer is the certificate of {}, and is not used", to_text(*owner)));
  }
  TRY_ASSIGN(const std::chrono::sys_seconds new_end, end_of_certificate(certificate));
  if (new_end <= end) return Error(ErrorCode::kBadData, "the farm's answer ends no later than the certificate in use");
  if (::rename(made.c_str(), folder.c_str()) != 0) return Error::from_errno("naming the next certificate");
  return Done{};
}

}  // namespace

bool is_due(std::chrono::sys_seconds end, std::chrono::system_clock::time_point now) { return now + kBeforeEnd >= end; }

Result<RenewalOutcome> renew_certificate(const RenewalOrder& order) {
  TRY_ASSIGN(const Identity who, check(order.tls));
  TRY_ASSIGN(const std::string pem, read_text_file(order.tls.certificate, kMaxPemBytes));
  TRY_ASSIGN(const std::chrono::sys_seconds end, end_of_certificate(pem));
  if (!is_due(end, order.now)) {
    forget(order);
    return RenewalOutcome{Kind::kNotDue, fmt::format("the certificate is valid until {}", day(end))};
  }
  TRY_ASSIGN(const std::string key, next_key(order.folder / "next.key", order.tls.key, who));
  TRY_ASSIGN(const std::string request, certificate_request(key, who));
  TRY_ASSIGN(const std::string certificate, order.ask(request));
  if (certificate.empty()) {
    return RenewalOutcome{
        Kind::kWaiting, fmt::format("the certificate ends on {}; the farm has the request for the next one, which its "
                                    "authority must sign (cyclorama-authority renewals)",
                                    day(end))};
  }
  TRY(keep(order, who, end, key, certificate));
  TRY_ASSIGN(const std::chrono::sys_seconds new_end, end_of_certificate(certificate));
  return RenewalOutcome{Kind::kReady, fmt::format("the next certificate has come, valid until {}", day(new_end))};
}

}  // namespace cyclorama::renewal
