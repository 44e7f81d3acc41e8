// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/watch/access.h"

#include <fmt/format.h>
#include <openssl/crypto.h>
#include <openssl/evp.h>

#include <algorithm>

#include "common/base/address.h"
#include "common/base/file.h"

namespace cyclorama::watch {
namespace {

std::array<unsigned char, 32> sha256(const std::string& text) {
  std::array<unsigned char, 32> digest{};
  CHECK(EVP_Digest(text.data(), text.size(), digest.data(), nullptr, EVP_sha256(), nullptr) == 1);
  return digest;
}

std::string base64(const std::string& text) {
  std::string out(4 * ((text.size() + 2) / 3) + 1, '\0');
  const auto* const bytes = reinterpret_cast<const unsigned char*>(text.data());
  const int length =
      EVP_EncodeBlock(reinterpret_cast<unsigned char*>(out.data()), bytes, static_cast<int>(text.size()));
  out.resize(static_cast<std::size_t>(length));
  return out;
}

/// Returns true for a Host header such as "localhost", "[::1]:7404" or "127.0.0.1".
bool names_this_machine(const std::string& host) { return is_loopback(host) || is_loopback(host + ":80"); }

}  // namespace

Access::Access(const std::string& token)
    : accepted_{sha256("Bearer " + token), sha256("Basic " + base64(std::string(kUser) + ":" + token))} {}

Result<Access> Access::read(const std::filesystem::path& token_file) {
  constexpr std::size_t kMaxBytes = 4096;
  TRY_ASSIGN(const std::string text, read_text_file(token_file, kMaxBytes));
  std::string token = text.substr(0, text.find('\n'));
  token.erase(token.find_last_not_of(" \t\r") + 1);
  token.erase(0, token.find_first_not_of(" \t"));
  const bool plain = std::ranges::all_of(token, [](char c) { return c > ' ' && c < 0x7f; });
  if (!plain || token.size() < kMinTokenLength) {
    return Error(
        ErrorCode::kBadData,
        fmt::format("the first line of '{}' must be a token of {} characters or more, without blanks; make one "
                    "with: openssl rand -base64 24",
                    token_file.string(), kMinTokenLength));
  }
  return Access(token);
}

bool Access::admits(const std::string& authorization, const std::string& host) const {
  if (!has_token()) return names_this_machine(host);
  const Digest given = sha256(authorization);
  int matches = 0;
  for (const Digest& accepted : accepted_) matches += CRYPTO_memcmp(given.data(), accepted.data(), given.size()) == 0;
  return matches > 0;
}

}  // namespace cyclorama::watch
