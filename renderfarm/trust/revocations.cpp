// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/trust/revocations.h"

#include <ctime>

#include "common/wire/openssl.h"

namespace cyclorama::trust {

Result<Revocations> Revocations::parse(std::string_view pem, std::string_view authority_pem) {
  TRY_ASSIGN(const OpensslCertificate authority, parse_certificate(authority_pem));
  const OpensslRevocations list(PEM_read_bio_X509_CRL(bio_of(pem).get(), nullptr, nullptr, nullptr));
  if (list == nullptr) return Error(ErrorCode::kBadData, "is not a list of revoked certificates in PEM form");
  if (X509_CRL_verify(list.get(), X509_get0_pubkey(authority.get())) != 1) {
    return Error(ErrorCode::kBadData, "was not signed by the farm's authority");
  }
  Revocations revocations;
  STACK_OF(X509_REVOKED)* const entries = X509_CRL_get_REVOKED(list.get());
  for (int i = 0; i < sk_X509_REVOKED_num(entries); ++i) {  // -1 for an empty list.
    revocations.serials_.insert(serial_text(X509_REVOKED_get0_serialNumber(sk_X509_REVOKED_value(entries, i))));
  }
  const ASN1_TIME* const next = X509_CRL_get0_nextUpdate(list.get());
  std::tm parts{};
  if (next != nullptr && ASN1_TIME_to_tm(next, &parts) == 1) {
    revocations.next_update_ = day_text(next);
    revocations.good_until_ = std::chrono::system_clock::from_time_t(::timegm(&parts));
  }
  return revocations;
}

bool Revocations::is_out_of_date() const { return std::chrono::system_clock::now() > good_until_; }

}  // namespace cyclorama::trust
