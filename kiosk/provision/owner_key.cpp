// SPDX-License-Identifier: Apache-2.0
#include "kiosk/provision/owner_key.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <memory>
#include <system_error>
#include <vector>

#include "common/base/file.h"
#include "common/base/unique_fd.h"
#include "common/wire/openssl.h"
#include "kiosk/provision/folder_copy.h"

namespace cyclorama::provision {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxOwnerKeyBytes = std::size_t{16} * 1024;
constexpr std::size_t kSignatureBytes = 64;
constexpr std::size_t kSignatureLetters = 88;  // In base64.
using Context = std::unique_ptr<EVP_MD_CTX, OpensslFree<EVP_MD_CTX_free>>;

const unsigned char* raw(std::string_view text) { return reinterpret_cast<const unsigned char*>(text.data()); }

std::string text_of(BIO* bio) {
  char* data = nullptr;
  const long size = BIO_get_mem_data(bio, &data);
  return std::string(data, static_cast<std::size_t>(std::max(size, 0L)));
}

/// Writes a new private key, which nobody else may read at any moment.
Status make_key(const fs::path& path) {
  const OpensslKey made(EVP_PKEY_Q_keygen(nullptr, nullptr, "ED25519"));
  const OpensslBio bio(BIO_new(BIO_s_mem()));
  if (!made || !bio || PEM_write_bio_PrivateKey(bio.get(), made.get(), nullptr, nullptr, 0, nullptr, nullptr) != 1)
    return Error(ErrorCode::kSystem, "OpenSSL cannot make an Ed25519 key");
  const UniqueFd fd(::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600));
  if (!fd.is_open()) return Error::from_errno(fmt::format("making the key '{}'", path.string()));
  const std::string pem = text_of(bio.get());
  if (::write(fd.get(), pem.data(), pem.size()) != static_cast<ssize_t>(pem.size()) || ::fsync(fd.get()) != 0)
    return Error::from_errno(fmt::format("writing the key '{}'", path.string()));
  return Done{};
}

Result<OpensslKey> read_key(const fs::path& path) {
  TRY_ASSIGN(const std::string pem, read_text_file(path, kMaxOwnerKeyBytes));
  const OpensslBio bio = bio_of(pem);
  OpensslKey key(PEM_read_bio_PrivateKey(bio.get(), nullptr, nullptr, nullptr));
  if (key && EVP_PKEY_is_a(key.get(), "ED25519") == 1) return key;
  return Error(
      ErrorCode::kBadData,
      fmt::format("'{}' is no key of 'cyclorama sign-stick'; name another file, which is then made", path.string()));
}

Result<std::string> signature_of(std::string_view text, EVP_PKEY* key) {
  const Context context(EVP_MD_CTX_new());
  std::array<unsigned char, kSignatureBytes> signature{};
  std::size_t size = signature.size();
  if (!context || EVP_DigestSignInit(context.get(), nullptr, nullptr, nullptr, key) != 1 ||
      EVP_DigestSign(context.get(), signature.data(), &size, raw(text), text.size()) != 1) {
    return Error(ErrorCode::kSystem, "OpenSSL cannot sign with Ed25519");
  }
  std::array<unsigned char, kSignatureLetters + 1> letters{};
  EVP_EncodeBlock(letters.data(), signature.data(), static_cast<int>(size));
  return std::string(reinterpret_cast<const char*>(letters.data())) + "\n";
}

/// Lists a stick's files as the museum's copy of it will have them.
Result<std::vector<CopiedFile>> files_of(const fs::path& folder) {
  std::string copy = (fs::temp_directory_path() / "stick-XXXXXX").string();
  if (::mkdtemp(copy.data()) == nullptr) return Error::from_errno(fmt::format("making the folder '{}'", copy));
  auto copied = copy_folder(folder, copy);
  std::error_code ignored;
  fs::remove_all(copy, ignored);
  if (!copied) return std::move(copied).error();
  return std::move(copied->files);
}

}  // namespace

bool is_signed_by(std::string_view text, std::string_view signature, std::string_view public_pem) {
  while (!signature.empty() && (signature.back() == '\n' || signature.back() == '\r')) signature.remove_suffix(1);
  if (signature.size() != kSignatureLetters || public_pem.size() > kMaxOwnerKeyBytes) return false;
  // The two '=' at the end stand for two bytes that OpenSSL decodes as zeros.
  std::array<unsigned char, kSignatureBytes + 2> bytes{};
  if (EVP_DecodeBlock(bytes.data(), raw(signature), static_cast<int>(signature.size())) !=
      static_cast<int>(bytes.size())) {
    return false;
  }
  const OpensslBio bio = bio_of(public_pem);
  const OpensslKey key(PEM_read_bio_PUBKEY(bio.get(), nullptr, nullptr, nullptr));
  const Context context(EVP_MD_CTX_new());
  return key && EVP_PKEY_is_a(key.get(), "ED25519") == 1 && context &&
         EVP_DigestVerifyInit(context.get(), nullptr, nullptr, nullptr, key.get()) == 1 &&
         EVP_DigestVerify(context.get(), bytes.data(), kSignatureBytes, raw(text), text.size()) == 1;
}

Status sign_stick(const fs::path& folder, const fs::path& key) {
  std::error_code unknown;
  if (!fs::exists(key, unknown) && !unknown) TRY(make_key(key));
  TRY_ASSIGN(const OpensslKey owner, read_key(key));
  const OpensslBio bio(BIO_new(BIO_s_mem()));
  if (!bio || PEM_write_bio_PUBKEY(bio.get(), owner.get()) != 1)
    return Error(ErrorCode::kSystem, "OpenSSL cannot write a public key");
  const std::string public_pem = text_of(bio.get());
  TRY(write_file_atomically(folder / kOwnerKeyFile, std::string_view(public_pem)));
  TRY_ASSIGN(std::vector<CopiedFile> files, files_of(folder));
  std::erase_if(files,
                [](const CopiedFile& file) { return file.name == kChecksumsFile || file.name == kSignatureFile; });
  const std::string sums = checksums_text(files);
  TRY_ASSIGN(const std::string signature, signature_of(sums, owner.get()));
  TRY(write_file_atomically(folder / kChecksumsFile, std::string_view(sums)));
  return write_file_atomically(folder / kSignatureFile, std::string_view(signature));
}

}  // namespace cyclorama::provision
