// SPDX-License-Identifier: Apache-2.0
#include "kiosk/provision/pin.h"

#include <fmt/format.h>
#include <openssl/crypto.h>
#include <openssl/evp.h>
#include <openssl/rand.h>

#include <algorithm>
#include <array>
#include <optional>
#include <vector>

#include "common/base/text.h"

namespace cyclorama::provision {
namespace {

constexpr std::size_t kMinPinLength = 6;
constexpr std::size_t kMaxPinLength = 64;
constexpr std::size_t kSaltBytes = 16;
constexpr std::size_t kHashBytes = 32;
constexpr std::uint64_t kMaxMemory = 160 << 20;

struct Cost {
  // 32 MiB with r = 8: 0.1 s on a museum's computer, so that 10^6 PINs take more than a day of one core.
  int log2_n = 15;
  int r = 8;
  int p = 1;
};

struct PinHash {
  Cost cost;
  std::vector<unsigned char> salt;
  std::vector<unsigned char> hash;
};

std::string hex(const std::vector<unsigned char>& bytes) {
  std::string text;
  for (const unsigned char byte : bytes) text += fmt::format("{:02x}", byte);
  return text;
}

std::optional<std::vector<unsigned char>> bytes_of(std::string_view text) {
  const auto digit = [](char c) { return c >= '0' && c <= '9' ? c - '0' : c >= 'a' && c <= 'f' ? c - 'a' + 10 : -1; };
  if (text.size() % 2 != 0) return std::nullopt;
  std::vector<unsigned char> bytes;
  for (std::size_t i = 0; i < text.size(); i += 2) {
    const int high = digit(text[i]);
    const int low = digit(text[i + 1]);
    if (high < 0 || low < 0) return std::nullopt;
    bytes.push_back(static_cast<unsigned char>(16 * high + low));
  }
  return bytes;
}

Result<std::vector<unsigned char>> derived(std::string_view pin, const std::vector<unsigned char>& salt, Cost cost) {
  std::vector<unsigned char> hash(kHashBytes);
  if (EVP_PBE_scrypt(pin.data(), pin.size(), salt.data(), salt.size(), std::uint64_t{1} << cost.log2_n,
                     static_cast<std::uint64_t>(cost.r), static_cast<std::uint64_t>(cost.p), kMaxMemory, hash.data(),
                     hash.size()) != 1) {
    return Error(ErrorCode::kSystem, "OpenSSL cannot hash a PIN with scrypt; is there enough memory?");
  }
  return hash;
}

Result<PinHash> parse(std::string_view text) {
  const Error bad(ErrorCode::kBadData, "the stored PIN is damaged; provision the museum again");
  std::vector<std::string_view> parts;
  for (std::size_t at = 0; at <= text.size();) {
    const std::size_t end = std::min(text.find(':', at), text.size());
    parts.push_back(text.substr(at, end - at));
    at = end + 1;
  }
  if (text.size() > 400 || parts.size() != 6 || parts[0] != "scrypt") return bad;
  const auto number = [&](std::size_t part, long long max) {
    const auto value = parse_integer(parts[part]);
    return value && *value >= 1 && *value <= max ? static_cast<int>(*value) : 0;
  };
  PinHash hash;
  hash.cost = {number(1, 17), number(2, 8), number(3, 4)};
  const auto salt = bytes_of(parts[4]);
  const auto digest = bytes_of(parts[5]);
  if (hash.cost.log2_n < 1 || hash.cost.r < 1 || hash.cost.p < 1 || !salt || salt->size() < 8 || !digest ||
      digest->size() != kHashBytes) {
    return bad;
  }
  hash.salt = *salt;
  hash.hash = *digest;
  return hash;
}

/// True if all characters are equal, or if each one is the successor, or each one the predecessor, of the one before.
bool is_a_run(std::string_view pin) {
  for (const int step : {-1, 0, 1}) {
    bool all = true;
    for (std::size_t i = 1; i < pin.size(); ++i) all = all && pin[i] - pin[i - 1] == step;
    if (all) return true;
  }
  return false;
}

}  // namespace

Status check_pin(std::string_view pin) {
  const auto printable_ascii = [](char c) { return c >= ' ' && c <= '~'; };
  if (pin.size() < kMinPinLength || pin.size() > kMaxPinLength ||
      !std::all_of(pin.begin(), pin.end(), printable_ascii)) {
    return Error(ErrorCode::kInvalidArgument,
                 fmt::format("the PIN must have {} to {} digits or letters", kMinPinLength, kMaxPinLength));
  }
  if (is_a_run(pin)) {
    return Error(ErrorCode::kInvalidArgument, "the PIN is one that anybody tries first; choose another");
  }
  return Done{};
}

Result<std::string> hashed_pin(std::string_view pin) {
  TRY(check_pin(pin));
  std::vector<unsigned char> salt(kSaltBytes);
  if (RAND_bytes(salt.data(), static_cast<int>(salt.size())) != 1) {
    return Error(ErrorCode::kSystem, "this computer's random number generator fails");
  }
  const Cost cost;
  TRY_ASSIGN(const std::vector<unsigned char> hash, derived(pin, salt, cost));
  return fmt::format("scrypt:{}:{}:{}:{}:{}", cost.log2_n, cost.r, cost.p, hex(salt), hex(hash));
}

Result<bool> is_pin(std::string_view pin, std::string_view hash) {
  while (!hash.empty() && (hash.back() == '\n' || hash.back() == '\r')) hash.remove_suffix(1);
  TRY_ASSIGN(const PinHash known, parse(hash));
  if (pin.size() > kMaxPinLength) return false;
  TRY_ASSIGN(const std::vector<unsigned char> tried, derived(pin, known.salt, known.cost));
  return CRYPTO_memcmp(tried.data(), known.hash.data(), kHashBytes) == 0;
}

}  // namespace cyclorama::provision
