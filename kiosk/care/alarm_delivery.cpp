// SPDX-License-Identifier: Apache-2.0
#include "kiosk/care/alarm_delivery.h"

#include <curl/curl.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <memory>
#include <string_view>
#include <utility>

#include "common/base/text.h"

namespace cyclorama::care {
namespace {

constexpr long kConnectTimeout_s = 15;
constexpr long kTimeout_s = 60;
constexpr std::size_t kMaxTrouble = 300;

using Handle = std::unique_ptr<CURL, decltype([](CURL* handle) { curl_easy_cleanup(handle); })>;
using Lines = std::unique_ptr<curl_slist, decltype([](curl_slist* list) { curl_slist_free_all(list); })>;

void add(Lines* lines, const std::string& line) { lines->reset(curl_slist_append(lines->release(), line.c_str())); }

/// Drops what a server answers.
std::size_t ignored(char*, std::size_t size, std::size_t count, void*) { return size * count; }

/// Gives libcurl the rest of a message.
std::size_t next_bytes(char* to, std::size_t size, std::size_t count, void* rest) {
  auto& text = *static_cast<std::string_view*>(rest);
  const std::size_t copied = text.copy(to, size * count);
  text.remove_prefix(copied);
  return copied;
}

/// One transfer with the limits and the trust that all of ours have.
class Transfer {
 public:
  Transfer(const std::string& url, const char* protocols, const std::filesystem::path& authority)
      : handle_(curl_easy_init()) {
    if (handle_ == nullptr) return;
    set(CURLOPT_URL, url.c_str());
    set(CURLOPT_PROTOCOLS_STR, protocols);
    set(CURLOPT_NOSIGNAL, 1L);
    set(CURLOPT_CONNECTTIMEOUT, kConnectTimeout_s);
    set(CURLOPT_TIMEOUT, kTimeout_s);
    set(CURLOPT_ERRORBUFFER, trouble_.data());
    set(CURLOPT_WRITEFUNCTION, ignored);
    set(CURLOPT_SSLVERSION, static_cast<long>(CURL_SSLVERSION_TLSv1_2));
    if (!authority.empty()) set(CURLOPT_CAINFO, authority.c_str());
  }
  template <typename Value>
  void set(CURLoption option, Value value) {
    if (handle_ != nullptr) curl_easy_setopt(handle_.get(), option, value);
  }
  /// Returns what libcurl reports, with a sentence.
  std::pair<CURLcode, std::string> perform() {
    if (handle_ == nullptr) return {CURLE_FAILED_INIT, "libcurl does not start"};
    const CURLcode code = curl_easy_perform(handle_.get());
    const std::string said = trouble_[0] != '\0' ? trouble_.data() : curl_easy_strerror(code);
    return {code, printable(said, kMaxTrouble)};
  }
  [[nodiscard]] long status() const {
    long status = 0;
    curl_easy_getinfo(handle_.get(), CURLINFO_RESPONSE_CODE, &status);
    return status;
  }

 private:
  Handle handle_;
  std::array<char, CURL_ERROR_SIZE> trouble_{};
};

Status trouble_of(CURLcode code, const std::string& said, const std::string& where) {
  switch (code) {
    case CURLE_OK:
      return Done{};
    case CURLE_LOGIN_DENIED:
      return Error(ErrorCode::kInvalidArgument,
                   fmt::format("{} refuses the login ({}); correct user and password_file in care.toml", where, said));
    case CURLE_SEND_ERROR:
    case CURLE_RECV_ERROR:
    case CURLE_WEIRD_SERVER_REPLY:
      return Error(ErrorCode::kUnavailable,
                   fmt::format("{} refuses the message ({}); see its own records", where, said));
    case CURLE_PEER_FAILED_VERIFICATION:
    case CURLE_SSL_CACERT_BADFILE:
      return Error(
          ErrorCode::kUnavailable,
          fmt::format("the certificate of {} is not trusted ({}); name its authority in care.toml", where, said));
    case CURLE_USE_SSL_FAILED:
    case CURLE_SSL_CONNECT_ERROR:
      return Error(
          ErrorCode::kUnavailable,
          fmt::format("{} does not encrypt as care.toml requires ({}); correct 'security' or the port", where, said));
    default:
      return Error(ErrorCode::kUnavailable,
                   fmt::format("{} cannot be reached ({}); see that its name and port are right, and that the museum's "
                               "network lets this computer through",
                               where, said));
  }
}

}  // namespace

Status send_mail(const MailSettings& mail, const std::string& message) {
  const bool is_tls = mail.security == MailSecurity::kTls;
  Transfer transfer((is_tls ? "smtps://" : "smtp://") + mail.server, "smtp,smtps", mail.authority);
  transfer.set(CURLOPT_USE_SSL,
               static_cast<long>(mail.security == MailSecurity::kNone ? CURLUSESSL_NONE : CURLUSESSL_ALL));
  std::string password;
  if (!mail.user.empty()) {
    TRY_ASSIGN(password, read_secret(mail.password_file));
    transfer.set(CURLOPT_USERNAME, mail.user.c_str());
    transfer.set(CURLOPT_PASSWORD, password.c_str());
  }
  transfer.set(CURLOPT_MAIL_FROM, mail.from.c_str());
  Lines receivers;
  for (const std::string& one : mail.to) add(&receivers, one);
  transfer.set(CURLOPT_MAIL_RCPT, receivers.get());
  std::string_view rest = message;
  transfer.set(CURLOPT_READFUNCTION, next_bytes);
  transfer.set(CURLOPT_READDATA, static_cast<void*>(&rest));
  transfer.set(CURLOPT_UPLOAD, 1L);
  const auto [code, said] = transfer.perform();
  return trouble_of(code, said, fmt::format("the mail server {}", mail.server));
}

Status send_webhook(const WebhookSettings& webhook, const std::string& json) {
  Transfer transfer(webhook.url, "http,https", webhook.authority);
  Lines headers;
  add(&headers, "Content-Type: application/json");
  if (!webhook.token_file.empty()) {
    TRY_ASSIGN(const std::string token, read_secret(webhook.token_file));
    add(&headers, "Authorization: Bearer " + token);
  }
  transfer.set(CURLOPT_HTTPHEADER, headers.get());
  transfer.set(CURLOPT_POSTFIELDS, json.c_str());
  transfer.set(CURLOPT_POSTFIELDSIZE_LARGE, static_cast<curl_off_t>(json.size()));
  const std::string where = fmt::format("the webhook {}", webhook.url.substr(0, webhook.url.find('?')));
  const auto [code, said] = transfer.perform();
  TRY(trouble_of(code, said, where));
  if (const long status = transfer.status(); status < 200 || status > 299) {
    return Error(ErrorCode::kUnavailable,
                 fmt::format("{} answers with {}; see that url and token_file in care.toml are right", where, status));
  }
  return Done{};
}

}  // namespace cyclorama::care
