// SPDX-License-Identifier: Apache-2.0
// Tests of a download from a real coordinator into a folder, over gRPC on [::1].
#include "kiosk/update/fetch_update.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/base/file.h"
#include "common/wire/channel.h"
#include "common/wire/updates.grpc.pb.h"
#include "renderfarm/coordinator/coordinator.h"
#include "tests/support/test_authority.h"

namespace cyclorama::update {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using Kind = FetchOutcome::Kind;

constexpr const char* kImage = "cyclorama-museum";
constexpr const char* kKernel = "cyclorama-museum_2.0.efi";
constexpr const char* kRoot = "cyclorama-museum_2.0_0b.root.raw";
constexpr const char* kHashes = "cyclorama-museum_2.0_0c.verity.raw";
constexpr std::size_t kRootBytes = 3'000'000;  // Several pieces.

/// A farm's folder of signed updates, and a museum's computer that requests them.
class Farm {
 public:
  Farm() {
    std::string folder = (fs::temp_directory_path() / "updates-XXXXXX").string();
    EXPECT_NE(::mkdtemp(folder.data()), nullptr);
    place_ = folder;
    fs::create_directories(updates());
    for (const char* const key : {"ours", "theirs"}) {
      openssl(std::string("genpkey -algorithm EC -pkeyopt ec_paramgen_curve:P-256 -out ") + key);
    }
    openssl("pkey -in ours -pubout -out key.pub");
    write(kKernel, "kernel");
    write(kHashes, "hashes");
    std::string root(kRootBytes, 'r');
    root[kRootBytes / 2] = 's';
    write(kRoot, root);
    sign("ours");
  }
  ~Farm() {
    if (coordinator_) coordinator_->stop();
    fs::remove_all(place_);
  }
  Farm(const Farm&) = delete;
  Farm& operator=(const Farm&) = delete;

  [[nodiscard]] fs::path place() const { return place_; }
  [[nodiscard]] fs::path updates() const { return place_ / "updates" / kImage; }
  [[nodiscard]] fs::path offer() const { return place_ / "museum" / "offer"; }
  void write(const std::string& name, const std::string& text) const {
    EXPECT_TRUE(write_file_atomically(updates() / name, std::string_view(text)));
  }
  void openssl(const std::string& words) const { output_of("cd '" + place_.string() + "' && openssl " + words); }
  void sign(const std::string& key) const {
    output_of("cd '" + updates().string() + "' && sha256sum *.efi *.raw >SHA256SUMS");
    openssl("dgst -sha256 -sign " + key + " -out '" + updates().string() + "/SHA256SUMS.sig' '" + updates().string() +
            "/SHA256SUMS'");
  }
  void start(trust::TrustOptions trust = {}) {
    coordinator::CoordinatorOptions options;
    options.scenes.push_back({.name = "grotto", .path = "/srv/grotto"});
    options.museums = options.nodes = "[::1]:0";
    options.updates = place_ / "updates";
    options.trust = std::move(trust);
    auto coordinator =
        coordinator::Coordinator::start(std::move(options), [](const std::string&, const coordinator::NoticeAbout&) {});
    CHECK(coordinator);
    coordinator_ = *std::move(coordinator);
  }
  [[nodiscard]] std::uint64_t sent_bytes() const { return coordinator_->sent_file_bytes(); }

  [[nodiscard]] FetchOrder order() const {
    return {.image = kImage,
            .version = "1.9",
            .key = place_ / "key.pub",
            .folder = offer(),
            .limits = {.keep_free_bytes = 0},
            .retry_after = std::chrono::milliseconds(20),
            .retries = 0};
  }
  [[nodiscard]] Result<FetchOutcome> fetch(
      const FetchOrder& order, const std::optional<TlsFiles>& tls = std::nullopt,
      const std::function<bool()>& go_on = [] { return true; }) const {
    auto client = client::UpdateClient::make({"[::1]:" + std::to_string(coordinator_->museum_port())}, tls);
    CHECK(client);
    return fetch_update(order, &*client, go_on);
  }

