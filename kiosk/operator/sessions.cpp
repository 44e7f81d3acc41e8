// SPDX-License-Identifier: Apache-2.0
#include "kiosk/operator/sessions.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <openssl/rand.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "common/base/file.h"
#include "kiosk/provision/pin.h"

namespace cyclorama::operations {
namespace {

constexpr std::size_t kTokenBytes = 32;
constexpr std::size_t kMaxPinFileBytes = 4096;
constexpr std::size_t kMaxNetworks = 1000;
constexpr auto kForgiveAfter = std::chrono::hours(1);

Result<std::string> new_token() {
  std::array<unsigned char, kTokenBytes> bytes{};
  if (RAND_bytes(bytes.data(), static_cast<int>(bytes.size())) != 1) {
    return Error(ErrorCode::kSystem, "this computer's random number generator fails");
  }
  std::string token;
  for (const unsigned char byte : bytes) token += fmt::format("{:02x}", byte);
  return token;
}

Error wait_for(Duration time) {
  return {ErrorCode::kBusy, fmt::format("too many wrong PINs; try again in {:.0f} s", std::ceil(to_seconds(time)))};
}

}  // namespace

std::string network_of(const std::string& address) {
  std::array<unsigned char, 16> bytes{};
  if (::inet_pton(AF_INET6, address.c_str(), bytes.data()) != 1) return address;
  const bool is_mapped = std::all_of(bytes.begin(), bytes.begin() + 10, [](unsigned char b) { return b == 0; }) &&
                         bytes[10] == 0xff && bytes[11] == 0xff;
  if (is_mapped) return fmt::format("{}.{}.{}.{}", bytes[12], bytes[13], bytes[14], bytes[15]);
  return fmt::format("{:x}:{:x}:{:x}:{:x}", bytes[0] << 8 | bytes[1], bytes[2] << 8 | bytes[3],
                     bytes[4] << 8 | bytes[5], bytes[6] << 8 | bytes[7]);
}

Sessions::Sessions(const Clock& clock, std::filesystem::path pin_file, SessionRules rules)
    : clock_(clock),
      pin_file_(std::move(pin_file)),
      rules_(rules),
      wrong_of_all_(rules.tries_per_minute / 60.0, rules.tries_at_once) {}

Status Sessions::may_try(const std::string& network, TimePoint now) {
  const std::lock_guard lock(mutex_);
  if (const auto known = tries_.find(network); known != tries_.end() && known->second.next_at > now) {
    return wait_for(known->second.next_at - now);
  }
  if (wrong_of_all_.paid_at() > now) return wait_for(wrong_of_all_.paid_at() - now);
  return Done{};
}

void Sessions::was_wrong(const std::string& network, TimePoint now) {
  const std::lock_guard lock(mutex_);
  wrong_of_all_.take(1.0, now);
  std::erase_if(tries_, [&](const auto& entry) { return now - entry.second.last_at > kForgiveAfter; });
  // The limit for all networks together still holds.
  if (tries_.size() >= kMaxNetworks) tries_.erase(tries_.begin());
  Tries& tries = tries_[network];
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

Result<std::string> Sessions::open(std::string_view pin, const std::string& from) {
  const std::lock_guard one(trying_);
  const std::string network = network_of(from);
  TRY(may_try(network, clock_.now()));
  const auto hash = read_text_file(pin_file_, kMaxPinFileBytes);
  if (!hash && hash.error().code() == ErrorCode::kNotFound) {
    return Error(
        ErrorCode::kNotFound,
        "this museum has no PIN yet: plug in a stick whose folder 'cyclorama' has an operator.toml with a pin");
  }
  if (!hash) return hash.error();
  std::string plain;
  for (const char c : pin) {
    if (c != ' ') plain += c;  // Spaces are ignored, as in operator.toml: people write PINs in groups.
  }
  TRY_ASSIGN(const bool is_right, provision::is_pin(plain, *hash));
  const TimePoint now = clock_.now();
  if (!is_right) {
    was_wrong(network, now);
    return Error(ErrorCode::kInvalidArgument, "this is not the PIN");
  }
  TRY_ASSIGN(std::string token, new_token());
  const std::lock_guard lock(mutex_);
  tries_.erase(network);
  forget_old(now);
  if (sessions_.size() >= rules_.max) {
    sessions_.erase(std::min_element(sessions_.begin(), sessions_.end(),
                                     [](const auto& a, const auto& b) { return a.second.used_at < b.second.used_at; }));
  }
  sessions_[token] = {now, now};
  return token;
}

bool Sessions::is_open(std::string_view token) {
  const std::lock_guard lock(mutex_);
  const TimePoint now = clock_.now();
  forget_old(now);
  const auto found = sessions_.find(token);
  if (found == sessions_.end()) return false;
  found->second.used_at = now;
  return true;
}

void Sessions::close(std::string_view token) {
  const std::lock_guard lock(mutex_);
  if (const auto found = sessions_.find(token); found != sessions_.end()) sessions_.erase(found);
}

}  // namespace cyclorama::operations
