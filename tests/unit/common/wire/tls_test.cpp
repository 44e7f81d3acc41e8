// SPDX-License-Identifier: Apache-2.0
#include "common/wire/tls.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <mutex>

#include "common/base/file.h"
#include "common/wire/channel.h"
#include "common/wire/inspection_service.h"
#include "tests/support/test_authority.h"

namespace cyclorama {
namespace {

using testing::HasSubstr;
using testing::Not;

class Tls : public testing::Test {
 protected:
  void serve(const TlsFiles& files) {
    auto started = WireServer::start("[::1]:0", {&service_},
                                     {.tls = files, .admit = [this](const Identity& who) { return admit(who); }});
    ASSERT_TRUE(started) << started.error().message();
    server_ = *std::move(started);
  }
  [[nodiscard]] std::string address() const { return "[::1]:" + std::to_string(server_->port()); }
  grpc::Status call(const std::optional<TlsFiles>& files) {
    auto channel = make_channel(address(), files);
    EXPECT_TRUE(channel) << channel.error().message();
    const auto stub = wire::Inspection::NewStub(*channel);
    grpc::ClientContext context;
    context.set_deadline(std::chrono::system_clock::now() + std::chrono::seconds(10));
    wire::ProcessStatus status;
    return stub->GetStatus(&context, {}, &status);
  }
  /// Runs `openssl s_client` with these options, and waits a second for the server's reaction after the handshake. gRPC
  /// closes the connection of a client that it refuses; only with an accepted connection does s_client end by itself
  /// ("DONE").
  [[nodiscard]] std::string dial(const std::string& options) const {
    return output_of("sleep 1 | timeout 10 openssl s_client -alpn h2 -connect '" + address() + "' " + options);
  }
  static std::string options_of(const TlsFiles& files) {
    return "-CAfile " + files.authority.string() + " -cert " + files.certificate.string() + " -key " +
           files.key.string();
  }
  Identity last_seen() {
    const std::lock_guard lock(mutex_);
    return seen_;
  }

  TestAuthority authority_;

