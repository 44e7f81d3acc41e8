// SPDX-License-Identifier: Apache-2.0
#include "common/wire/tls.h"

#include <fmt/format.h>
#include <grpcpp/security/credentials.h>
#include <grpcpp/security/server_credentials.h>
#include <grpcpp/security/tls_certificate_provider.h>
#include <grpcpp/security/tls_credentials_options.h>
#include <openssl/ssl.h>

#include <utility>

#include "common/base/file.h"
#include "common/wire/openssl.h"

namespace cyclorama {
namespace {

constexpr std::size_t kMaxPemBytes = 1 << 20;
constexpr unsigned kReadAgainSeconds = 2;

/// Restricts OpenSSL to TLS 1.3. gRPC 1.51 requests TLS 1.2 or later from OpenSSL and offers no setting for it. But
/// every OpenSSL context starts with the "system default" section of the configuration, and gRPC does not enable
/// protocols that are disabled there. This process therefore installs a configuration of its own, in place of the
/// section in /etc/ssl/openssl.cnf.
bool speak_tls_1_3_only() {
  static const bool done = [] {
    constexpr std::string_view kConfiguration =
        "cyclorama = modules\n"
        "[modules]\n"
        "ssl_conf = ssl\n"
        "[ssl]\n"
        "system_default = defaults\n"
        "[defaults]\n"
        "Protocol = -ALL,TLSv1.3\n"
        "CipherString = DEFAULT:@SECLEVEL=2\n";
    // OpenSSL loads the installed configuration once; loaded later, it would replace this one.
    if (OPENSSL_init_ssl(OPENSSL_INIT_LOAD_CONFIG, nullptr) != 1) return false;
    const std::unique_ptr<CONF, OpensslFree<NCONF_free>> configuration(NCONF_new(nullptr));
    return configuration && NCONF_load_bio(configuration.get(), bio_of(kConfiguration).get(), nullptr) > 0 &&
           CONF_modules_load(configuration.get(), "cyclorama", 0) > 0;
  }();
  return done;
}

Error about(const std::filesystem::path& file, const std::string& what) {
  return Error(ErrorCode::kBadData, fmt::format("'{}' {}", file.string(), what));
}

Result<OpensslCertificate> read_certificate(const std::filesystem::path& file) {
  TRY_ASSIGN(const std::string pem, read_text_file(file, kMaxPemBytes));
  Result<OpensslCertificate> certificate = parse_certificate(pem);
  if (!certificate) return about(file, certificate.error().message());
  const ASN1_TIME* const first = X509_get0_notBefore(certificate->get());
  const ASN1_TIME* const last = X509_get0_notAfter(certificate->get());
  if (X509_cmp_current_time(last) < 0) {
    return about(file, fmt::format("expired on {}; renew it with cyclorama-authority", day_text(last)));
  }
  if (X509_cmp_current_time(first) > 0) {
    return about(file, fmt::format("is valid from {} on; check this machine's clock", day_text(first)));
  }
  return certificate;
}

auto watcher_of(const TlsFiles& files) {
  return std::make_shared<grpc::experimental::FileWatcherCertificateProvider>(
      files.key.string(), files.certificate.string(), files.authority.string(), kReadAgainSeconds);
}

/// Decides on every call; called by gRPC.
class Doorman final : public grpc::AuthMetadataProcessor {
 public:
  explicit Doorman(Admission admit) : admit_(std::move(admit)) {}
  [[nodiscard]] bool IsBlocking() const override { return false; }
  grpc::Status Process(const InputMetadata&, grpc::AuthContext* context, OutputMetadata*, OutputMetadata*) override {
    const Identity who = identity_of(*context);
    if (who.role == Role::kNobody) {
      return {grpc::StatusCode::PERMISSION_DENIED, "the certificate states no role, such as museum or node"};
    }
    const std::optional<std::string> refusal = admit_ ? admit_(who) : std::nullopt;
    return refusal ? grpc::Status(grpc::StatusCode::PERMISSION_DENIED, *refusal) : grpc::Status::OK;
  }

 private:
  const Admission admit_;
};

Status hold_to_tls_1_3() {
  if (speak_tls_1_3_only()) return Done{};
  return Error(ErrorCode::kSystem, "OpenSSL cannot be restricted to TLS 1.3; check /etc/ssl/openssl.cnf");
}

}  // namespace

Result<Identity> check(const TlsFiles& files) {
  TRY_ASSIGN(const OpensslCertificate authority, read_certificate(files.authority));
  TRY_ASSIGN(const OpensslCertificate certificate, read_certificate(files.certificate));
  TRY_ASSIGN(const std::string key_pem, read_text_file(files.key, kMaxPemBytes));
  // A key with a pass phrase would prompt on a terminal that nobody watches.
  const auto no_pass_phrase = [](char*, int, int, void*) { return -1; };
  const OpensslKey key(PEM_read_bio_PrivateKey(bio_of(key_pem).get(), nullptr, no_pass_phrase, nullptr));
  if (key == nullptr) return about(files.key, "is not a private key in PEM form without a pass phrase");
  if (X509_check_private_key(certificate.get(), key.get()) != 1) {
    return about(files.key,
                 fmt::format("is not the key of '{}'; take both from one bundle", files.certificate.string()));
  }
  if (X509_verify(certificate.get(), X509_get0_pubkey(authority.get())) != 1) {
    return about(files.certificate, fmt::format("was not made by the authority of '{}'", files.authority.string()));
  }
  TRY_ASSIGN(const std::string pem, read_text_file(files.certificate, kMaxPemBytes));
  Result<Identity> owner = identity_in(pem);
  if (!owner) return about(files.certificate, owner.error().message());
  return owner;
}

Result<std::shared_ptr<grpc::ChannelCredentials>> channel_credentials(const TlsFiles& files) {
  TRY(hold_to_tls_1_3());
  TRY(check(files));
  grpc::experimental::TlsChannelCredentialsOptions options;
  options.set_certificate_provider(watcher_of(files));
  options.watch_root_certs();
  options.watch_identity_key_cert_pairs();
  return grpc::experimental::TlsCredentials(options);
}

Result<std::shared_ptr<grpc::ServerCredentials>> server_credentials(const TlsFiles& files, Admission admit) {
  TRY(hold_to_tls_1_3());
  TRY_ASSIGN(const Identity owner, check(files));
  if (owner.role != Role::kCoordinator) {
    return Error(ErrorCode::kInvalidArgument,
                 fmt::format("'{}' is the certificate of {}; a server needs a coordinator's",
                             files.certificate.string(), to_text(owner)));
  }
  grpc::experimental::TlsServerCredentialsOptions options(watcher_of(files));
  options.watch_root_certs();
  options.watch_identity_key_cert_pairs();
  options.set_cert_request_type(GRPC_SSL_REQUEST_AND_REQUIRE_CLIENT_CERTIFICATE_AND_VERIFY);
  std::shared_ptr<grpc::ServerCredentials> credentials = grpc::experimental::TlsServerCredentials(options);
  credentials->SetAuthMetadataProcessor(std::make_shared<Doorman>(std::move(admit)));
  return credentials;
}

}  // namespace cyclorama
