// SPDX-License-Identifier: Apache-2.0
/// Owning pointers to OpenSSL's objects. Included only by .cpp files.
#pragma once

#include <openssl/bio.h>
#include <openssl/bn.h>
#include <openssl/conf.h>
#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/x509.h>

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>

#include "common/base/result.h"
#include "common/wire/identity.h"

namespace cyclorama {

template <auto Free>
struct OpensslFree {
  template <typename T>
  void operator()(T* object) const {
    Free(object);
  }
};
using OpensslBio = std::unique_ptr<BIO, OpensslFree<BIO_free>>;
using OpensslKey = std::unique_ptr<EVP_PKEY, OpensslFree<EVP_PKEY_free>>;
using OpensslCertificate = std::unique_ptr<X509, OpensslFree<X509_free>>;
using OpensslRevocations = std::unique_ptr<X509_CRL, OpensslFree<X509_CRL_free>>;

/// Returns a reader of `text`, which must outlive it.
inline OpensslBio bio_of(std::string_view text) {
  return OpensslBio(BIO_new_mem_buf(text.data(), static_cast<int>(text.size())));
}

/// Returns the text that `write`, one of OpenSSL's PEM writers, puts into a BIO; empty if it fails.
template <typename Write>
std::string pem_of(const Write& write) {
  const OpensslBio bio(BIO_new(BIO_s_mem()));
  if (bio == nullptr || write(bio.get()) != 1) return "";
  char* text = nullptr;
  const long bytes = BIO_get_mem_data(bio.get(), &text);
  return {text, static_cast<std::size_t>(bytes)};
}

/// Returns the first certificate of a PEM text. Errors: kBadData if there is none.
Result<OpensslCertificate> parse_certificate(std::string_view pem);
/// Returns the owner that a certificate's or a request's subject names. Errors: kBadData if it is not exactly one common
/// name and one known unit.
Result<Identity> identity_in_subject(const X509_NAME* subject);
/// Returns a serial number in hexadecimal, as printed by openssl.
[[nodiscard]] std::string serial_text(const ASN1_INTEGER* serial);
/// Returns a date such as "2029-02-24"; "?" for an invalid time.
[[nodiscard]] std::string day_text(const ASN1_TIME* time);

}  // namespace cyclorama
