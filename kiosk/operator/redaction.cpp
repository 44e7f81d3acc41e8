// SPDX-License-Identifier: Apache-2.0
#include "kiosk/operator/redaction.h"

#include <algorithm>
#include <array>
#include <system_error>

#include "common/base/file.h"

namespace cyclorama::operations {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMinSecretLength = 4;
constexpr std::size_t kLongSecret = 24;
constexpr std::size_t kPiece = 16;
constexpr std::size_t kMaxSecretFileBytes = 256 * 1024;
constexpr std::size_t kMaxSecrets = 4000;
constexpr std::array<std::string_view, 11> kSecretWords{
    "pin", "password", "passwords", "passwd", "secret", "secrets", "token", "phrase", "key", "credential", "auth"};
// Settings that are not secrets, or that name the file of a secret.
constexpr std::array<std::string_view, 4> kHarmlessKeys{"key", "password_file", "token_file", "has_pin"};
constexpr std::array<std::string_view, 12> kOpenFiles{".toml", ".crt", ".png",   ".jpg", ".jpeg", ".obj",
                                                      ".pfm",  ".exr", ".mpcdi", ".xml", ".data", ".json"};

std::string lower(std::string_view text) {
  std::string result(text);
  for (char& c : result) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return result;
}

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r\n") - first + 1);
}

template <typename Use>
void for_each_line(std::string_view text, Use&& use) {
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    use(text.substr(at, end - at));
    at = end + 1;
  }
}

/// Returns where the value of "pin = ..." or "pin: ..." begins, in any notation, or npos.
std::size_t secret_value_at(std::string_view line) {
  const std::size_t sign = line.find_first_of("=:");
  if (sign == std::string_view::npos) return sign;
  std::string key = lower(line.substr(0, sign));
  key.erase(
      std::remove_if(key.begin(), key.end(), [](char c) { return c == '"' || c == '\'' || c == ' ' || c == '\t'; }),
      key.end());
  if (key.starts_with('#')) key.erase(0, 1);
  if (key.empty() || key.size() > 60) return std::string_view::npos;
  if (std::find(kHarmlessKeys.begin(), kHarmlessKeys.end(), key) != kHarmlessKeys.end()) return std::string_view::npos;
  const bool is_word = std::all_of(key.begin(), key.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_' || c == '-' || c == '.';
  });
  if (!is_word) return std::string_view::npos;
  // Matches "pin_code", but not "mapping".
  for (std::size_t at = 0; at < key.size();) {
    const std::size_t end = std::min(key.find_first_of("_-.", at), key.size());
    const std::string_view part = std::string_view(key).substr(at, end - at);
    if (std::find(kSecretWords.begin(), kSecretWords.end(), part) != kSecretWords.end()) return sign + 1;
    at = end + 1;
  }
  return std::string_view::npos;
}

bool begins_pem(std::string_view line) { return line.find("-----BEGIN ") != std::string_view::npos; }
bool ends_pem(std::string_view line) { return line.find("-----END ") != std::string_view::npos; }

}  // namespace

void Redaction::add_secret(std::string_view secret) {
  secret = trimmed(secret);
  if (secret.size() < kMinSecretLength || secrets_.size() >= kMaxSecrets) return;
  const std::string one(secret);
  if (std::find(secrets_.begin(), secrets_.end(), one) != secrets_.end()) return;
  const auto longer = [](const std::string& a, const std::string& b) { return a.size() > b.size(); };
  secrets_.insert(std::upper_bound(secrets_.begin(), secrets_.end(), one, longer), one);
  if (one.size() < kLongSecret) return;
  for (std::size_t at = 0; at + kPiece <= one.size(); ++at) pieces_.insert(one.substr(at, kPiece));
}

void Redaction::add_secrets_of(const fs::path& folder) {
  std::error_code failed;
  for (fs::recursive_directory_iterator entry(folder, failed), end; !failed && entry != end; entry.increment(failed)) {
    const std::string extension = lower(entry->path().extension().string());
    const bool is_open = std::find(kOpenFiles.begin(), kOpenFiles.end(), extension) != kOpenFiles.end();
    if (is_open || entry->path().filename().string().starts_with(".")) continue;
    const auto text = read_text_file(entry->path(), kMaxSecretFileBytes);
    if (!text) continue;  // A file that this program may not read cannot get into its texts.
    for_each_line(*text, [&](std::string_view line) {
      if (!begins_pem(line) && !ends_pem(line)) add_secret(line);
    });
  }
}

std::string Redaction::without_pieces(const std::string& text) const {
  if (pieces_.empty()) return text;
  const std::string_view whole(text);
  const auto is_piece = [&](std::size_t at) {
    return at + kPiece <= whole.size() && pieces_.contains(whole.substr(at, kPiece));
  };
  std::string result;
  for (std::size_t at = 0; at < whole.size();) {
    if (!is_piece(at)) {
      result += whole[at++];
      continue;
    }
    std::size_t last = at;
    while (is_piece(last + 1)) ++last;
    result += kRedacted;
    at = last + kPiece;
  }
  return result;
}

std::string Redaction::cleaned(std::string_view text) const {
  std::string result;
  bool is_pem = false;
  for_each_line(text, [&](std::string_view line) {
    if (begins_pem(line)) is_pem = true;
    if (is_pem) {
      if (ends_pem(line)) {
        is_pem = false;
        result += std::string(kRedacted) + "\n";
      }
      return;
    }
    const std::size_t value = secret_value_at(line);
    if (value == std::string_view::npos) {
      result += std::string(line) + "\n";
    } else {
      result += std::string(line.substr(0, value)) + " " + kRedacted + "\n";
    }
  });
  if (is_pem) result += std::string(kRedacted) + "\n";  // The block lacks its end because the text was cut.
  for (const std::string& secret : secrets_) {
    for (std::size_t at = 0; (at = result.find(secret, at)) != std::string::npos;) {
      result.replace(at, secret.size(), kRedacted);
      at += std::string_view(kRedacted).size();
    }
  }
  return without_pieces(result);
}

}  // namespace cyclorama::operations
