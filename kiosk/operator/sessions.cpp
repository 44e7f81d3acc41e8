// SPDX-License-Identifier: Apache-2.0
#include "kiosk/operator/sessions.h"

#include <fmt/format.h>
#include <openssl/crypto.h>
#include <openssl/evp.h>
#include <openssl/hmac.h>
#include <openssl/rand.h>
#include <openssl/sha.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>

#include "common/base/file.h"
#include "common/http/peer_network.h"
#include "kiosk/provision/pin.h"

namespace cyclorama::operations {
namespace {

constexpr std::size_t kTokenBytes = 32;
constexpr std::size_t kMaxPinFileBytes = 4096;
constexpr std::size_t kWallCodeLength = 16;  // 64 bits: it is valid for minutes, and must fit into a QR code.
constexpr const char* kWall = "wall";        // No name of a device, which is longer.
constexpr std::size_t kMaxClients = 1000;
constexpr auto kForgiveAfter = std::chrono::hours(1);

std::string hexadecimal(std::span<const unsigned char> bytes) {
  std::string text;
  for (const unsigned char byte : bytes) text += fmt::format("{:02x}", byte);
  return text;
}

/// Returns the text by which a device proves that it had a name from this computer while the PIN's hash was `hash`: the
/// hash is salted and never leaves this computer, so it serves as the key, and a new PIN makes all devices unknown.
std::string device_proof(std::string_view name, std::string_view hash) {
  std::array<unsigned char, SHA256_DIGEST_LENGTH> code{};
  const auto* const text = reinterpret_cast<const unsigned char*>(name.data());
  if (HMAC(EVP_sha256(), hash.data(), static_cast<int>(hash.size()), text, name.size(), code.data(), nullptr) ==
      nullptr) {
    return "";
  }
  return fmt::format("{}.{}", name, hexadecimal(code));
}

/// Returns the name of a known device; empty for every other text.
std::string known_device(std::string_view device, std::string_view hash) {
  const std::string_view name = device.substr(0, std::min(device.find('.'), device.size()));
  const std::string proof = device_proof(name, hash);
  const bool is_known = proof.size() == device.size() && CRYPTO_memcmp(proof.data(), device.data(), proof.size()) == 0;
  return is_known ? std::string(name) : "";
}

Error wait_for(Duration time, bool has_own_tries) {
  return {ErrorCode::kBusy,
          fmt::format(fmt::runtime(has_own_tries
                                       ? "too many wrong PINs; try again in {:.0f} s"
                                       : "too many wrong PINs; try again in {:.0f} s, or with a device that has logged "
                                         "in before, or press Help at the wall and scan its code"),
                      std::ceil(to_seconds(time)))};
}

}  // namespace

Result<std::string> new_token() {
  std::array<unsigned char, kTokenBytes> bytes{};
  if (RAND_bytes(bytes.data(), static_cast<int>(bytes.size())) != 1) {
    return Error(ErrorCode::kSystem, "this computer's random number generator fails");
  }
  return hexadecimal(bytes);
}

Sessions::Sessions(const Clock& clock, std::filesystem::path pin_file, SessionRules rules)
    : clock_(clock),
      pin_file_(std::move(pin_file)),
      rules_(rules),
      wrong_of_unknown_(rules.tries_per_hour / 3600.0, rules.tries_at_once) {}

Status Sessions::may_try(const Client& client, TimePoint now) {
  const std::lock_guard lock(mutex_);
  const TriesByClient& tries = tries_of(client);
  TimePoint next_at = client.has_own_tries ? now : wrong_of_unknown_.paid_at();
  if (const auto found = tries.find(client.name); found != tries.end()) {
    next_at = std::max(next_at, found->second.next_at);
  }
  if (next_at > now) return wait_for(next_at - now, client.has_own_tries);
  return Done{};
}

void Sessions::was_wrong(const Client& client, TimePoint now) {
  const std::lock_guard lock(mutex_);
  if (!client.has_own_tries) wrong_of_unknown_.take(1.0, now);
  TriesByClient& all = tries_of(client);
  std::erase_if(all, [&](const auto& entry) { return now - entry.second.last_at > kForgiveAfter; });
  // The limit for all unknown devices together still holds.
  if (all.size() >= kMaxClients) all.erase(all.begin());
  Tries& tries = all[client.name];
  ++tries.wrong;
  tries.last_at = now;
  if (tries.wrong < rules_.free_tries) return;
  const int doublings = std::min(tries.wrong - rules_.free_tries, 20);
  tries.next_at = now + std::min(rules_.first_wait * (1 << doublings), rules_.max_wait);
}

void Sessions::forget_old(TimePoint now) {
  std::erase_if(sessions_, [&](const auto& entry) {
    return now - entry.second.opened_at > rules_.longest || now - entry.second.used_at > rules_.idle;
  });
}

Sessions::Client Sessions::client_of(const std::string& from, const LoginProofs& proofs, std::string_view hash) {
  if (std::string device = known_device(proofs.device, hash); !device.empty()) return {std::move(device), true};
  if (is_wall_code(proofs.wall_code)) return {kWall, true};
  return {peer_network(from), false};
}

bool Sessions::is_wall_code(std::string_view code) const {
  const std::lock_guard lock(mutex_);
  return std::ranges::any_of(wall_codes_, [&](const std::string& one) {
    return !one.empty() && one.size() == code.size() && CRYPTO_memcmp(one.data(), code.data(), one.size()) == 0;
  });
}

Result<std::string> Sessions::renew_wall_code() {
  TRY_ASSIGN(std::string code, new_token());
  code.resize(kWallCodeLength);
  const std::lock_guard lock(mutex_);
  wall_codes_[1] = std::exchange(wall_codes_[0], code);
  return code;
}

Result<Login> Sessions::open(std::string_view pin, const std::string& from, const LoginProofs& proofs) {
  const std::lock_guard one(trying_);
  const auto hash = read_text_file(pin_file_, kMaxPinFileBytes);
  if (!hash && hash.error().code() == ErrorCode::kNotFound) {
    return Error(
        ErrorCode::kNotFound,
        "this museum has no PIN yet: plug in a stick whose folder 'cyclorama' has an operator.toml with a pin");
  }
  if (!hash) return hash.error();
  const Client client = client_of(from, proofs, *hash);
  TRY(may_try(client, clock_.now()));
  std::string plain;
  for (const char c : pin) {
    if (c != ' ') plain += c;  // Spaces are ignored, as in operator.toml: people write PINs in groups.
  }
  TRY_ASSIGN(const bool is_right, provision::is_pin(plain, *hash));
  const TimePoint now = clock_.now();
  if (!is_right) {
    was_wrong(client, now);
    return Error(ErrorCode::kInvalidArgument, "this is not the PIN");
  }
  Login login;
  TRY_ASSIGN(login.session, new_token());
  login.device = proofs.device;
  if (known_device(proofs.device, *hash).empty()) {
    TRY_ASSIGN(const std::string name, new_token());
    login.device = device_proof(name, *hash);
  }
  const std::lock_guard lock(mutex_);
  tries_of(client).erase(client.name);
  forget_old(now);
  if (sessions_.size() >= rules_.max) {
    sessions_.erase(std::min_element(sessions_.begin(), sessions_.end(),
                                     [](const auto& a, const auto& b) { return a.second.used_at < b.second.used_at; }));
  }
  sessions_[login.session] = {now, now, *hash};
  return login;
}

bool Sessions::is_open(std::string_view token) {
  const auto hash = read_text_file(pin_file_, kMaxPinFileBytes);
  const std::lock_guard lock(mutex_);
  const TimePoint now = clock_.now();
  forget_old(now);
  const auto found = sessions_.find(token);
  if (found == sessions_.end()) return false;
  if (!hash || *hash != found->second.pin_hash) {
    sessions_.erase(found);
    return false;
  }
  found->second.used_at = now;
  return true;
}

void Sessions::close(std::string_view token) {
  const std::lock_guard lock(mutex_);
  if (const auto found = sessions_.find(token); found != sessions_.end()) sessions_.erase(found);
}

}  // namespace cyclorama::operations
