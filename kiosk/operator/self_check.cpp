// SPDX-License-Identifier: Apache-2.0
#include "kiosk/operator/self_check.h"

#include <fmt/format.h>
#include <httplib.h>

#include "common/base/address.h"

namespace cyclorama::operations {
namespace {

/// Returns the address under which this computer reaches a page that listens at `listen`.
std::string own_host(const std::string& listen) {
  const auto address = parse_address(listen);
  if (!address) return listen;
  if (address->host == "::") return "::1";
  return address->host == "0.0.0.0" ? "127.0.0.1" : address->host;
}

template <typename Client>
Status answered(Client& client, std::chrono::milliseconds timeout) {
  client.set_connection_timeout(timeout);
  client.set_read_timeout(timeout);
  client.set_write_timeout(timeout);
  // Without a login a page with a PIN redirects this request to the login page, which is an answer as well.
  const auto answer = client.Get("/");
  if (answer && answer->status < 400) return Done{};
  return Error(ErrorCode::kTimedOut,
               fmt::format("the page does not answer itself: {}", answer ? fmt::format("HTTP status {}", answer->status)
                                                                         : httplib::to_string(answer.error())));
}

}  // namespace

SelfCheck::SelfCheck(const std::string& listen, int port, Transport transport, std::chrono::milliseconds timeout)
    : host_(own_host(listen)), port_(port), transport_(transport), timeout_(timeout) {}

Status SelfCheck::run() const {
  if (transport_ == kTls) {
    httplib::SSLClient client(host_, port_);
    client.enable_server_certificate_verification(false);
    return answered(client, timeout_);
  }
  httplib::Client client(host_, port_);
  return answered(client, timeout_);
}

}  // namespace cyclorama::operations
