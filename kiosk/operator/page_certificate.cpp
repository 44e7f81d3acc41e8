// SPDX-License-Identifier: Apache-2.0
#include "kiosk/operator/page_certificate.h"

#include <fmt/format.h>
#include <openssl/rand.h>
#include <openssl/x509v3.h>
#include <unistd.h>

#include <array>
#include <memory>

#include "common/base/file.h"
#include "common/base/private_file.h"
#include "common/wire/openssl.h"

namespace cyclorama::operations {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxPemBytes = 64 * 1024;
// Phones refuse server certificates that are valid for more than 825 days.
constexpr long kValidS = 820L * 86400;
constexpr std::time_t kRenewBeforeS = 60L * 86400;

using Extension = std::unique_ptr<X509_EXTENSION, OpensslFree<X509_EXTENSION_free>>;

Error openssl_failed() { return {ErrorCode::kSystem, "OpenSSL cannot make the page's certificate"}; }

OpensslKey read_key(const fs::path& path) {
  const auto pem = read_text_file(path, kMaxPemBytes);
  if (!pem) return nullptr;
  const auto no_pass_phrase = [](char*, int, int, void*) { return -1; };
  return OpensslKey(PEM_read_bio_PrivateKey(bio_of(*pem).get(), nullptr, no_pass_phrase, nullptr));
}

std::string fingerprint_of(X509* certificate) {
  std::array<unsigned char, EVP_MAX_MD_SIZE> bytes{};
  unsigned count = 0;
  if (X509_digest(certificate, EVP_sha256(), bytes.data(), &count) != 1) return "";
  std::string text;
  for (unsigned i = 0; i < count; ++i) text += fmt::format("{}{:02X}", i == 0 ? "" : ":", bytes[i]);
  return text;
}

/// Returns the names under which a browser may open the page.
std::string alternative_names() {
  std::array<char, 256> host{};
  std::string names = "DNS:cyclorama,DNS:cyclorama.local,DNS:localhost,IP:::1,IP:127.0.0.1";
  if (::gethostname(host.data(), host.size() - 1) != 0) return names;
  const std::string name(host.data());
  const bool is_plain =
      !name.empty() && name.size() < 64 &&
      name.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-.") == std::string::npos;
  return is_plain ? names + fmt::format(",DNS:{},DNS:{}.local", name, name) : names;
}

bool add_extension(X509* certificate, int kind, const std::string& value) {
  X509V3_CTX context;
  X509V3_set_ctx_nodb(&context);
  X509V3_set_ctx(&context, certificate, certificate, nullptr, nullptr, 0);
  const Extension extension(X509V3_EXT_conf_nid(nullptr, &context, kind, value.c_str()));
  return extension && X509_add_ext(certificate, extension.get(), -1) == 1;
}

OpensslCertificate made_certificate(EVP_PKEY* key, std::time_t now) {
  OpensslCertificate certificate(X509_new());
  std::uint64_t serial = 0;
  if (!certificate || RAND_bytes(reinterpret_cast<unsigned char*>(&serial), sizeof serial) != 1) return nullptr;
  X509* const x = certificate.get();
  X509_NAME* const name = X509_get_subject_name(x);
  const std::string common = "Cyclorama operator page";
  const auto* const bytes = reinterpret_cast<const unsigned char*>(common.data());
  std::time_t from = now - 86400;
  const bool all =
      X509_set_version(x, X509_VERSION_3) == 1 && ASN1_INTEGER_set_uint64(X509_get_serialNumber(x), serial >> 1) == 1 &&
      X509_time_adj_ex(X509_getm_notBefore(x), 0, 0, &from) != nullptr &&
      X509_time_adj_ex(X509_getm_notAfter(x), 0, kValidS, &from) != nullptr &&
      X509_NAME_add_entry_by_txt(name, "CN", MBSTRING_UTF8, bytes, static_cast<int>(common.size()), -1, 0) == 1 &&
      X509_set_issuer_name(x, name) == 1 && X509_set_pubkey(x, key) == 1 &&
      add_extension(x, NID_subject_alt_name, alternative_names()) &&
      add_extension(x, NID_basic_constraints, "critical,CA:FALSE") &&
      add_extension(x, NID_key_usage, "critical,digitalSignature") &&
      add_extension(x, NID_ext_key_usage, "serverAuth") && X509_sign(x, key, EVP_sha256()) > 0;
  return all ? std::move(certificate) : nullptr;
}

bool is_good(X509* certificate, EVP_PKEY* key, std::time_t now) {
  std::time_t soon = now + kRenewBeforeS;
  return X509_check_private_key(certificate, key) == 1 && X509_cmp_time(X509_get0_notAfter(certificate), &soon) > 0 &&
         X509_cmp_time(X509_get0_notBefore(certificate), &now) < 0;
}

}  // namespace

bool is_to_be_renewed(const PageCertificate& page, std::time_t now) {
  const auto certificate = parse_certificate(page.certificate_pem);
  const OpensslKey key(PEM_read_bio_PrivateKey(bio_of(page.key_pem).get(), nullptr, nullptr, nullptr));
  return !certificate || !is_good(certificate->get(), key.get(), now);
}

Result<PageCertificate> page_certificate(const fs::path& folder, std::time_t now) {
  const fs::path key_file = folder / "page.key";
  const fs::path certificate_file = folder / "page.crt";
  PageCertificate page;
  OpensslKey key = read_key(key_file);
  const bool is_new_key = key == nullptr;
  if (is_new_key) key.reset(EVP_PKEY_Q_keygen(nullptr, nullptr, "EC", "P-256"));
  if (key == nullptr) return openssl_failed();
  page.key_pem = pem_of(
      [&](BIO* bio) { return PEM_write_bio_PKCS8PrivateKey(bio, key.get(), nullptr, nullptr, 0, nullptr, nullptr); });
  if (is_new_key) TRY(write_private_file(key_file, page.key_pem));
  OpensslCertificate certificate;
  if (const auto pem = read_text_file(certificate_file, kMaxPemBytes)) {
    auto known = parse_certificate(*pem);
    if (known && is_good(known->get(), key.get(), now)) certificate = *std::move(known);
  }
  const bool is_new = certificate == nullptr;
  if (is_new) certificate = made_certificate(key.get(), now);
  if (certificate == nullptr) return openssl_failed();
  page.certificate_pem = pem_of([&](BIO* bio) { return PEM_write_bio_X509(bio, certificate.get()); });
  if (is_new) TRY(write_file_atomically(certificate_file, std::string_view(page.certificate_pem)));
  page.fingerprint = fingerprint_of(certificate.get());
  page.until = day_text(X509_get0_notAfter(certificate.get()));
  if (page.key_pem.empty() || page.certificate_pem.empty()) return openssl_failed();
  return page;
}

}  // namespace cyclorama::operations
