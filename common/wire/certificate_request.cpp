// SPDX-License-Identifier: Apache-2.0
#include "common/wire/certificate_request.h"

#include <fmt/format.h>
#include <openssl/ec.h>

#include <array>
#include <ctime>
#include <memory>

#include "common/wire/openssl.h"

namespace cyclorama {
namespace {

using OpensslRequest = std::unique_ptr<X509_REQ, OpensslFree<X509_REQ_free>>;
using OpensslName = std::unique_ptr<X509_NAME, OpensslFree<X509_NAME_free>>;

constexpr const char* kCurve = "prime256v1";  // OpenSSL's name of P-256.

Error openssl_failed(std::string_view doing) {
  return Error(ErrorCode::kSystem, fmt::format("OpenSSL cannot make {}", doing));
}

bool is_on_the_curve(const EVP_PKEY* key) {
  std::array<char, 64> curve{};
  std::size_t bytes = 0;
  return key != nullptr && EVP_PKEY_get_base_id(key) == EVP_PKEY_EC &&
         EVP_PKEY_get_group_name(key, curve.data(), curve.size(), &bytes) == 1 &&
         std::string_view(curve.data(), bytes) == kCurve;
}

bool add(X509_NAME* subject, const char* kind, std::string_view text) {
  return X509_NAME_add_entry_by_txt(subject, kind, MBSTRING_UTF8, reinterpret_cast<const unsigned char*>(text.data()),
                                    static_cast<int>(text.size()), -1, 0) == 1;
}

Result<OpensslRequest> parse_request(std::string_view pem) {
  OpensslRequest request(PEM_read_bio_X509_REQ(bio_of(pem).get(), nullptr, nullptr, nullptr));
  if (request == nullptr) return Error(ErrorCode::kBadData, "this is not a certificate request in PEM form");
  return request;
}

}  // namespace

Result<std::string> new_private_key() {
  const OpensslKey key(EVP_EC_gen(kCurve));
  std::string pem = pem_of(
      [&](BIO* bio) { return PEM_write_bio_PKCS8PrivateKey(bio, key.get(), nullptr, nullptr, 0, nullptr, nullptr); });
  if (key == nullptr || pem.empty()) return openssl_failed("a private key");
  return pem;
}

Result<std::string> certificate_request(std::string_view key_pem, const Identity& who) {
  const auto no_pass_phrase = [](char*, int, int, void*) { return -1; };
  const OpensslKey key(PEM_read_bio_PrivateKey(bio_of(key_pem).get(), nullptr, no_pass_phrase, nullptr));
  if (!is_on_the_curve(key.get())) return Error(ErrorCode::kBadData, "this is not a private key on P-256 in PEM form");
  const OpensslRequest request(X509_REQ_new());
  const OpensslName subject(X509_NAME_new());
  if (request == nullptr || subject == nullptr || !add(subject.get(), "OU", to_text(who.role)) ||
      !add(subject.get(), "CN", who.name) || X509_REQ_set_subject_name(request.get(), subject.get()) != 1 ||
      X509_REQ_set_pubkey(request.get(), key.get()) != 1 ||
      X509_REQ_sign(request.get(), key.get(), EVP_sha256()) == 0) {
    return openssl_failed("a certificate request");
  }
  std::string pem = pem_of([&](BIO* bio) { return PEM_write_bio_X509_REQ(bio, request.get()); });
  if (pem.empty()) return openssl_failed("a certificate request");
  return pem;
}

Result<Identity> identity_in_request(std::string_view request_pem) {
  TRY_ASSIGN(const OpensslRequest request, parse_request(request_pem));
  EVP_PKEY* const key = X509_REQ_get0_pubkey(request.get());
  if (!is_on_the_curve(key)) return Error(ErrorCode::kBadData, "the request's key is not on the curve P-256");
  if (X509_REQ_verify(request.get(), key) != 1) {
    return Error(ErrorCode::kBadData, "the request is not signed with its own key");
  }
  return identity_in_subject(X509_REQ_get_subject_name(request.get()));
}

bool is_for_request(std::string_view certificate_pem, std::string_view request_pem) {
  const auto certificate = parse_certificate(certificate_pem);
  const auto request = parse_request(request_pem);
  return certificate && request &&
         EVP_PKEY_eq(X509_get0_pubkey(certificate->get()), X509_REQ_get0_pubkey(request->get())) == 1;
}

Result<std::chrono::sys_seconds> end_of_certificate(std::string_view certificate_pem) {
  TRY_ASSIGN(const OpensslCertificate certificate, parse_certificate(certificate_pem));
  std::tm parts{};
  if (ASN1_TIME_to_tm(X509_get0_notAfter(certificate.get()), &parts) != 1) {
    return Error(ErrorCode::kBadData, "the certificate's last day cannot be read");
  }
  return std::chrono::sys_seconds(std::chrono::seconds(::timegm(&parts)));
}

}  // namespace cyclorama