 private:
  fs::path place_;
  std::unique_ptr<coordinator::Coordinator> coordinator_;
};

std::string text_of(const fs::path& path) {
  const auto text = read_text_file(path, 1 << 24);
  return text ? *text : "";
}

TEST(FetchUpdate, fetches_a_newer_version_completely_and_nothing_twice) {
  Farm farm;
  farm.start();
  const auto outcome = farm.fetch(farm.order());
  ASSERT_TRUE(outcome) << outcome.error().message();
  EXPECT_EQ(outcome->kind, Kind::kReady);
  EXPECT_EQ(outcome->version, "2.0");
  for (const char* const name : {kKernel, kRoot, kHashes, "SHA256SUMS", "SHA256SUMS.sig"}) {
    EXPECT_EQ(text_of(farm.offer() / name), text_of(farm.updates() / name)) << name;
  }
  const std::uint64_t sent = farm.sent_bytes();
  EXPECT_EQ(farm.fetch(farm.order())->kind, Kind::kReady);
  EXPECT_EQ(farm.sent_bytes(), sent);
}

TEST(FetchUpdate, resumes_where_it_was_interrupted) {
  Farm farm;
  farm.start();
  int pieces = 0;
  const auto cut = farm.fetch(farm.order(), std::nullopt, [&] { return ++pieces < 4; });
  ASSERT_TRUE(cut) << cut.error().message();
  EXPECT_EQ(cut->kind, Kind::kLater);
  const std::uint64_t there = fs::file_size(farm.offer() / (std::string(kRoot) + ".part"));
  EXPECT_GT(there, 0u);
  EXPECT_LT(there, kRootBytes);
  pieces = 0;
  const auto outcome = farm.fetch(farm.order(), std::nullopt, [&] { return ++pieces > 0; });
  ASSERT_TRUE(outcome) << outcome.error().message();
  EXPECT_EQ(outcome->kind, Kind::kReady);
  EXPECT_EQ(text_of(farm.offer() / kRoot), text_of(farm.updates() / kRoot));
  constexpr std::uint64_t kPiece = 512 * 1024;
  EXPECT_EQ(static_cast<std::uint64_t>(pieces), (kRootBytes - there + kPiece - 1) / kPiece + 1)
      << "the rest, and the hashes";
}

TEST(FetchUpdate, discards_parts_of_another_version) {
  Farm farm;
  farm.start();
  int pieces = 0;
  ASSERT_EQ(farm.fetch(farm.order(), std::nullopt, [&] { return ++pieces < 4; })->kind, Kind::kLater);
  for (const char* const name : {kKernel, kRoot, kHashes}) {
    fs::rename(farm.updates() / name, farm.updates() / ("cyclorama-museum_2.1" + std::string(name).substr(20)));
  }
  farm.sign("ours");
  EXPECT_EQ(farm.fetch(farm.order())->version, "2.1");
  EXPECT_FALSE(fs::exists(farm.offer() / (std::string(kRoot) + ".part")));
}

TEST(FetchUpdate, fetches_again_what_was_damaged_on_this_disk) {
  Farm farm;
  farm.start();
  int pieces = 0;
  ASSERT_EQ(farm.fetch(farm.order(), std::nullopt, [&] { return ++pieces < 4; })->kind, Kind::kLater);
  const fs::path part = farm.offer() / (std::string(kRoot) + ".part");
  const auto there = fs::file_size(part);
  EXPECT_TRUE(write_file_atomically(part, std::string_view(std::string(there, 'x'))));
  const auto damaged = farm.fetch(farm.order());
  ASSERT_FALSE(damaged);
  EXPECT_EQ(damaged.error().code(), ErrorCode::kBadData);
  EXPECT_FALSE(fs::exists(part));
  EXPECT_EQ(farm.fetch(farm.order())->kind, Kind::kReady);
}

TEST(FetchUpdate, ignores_an_old_version_and_one_that_failed_here) {
  Farm farm;
  farm.start();
  FetchOrder order = farm.order();
  order.version = "2.0";
  EXPECT_EQ(farm.fetch(order)->kind, Kind::kNothing);
  order.version = "3";
  EXPECT_EQ(farm.fetch(order)->kind, Kind::kNothing) << "nobody goes back";
  order = farm.order();
  order.not_again = "2.0";
  EXPECT_THAT(farm.fetch(order)->sentence, HasSubstr("2.0 or a newer version was here already"));
  order.not_again = "3.0";  // The computer was rolled back, and the farm offers the previous version.
  EXPECT_THAT(farm.fetch(order)->sentence, HasSubstr("2.0 or a newer version was here already"));
  order = farm.order();
  order.image = "cyclorama-farm-host";
  EXPECT_THAT(farm.fetch(order)->sentence, HasSubstr("no version of 'cyclorama-farm-host'"));
  EXPECT_FALSE(fs::exists(farm.offer()));
  EXPECT_EQ(farm.sent_bytes(), 0u);
}

TEST(FetchUpdate, refuses_a_foreign_signature) {
  Farm farm;
  farm.sign("theirs");
  farm.start();
  const auto outcome = farm.fetch(farm.order());
  ASSERT_FALSE(outcome);
  EXPECT_EQ(outcome.error().code(), ErrorCode::kBadData);
  EXPECT_THAT(outcome.error().message(), HasSubstr("signature"));
  EXPECT_EQ(farm.sent_bytes(), 0u);
}

TEST(FetchUpdate, trusts_the_old_and_the_new_key_while_keys_are_changed) {
  Farm farm;
  farm.openssl("pkey -in theirs -pubout >>key.pub");
  farm.sign("theirs");
  farm.start();
  EXPECT_TRUE(farm.fetch(farm.order()));
}

TEST(FetchUpdate, refuses_a_file_that_differs_from_the_signed_one) {
  Farm farm;
  farm.write(kRoot, std::string(kRootBytes, 'q'));
  farm.start();
  const auto outcome = farm.fetch(farm.order());
  ASSERT_FALSE(outcome);
  EXPECT_EQ(outcome.error().code(), ErrorCode::kBadData);
  EXPECT_THAT(outcome.error().message(), HasSubstr(kRoot));
  EXPECT_FALSE(fs::exists(farm.offer() / kRoot));
  EXPECT_FALSE(fs::exists(farm.offer() / (std::string(kRoot) + ".part")));
}

TEST(FetchUpdate, refuses_files_over_the_limit_and_over_the_free_space) {
  Farm farm;
  farm.start();
  FetchOrder order = farm.order();
  order.limits.max_file_bytes = kRootBytes - 1;
  EXPECT_EQ(farm.fetch(order).error().code(), ErrorCode::kInvalidArgument);
  order = farm.order();
  order.limits.max_bytes = kRootBytes + 11;
  EXPECT_EQ(farm.fetch(order).error().code(), ErrorCode::kInvalidArgument);
  order = farm.order();
  order.limits.keep_free_bytes = std::uint64_t{1} << 60;
  const auto full = farm.fetch(order);
  ASSERT_FALSE(full);
  EXPECT_EQ(full.error().code(), ErrorCode::kSystem);
  EXPECT_THAT(full.error().message(), HasSubstr("room for"));
  EXPECT_EQ(farm.sent_bytes(), 0u);
}

TEST(FetchUpdate, serves_only_museums_with_the_grant) {
  TestAuthority authority;
  Farm farm;
  const fs::path museums = farm.place() / "museums.toml";
  EXPECT_TRUE(
      write_file_atomically(museums, std::string_view("[[museum]]\nname = \"hall-3\"\nscenes = [\"*\"]\n[[museum]]\n"
                                                      "name = \"hall-4\"\nscenes = [\"*\"]\nupdates = false\n")));
  farm.start({.tls = authority.coordinator(), .museums = museums});
  EXPECT_EQ(farm.fetch(farm.order(), authority.museum("hall-3"))->kind, Kind::kReady);
  for (const char* const other : {"hall-4", "hall-5"}) {
    const auto refused = farm.fetch(farm.order(), authority.museum(other));
    ASSERT_FALSE(refused) << other;
    EXPECT_EQ(refused.error().code(), ErrorCode::kInvalidArgument);
    EXPECT_THAT(refused.error().message(), HasSubstr("museums.toml"));
  }
  EXPECT_FALSE(farm.fetch(farm.order())) << "without a certificate";
}

/// A coordinator that replies with the test's offer.
class LyingCoordinator final : public wire::Updates::Service {
 public:
  explicit LyingCoordinator(wire::UpdateOffer offer) : offer_(std::move(offer)) {}
  grpc::Status Offer(grpc::ServerContext*, const wire::OfferUpdateRequest*, wire::UpdateOffer* reply) override {
    *reply = offer_;
    return grpc::Status::OK;
  }
  grpc::Status Fetch(grpc::ServerContext*, const wire::FetchUpdateRequest* request,
                     grpc::ServerWriter<wire::FileChunk>* writer) override {
    wire::FileChunk chunk;
    chunk.set_offset(request->offset() + shift);
    chunk.set_data(data);
    writer->Write(chunk);
    return grpc::Status::OK;
  }

