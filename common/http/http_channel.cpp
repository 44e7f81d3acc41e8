// SPDX-License-Identifier: Apache-2.0
#include "common/http/http_channel.h"

#include <openssl/err.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <utility>

namespace cyclorama {
namespace {
constexpr std::size_t kChunkBytes = std::size_t{16} * 1024;  // The content of one TLS record.
}  // namespace

HttpChannel::HttpChannel(UniqueFd socket, SSL_CTX* tls) : socket_(std::move(socket)) {
  if (tls == nullptr) return;
  ssl_.reset(SSL_new(tls));
  if (ssl_ == nullptr) {
    socket_.reset();
    return;
  }
  SSL_set_fd(ssl_.get(), socket_.get());
  SSL_set_mode(ssl_.get(), SSL_MODE_ENABLE_PARTIAL_WRITE | SSL_MODE_ACCEPT_MOVING_WRITE_BUFFER);
  SSL_set_accept_state(ssl_.get());
}

HttpChannel::Progress HttpChannel::progress_of(int ssl_result) const {
  switch (SSL_get_error(ssl_.get(), ssl_result)) {
    case SSL_ERROR_WANT_READ:
      return Progress::kWantsInput;
    case SSL_ERROR_WANT_WRITE:
      return Progress::kWantsOutput;
    default:
      return Progress::kClosed;
  }
}

HttpChannel::Progress HttpChannel::handshake() {
  if (!socket_.is_open()) return Progress::kClosed;
  if (ssl_ == nullptr) return Progress::kDone;
  ERR_clear_error();
  const int result = SSL_accept(ssl_.get());
  return result == 1 ? Progress::kDone : progress_of(result);
}

HttpChannel::Progress HttpChannel::read(std::string* bytes, std::size_t max_bytes) {
  std::array<char, kChunkBytes> chunk;
  while (bytes->size() < max_bytes) {
    const std::size_t want = std::min(chunk.size(), max_bytes - bytes->size());
    ssize_t count = 0;
    if (ssl_ != nullptr) {
      ERR_clear_error();
      count = SSL_read(ssl_.get(), chunk.data(), static_cast<int>(want));
      if (count <= 0) return progress_of(static_cast<int>(count));
    } else {
      count = ::recv(socket_.get(), chunk.data(), want, 0);
      if (count < 0 && errno == EINTR) continue;
      if (count < 0 && errno == EAGAIN) return Progress::kWantsInput;
      if (count <= 0) return Progress::kClosed;
    }
    bytes->append(chunk.data(), static_cast<std::size_t>(count));
  }
  return Progress::kDone;
}

HttpChannel::Progress HttpChannel::write(std::string_view* bytes) {
  while (!bytes->empty()) {
    ssize_t count = 0;
    if (ssl_ != nullptr) {
      ERR_clear_error();
      count = SSL_write(ssl_.get(), bytes->data(), static_cast<int>(std::min(bytes->size(), kChunkBytes)));
      if (count <= 0) return progress_of(static_cast<int>(count));
    } else {
      count = ::send(socket_.get(), bytes->data(), bytes->size(), MSG_NOSIGNAL);
      if (count < 0 && errno == EINTR) continue;
      if (count < 0 && errno == EAGAIN) return Progress::kWantsOutput;
      if (count < 0) return Progress::kClosed;
    }
    bytes->remove_prefix(static_cast<std::size_t>(count));
  }
  return Progress::kDone;
}

void HttpChannel::end_output() {
  if (ssl_ != nullptr) SSL_shutdown(ssl_.get());
  ::shutdown(socket_.get(), SHUT_WR);
}

}  // namespace cyclorama
