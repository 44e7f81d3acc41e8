// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <openssl/ssl.h>

#include <memory>
#include <string>
#include <string_view>

#include "common/base/unique_fd.h"

namespace cyclorama {

/// Bytes over a socket that never blocks, with or without TLS. Thread-bound.
class HttpChannel {
 public:
  enum class Progress {
    kDone,
    kWantsInput,   ///< To be called again when the socket is readable.
    kWantsOutput,  ///< To be called again when the socket is writable.
    kClosed,       ///< The client is gone or violates the protocol.
  };

  /// `socket` is non-blocking. `tls` is borrowed; null: no TLS.
  HttpChannel(UniqueFd socket, SSL_CTX* tls);

  /// Until this is done, neither read() nor write() may be called.
  Progress handshake();
  /// Appends what has arrived to `bytes`, which it lets grow to `max_bytes`. kDone: it is that long now.
  Progress read(std::string* bytes, std::size_t max_bytes);
  /// Sends the front of `bytes` and removes it. kDone: all was sent.
  Progress write(std::string_view* bytes);
  /// Announces to the client that nothing more follows.
  void end_output();

  [[nodiscard]] int fd() const { return socket_.get(); }

 private:
  [[nodiscard]] Progress progress_of(int ssl_result) const;

  struct Free {
    void operator()(SSL* ssl) const { SSL_free(ssl); }
  };
  UniqueFd socket_;
  std::unique_ptr<SSL, Free> ssl_;
};

}  // namespace cyclorama