 private:
  std::optional<std::string> admit(const Identity& who) {
    const std::lock_guard lock(mutex_);
    seen_ = who;
    if (who.role == Role::kMuseum) return std::nullopt;
    return "museums only";
  }
  std::mutex mutex_;
  Identity seen_;
  InspectionService service_{"coordinator"};
  std::unique_ptr<WireServer> server_;
};

TEST_F(Tls, reports_the_peers_identity) {
  serve(authority_.coordinator());
  const TlsFiles museum = authority_.museum("hall-3");
  const grpc::Status status = call(museum);
  ASSERT_TRUE(status.ok()) << status.error_message();
  EXPECT_EQ(last_seen().name, "hall-3");
  EXPECT_EQ(last_seen().role, Role::kMuseum);
  EXPECT_THAT(authority_.run("list"), HasSubstr(last_seen().serial));
  EXPECT_EQ(check(museum)->serial, last_seen().serial);
}

TEST_F(Tls, checks_every_call_and_returns_the_reason) {
  serve(authority_.coordinator());
  const grpc::Status status = call(authority_.node("n1"));
  EXPECT_EQ(status.error_code(), grpc::StatusCode::PERMISSION_DENIED);
  EXPECT_EQ(status.error_message(), "museums only");
  EXPECT_EQ(last_seen().role, Role::kNode);
}

TEST_F(Tls, refuses_clients_without_a_certificate_of_its_authority) {
  serve(authority_.coordinator());
  EXPECT_FALSE(call(std::nullopt).ok());
  EXPECT_THAT(dial("-tls1_3"), Not(HasSubstr("DONE")));
  TestAuthority other;
  EXPECT_THAT(from_grpc(call(other.museum("hall-3")), "calling").message(), HasSubstr("not from this side's authority"))
      << "it does not believe the coordinator";
  TlsFiles mixed = other.museum("hall-4");
  mixed.authority = authority_.coordinator().authority;
  EXPECT_EQ(make_channel(address(), mixed).error().code(), ErrorCode::kBadData);
  EXPECT_THAT(dial("-tls1_3 " + options_of(mixed)), Not(HasSubstr("DONE")));
  EXPECT_EQ(last_seen().role, Role::kNobody) << "nobody came so far";
}

TEST_F(Tls, accepts_tls_1_3_only) {
  serve(authority_.coordinator());
  const std::string options = options_of(authority_.museum("hall-3"));
  const std::string welcome = dial("-tls1_3 " + options);
  EXPECT_THAT(welcome, HasSubstr("New, TLSv1.3"));
  EXPECT_THAT(welcome, HasSubstr("DONE"));
  const std::string older = dial("-tls1_2 " + options);
  EXPECT_THAT(older, HasSubstr("Cipher is (NONE)"));
  EXPECT_THAT(older, HasSubstr("no peer certificate available"));
}

TEST_F(Tls, refuses_a_coordinator_with_another_address) {
  serve(authority_.coordinator("farm.example.org"));
  EXPECT_THAT(from_grpc(call(authority_.museum("hall-3")), "calling").message(),
              HasSubstr("does not contain the address"));
}

TEST_F(Tls, uses_a_renewed_certificate_without_a_restart) {
  serve(authority_.coordinator());
  const auto served = [&] {
    return output_of("openssl s_client -connect '" + address() + "' </dev/null | openssl x509 -noout -serial");
  };
  const std::string before = served();
  const TlsFiles renewed = authority_.make("renew farm", "farm");
  const std::string serial = check(renewed)->serial;
  EXPECT_THAT(before, Not(HasSubstr(serial)));
  const TimePoint deadline = SteadyClock().now() + std::chrono::seconds(20);
  std::string now = before;
  while (now.find(serial) == std::string::npos && SteadyClock().now() < deadline) now = served();
  EXPECT_THAT(now, HasSubstr(serial));
  EXPECT_TRUE(call(authority_.museum("hall-3")).ok());
}

TEST_F(Tls, names_the_invalid_file) {
  const TlsFiles museum = authority_.museum("hall-3");
  const auto refusal_of = [](const TlsFiles& files) {
    const auto answer = check(files);
    return answer ? "" : answer.error().message();
  };
  EXPECT_EQ(refusal_of(museum), "");
  EXPECT_THAT(refusal_of({museum.authority, museum.certificate, "/nowhere/key.pem"}), HasSubstr("/nowhere/key.pem"));
  EXPECT_THAT(refusal_of({museum.authority, museum.certificate, museum.certificate}), HasSubstr("private key"));
  EXPECT_THAT(refusal_of({museum.authority, museum.certificate, authority_.node("n1").key}), HasSubstr("one bundle"));
  EXPECT_THAT(refusal_of({museum.key, museum.certificate, museum.key}), HasSubstr("not a certificate"));
  EXPECT_THAT(refusal_of({TestAuthority().museum("x").authority, museum.certificate, museum.key}), testing::Ne(""));
  EXPECT_THAT(WireServer::start("[::1]:0", {}, {.tls = museum}).error().message(),
              HasSubstr("a server needs a coordinator's"));
}

TEST(Identity, has_one_name_and_one_known_unit) {
  EXPECT_FALSE(identity_in(""));
  EXPECT_FALSE(identity_in("-----BEGIN CERTIFICATE-----\nAAAA\n-----END CERTIFICATE-----\n"));
  const auto made_for = [](const std::string& subject) {
    return identity_in(
        output_of("openssl req -x509 -newkey ec -pkeyopt ec_paramgen_curve:P-256 -noenc -keyout /dev/null "
                  "-subj '" +
                  subject + "' 2>/dev/null"));
  };
  EXPECT_EQ(made_for("/OU=node/CN=n1")->name, "n1");
  EXPECT_FALSE(made_for("/CN=n1"));
  EXPECT_FALSE(made_for("/OU=king/CN=n1"));
  EXPECT_FALSE(made_for("/OU=node/OU=museum/CN=n1"));
  EXPECT_FALSE(made_for("/OU=node/CN=n1/CN=n2"));
}

}  // namespace
}  // namespace cyclorama
