// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <string>

#include "common/base/result.h"

namespace cyclorama::operations {

/// Requests this program's own page as a browser would, by the network and with TLS, which proves that it accepts
/// connections, reads requests and has workers for them. The certificate is not verified: no other program can have the
/// port. Thread-bound.
class SelfCheck {
 public:
  enum Transport { kPlain, kTls };

  /// `listen` is the page's address, of which the port may be 0; `port` is the one that it got.
  SelfCheck(const std::string& listen, int port, Transport transport,
            std::chrono::milliseconds timeout = std::chrono::seconds(5));
  /// Errors: kTimedOut, with a sentence, unless the page answered within the timeout.
  [[nodiscard]] Status run() const;

 private:
  const std::string host_;
  const int port_;
  const Transport transport_;
  const std::chrono::milliseconds timeout_;
};

}  // namespace cyclorama::operations