  std::string data = "more than six bytes";
  std::uint64_t shift = 0;

 private:
  const wire::UpdateOffer offer_;
};

TEST(FetchUpdate, does_not_trust_announced_lengths_and_order) {
  const Farm farm;
  wire::UpdateOffer offer;
  offer.set_sums(text_of(farm.updates() / "SHA256SUMS"));
  offer.set_signature(text_of(farm.updates() / "SHA256SUMS.sig"));
  for (const std::uint64_t bytes : {std::uint64_t{6}, std::uint64_t{kRootBytes}, std::uint64_t{6}})
    offer.add_bytes(bytes);
  LyingCoordinator coordinator(offer);
  auto server = WireServer::start("[::1]:0", {&coordinator});
  ASSERT_TRUE(server);
  auto client = client::UpdateClient::make({"[::1]:" + std::to_string((*server)->port())}, std::nullopt);
  ASSERT_TRUE(client);
  const auto said = [&] {
    const auto outcome = fetch_update(farm.order(), &*client, [] { return true; });
    return outcome ? std::string("taken") : outcome.error().message();
  };
  EXPECT_THAT(said(), HasSubstr("sends more of"));
  coordinator.shift = 1;
  EXPECT_THAT(said(), HasSubstr("out of order"));
  coordinator.shift = 0;
  coordinator.data = "";
  EXPECT_THAT(said(), HasSubstr("ends after 0 of 6 bytes"));
  coordinator.data = "kornel";
  EXPECT_THAT(said(), HasSubstr("is not the file"));
}

TEST(FetchUpdate, reports_that_the_farm_is_unreachable) {
  const Farm farm;
  auto client = client::UpdateClient::make({"[::1]:1"}, std::nullopt);
  ASSERT_TRUE(client);
  const auto outcome = fetch_update(farm.order(), &*client, [] { return true; });
  ASSERT_FALSE(outcome);
  EXPECT_EQ(outcome.error().code(), ErrorCode::kUnavailable);
}

}  // namespace
}  // namespace cyclorama::update
