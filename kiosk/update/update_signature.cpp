// SPDX-License-Identifier: Apache-2.0
#include "kiosk/update/update_signature.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <openssl/evp.h>
#include <openssl/pem.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <memory>
#include <vector>

#include "common/base/file.h"
#include "common/wire/openssl.h"

namespace cyclorama::update {
namespace {

constexpr std::size_t kMaxKeyBytes = 64 * 1024;
constexpr std::size_t kPieceBytes = std::size_t{1} << 20;
using Context = std::unique_ptr<EVP_MD_CTX, OpensslFree<EVP_MD_CTX_free>>;

const unsigned char* bytes_of(std::string_view text) { return reinterpret_cast<const unsigned char*>(text.data()); }

}  // namespace

Status check_signature(std::string_view text, std::string_view signature, const std::filesystem::path& key) {
  TRY_ASSIGN(const std::string pem, read_text_file(key, kMaxKeyBytes));
  const OpensslBio bio = bio_of(pem);
  bool has_key = false;
  while (const OpensslKey known{PEM_read_bio_PUBKEY(bio.get(), nullptr, nullptr, nullptr)}) {
    has_key = true;
    const Context context(EVP_MD_CTX_new());
    const bool is_ours =
        context && EVP_DigestVerifyInit(context.get(), nullptr, EVP_sha256(), nullptr, known.get()) == 1 &&
        EVP_DigestVerify(context.get(), bytes_of(signature), signature.size(), bytes_of(text), text.size()) == 1;
    if (is_ours) return Done{};
  }
  if (!has_key) return Error(ErrorCode::kBadData, fmt::format("'{}' is no public key", key.string()));
  return Error(ErrorCode::kBadData,
               "what the farm offers does not bear our signature; its operator copies image/build's folder once more");
}

Result<std::string> sha256_of_file(const std::filesystem::path& path) {
  const UniqueFd fd(::open(path.c_str(), O_RDONLY | O_NOFOLLOW | O_CLOEXEC));
  if (!fd.is_open()) return Error::from_errno(fmt::format("opening '{}'", path.string()));
  const Context context(EVP_MD_CTX_new());
  bool works = context && EVP_DigestInit_ex(context.get(), EVP_sha256(), nullptr) == 1;
  std::vector<unsigned char> piece(kPieceBytes);
  while (works) {
    const ssize_t n = ::read(fd.get(), piece.data(), piece.size());
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return Error::from_errno(fmt::format("reading '{}'", path.string()));
    if (n == 0) break;
    works = EVP_DigestUpdate(context.get(), piece.data(), static_cast<std::size_t>(n)) == 1;
  }
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned length = 0;
  if (!works || EVP_DigestFinal_ex(context.get(), digest.data(), &length) != 1) {
    return Error(ErrorCode::kSystem, "OpenSSL cannot make a SHA-256");
  }
  std::string text;
  for (unsigned i = 0; i < length; ++i) text += fmt::format("{:02x}", digest.at(i));
  return text;
}

}  // namespace cyclorama::update
