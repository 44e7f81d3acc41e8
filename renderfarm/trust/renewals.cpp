// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/trust/renewals.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <system_error>

#include "common/base/file.h"
#include "common/base/text.h"
#include "common/wire/certificate_request.h"

namespace cyclorama::trust {
namespace {

constexpr std::size_t kMaxPemBytes = std::size_t{16} * 1024;

/// True for the names that cyclorama-authority gives, which are safe as a file's name.
bool is_name(std::string_view name) {
  const auto is_letter = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0; };
  return !name.empty() && is_letter(name.front()) &&
         std::ranges::all_of(name, [&](char c) { return is_letter(c) || c == '.' || c == '_' || c == '-'; });
}

Error refused(std::string why) { return Error(ErrorCode::kInvalidArgument, std::move(why)); }

}  // namespace

Result<std::string> Renewals::renew(const Identity& who, std::string_view request_pem) const {
  if (folder_.empty()) {
    return Error(ErrorCode::kNotFound, "this farm renews no certificates; ask its operator for the next bundle");
  }
  if (who.role != Role::kMuseum || !is_name(who.name)) {
    return refused("certificates are renewed for museums that have one of this farm's authority");
  }
  if (request_pem.size() > kMaxPemBytes) return refused("the request is too long");
  const auto wanted = identity_in_request(request_pem);
  if (!wanted) return refused(wanted.error().message());
  if (wanted->role != who.role || wanted->name != who.name) {
    return refused(fmt::format("'{}' requests a certificate for the {} '{}'", who.name, to_text(wanted->role),
                               printable(wanted->name)));
  }
  const auto issued = read_text_file(folder_ / "issued" / (who.name + ".crt"), kMaxPemBytes);
  if (issued && is_for_request(*issued, request_pem)) return *issued;
  const std::filesystem::path request = folder_ / "requests" / (who.name + ".pem");
  std::error_code failed;
  std::filesystem::create_directories(request.parent_path(), failed);
  const Status written =
      failed ? Error(ErrorCode::kSystem, failed.message()) : write_file_atomically(request, request_pem);
  // The farm's paths are of no use to a museum.
  if (!written) return Error(ErrorCode::kSystem, "the farm's coordinator cannot keep the request; tell its operator");
  return std::string();
}

}  // namespace cyclorama::trust
