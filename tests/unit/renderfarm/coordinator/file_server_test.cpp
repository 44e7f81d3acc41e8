// SPDX-License-Identifier: Apache-2.0
// Files from a coordinator to a node's cache, over real gRPC on [::1].
#include "renderfarm/coordinator/file_server.h"

#include <gmock/gmock.h>
#include <grpcpp/create_channel.h>
#include <gtest/gtest.h>

#include <future>

#include "common/wire/channel.h"
#include "common/wire/nodes.grpc.pb.h"
#include "renderfarm/node/scene_fetcher.h"
#include "tests/data_sets/scene_folder.h"
#include "tests/support/test_authority.h"

namespace cyclorama::coordinator {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

/// The file distribution of a coordinator.
class ServingCoordinator {
 public:
  explicit ServingCoordinator(const fs::path& scene, FileServer::Options options = {}, int port = 0,
                              const ServerOptions& serving = {})
      : library_({{"grotto", scene}}, {},
                 [this](const scene_distribution::SceneLibrary::News& news) { on_news(news); }),
        files_(library_, options) {
    auto server = WireServer::start("[::1]:" + std::to_string(port), {&service_}, serving);
    CHECK(server);
    server_ = *std::move(server);
  }
  ~ServingCoordinator() {
    files_.stop();
    server_->stop(std::chrono::milliseconds(200));
  }
  ServingCoordinator(const ServingCoordinator&) = delete;
  ServingCoordinator& operator=(const ServingCoordinator&) = delete;

  [[nodiscard]] int port() const { return server_->port(); }
  [[nodiscard]] std::shared_ptr<grpc::Channel> dial(const std::optional<TlsFiles>& tls = std::nullopt) const {
    return *make_channel("[::1]:" + std::to_string(port()), tls);
  }
  [[nodiscard]] std::string digest() { return digest_.get_future().get(); }
  [[nodiscard]] std::string complaint() { return complaint_.get_future().get(); }
  FileServer& files() { return files_; }

 private:
  class Service final : public wire::Nodes::CallbackService {
   public:
    explicit Service(FileServer& files) : files_(files) {}
    grpc::ServerUnaryReactor* ListFiles(grpc::CallbackServerContext* context, const wire::ListFilesRequest* request,
                                        wire::SceneFiles* reply) override {
      return files_.list(context, *request, reply);
    }
    grpc::ServerWriteReactor<wire::FileChunk>* FetchFile(grpc::CallbackServerContext* context,
                                                         const wire::FetchFileRequest* request) override {
      return files_.fetch(context, *request);
    }

   private:
    FileServer& files_;
  };
  void on_news(const scene_distribution::SceneLibrary::News& news) {
    if (!news.digest.empty()) digest_.set_value(news.digest);
    if (news.digest.empty()) complaint_.set_value(news.sentence);
  }

  std::promise<std::string> digest_;
  std::promise<std::string> complaint_;
  scene_distribution::SceneLibrary library_;
  FileServer files_;
  Service service_{files_};
  std::unique_ptr<WireServer> server_;
};

/// A coordinator that gives the answers that a test chooses.
class LyingCoordinator final : public wire::Nodes::Service {
 public:
  explicit LyingCoordinator(wire::SceneFiles list, std::vector<wire::FileChunk> chunks)
      : list_(std::move(list)), chunks_(std::move(chunks)), server_(*WireServer::start("[::1]:0", {this})) {}
  ~LyingCoordinator() override { server_->stop(Duration::zero()); }
  LyingCoordinator(const LyingCoordinator&) = delete;
  LyingCoordinator& operator=(const LyingCoordinator&) = delete;
  [[nodiscard]] std::shared_ptr<grpc::Channel> dial() const {
    return *make_channel("[::1]:" + std::to_string(server_->port()));
  }

 private:
  grpc::Status ListFiles(grpc::ServerContext*, const wire::ListFilesRequest*, wire::SceneFiles* reply) override {
    *reply = list_;
    return grpc::Status::OK;
  }
  grpc::Status FetchFile(grpc::ServerContext*, const wire::FetchFileRequest*,
                         grpc::ServerWriter<wire::FileChunk>* writer) override {
    for (const wire::FileChunk& chunk : chunks_) writer->Write(chunk);
    return grpc::Status::OK;
  }
  const wire::SceneFiles list_;
  const std::vector<wire::FileChunk> chunks_;
  const std::unique_ptr<WireServer> server_;
};

wire::LoadScene order(const std::string& digest, const std::string& path = "") {
  wire::LoadScene load;
  load.set_scene("grotto");
  load.set_digest(digest);
  load.set_path(path);
  return load;
}

wire::FileChunk chunk(std::uint64_t offset, const std::string& data) {
  wire::FileChunk made;
  made.set_offset(offset);
  made.set_data(data);
  return made;
}

bool never() { return false; }
/// Returns true for a progress of 20 to 30 %.
bool is_under_way(const std::string& sentence) {
  return sentence.starts_with("fetching") && sentence.find(": 2") != std::string::npos;
}
void silently(const std::string&) {}

/// The file fetching of a node.
class FetchingNode {
 public:
  FetchingNode(std::shared_ptr<grpc::Channel> coordinator, const fs::path& cache)
      : coordinator_(std::move(coordinator)), fetcher_({cache, 0}) {}
  Result<scene_distribution::SceneCache::Held> find(const wire::LoadScene& order,
                                                    const std::function<void(std::string)>& on_news,
                                                    const std::function<bool()>& cancelled) {
    return fetcher_.find(order, coordinator_, on_news, cancelled);
  }

 private:
  const std::shared_ptr<grpc::Channel> coordinator_;
  node::SceneFetcher fetcher_;
};

/// A node's call for one file, which the test reads at its own pace.
class Transfer {
 public:
  Transfer(const std::shared_ptr<grpc::Channel>& coordinator, const std::string& sha256, std::uint64_t offset = 0)
      : stub_(wire::Nodes::NewStub(coordinator)), offset_(offset) {
    wire::FetchFileRequest request;
    request.set_sha256(sha256);
    request.set_offset(offset);
    context_.set_deadline(std::chrono::system_clock::now() + std::chrono::seconds(30));
    stream_ = stub_->FetchFile(&context_, request);
  }
  bool read() {
    wire::FileChunk piece;
    if (!stream_->Read(&piece)) return false;
    EXPECT_EQ(piece.offset(), offset_ + bytes_.size());
    EXPECT_LE(piece.data().size(), std::size_t{1} << 20);
    bytes_ += piece.data();
    return true;
  }
  grpc::Status end() {
    while (read()) {
    }
    return stream_->Finish();
  }
  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  const std::unique_ptr<wire::Nodes::Stub> stub_;
  const std::uint64_t offset_;
  grpc::ClientContext context_;
  std::unique_ptr<grpc::ClientReader<wire::FileChunk>> stream_;
  std::string bytes_;
};

/// Returns true if one more transfer gets a slot before a timeout.
bool finds_a_place(const std::shared_ptr<grpc::Channel>& channel, const std::string& file) {
  const SteadyClock clock;
  const TimePoint deadline = clock.now() + std::chrono::seconds(20);
  const std::uint64_t nothing_left = file.size();
  while (clock.now() < deadline) {
    if (Transfer(channel, scene_distribution::sha256_of(file), nothing_left).end().ok()) return true;
    clock.wait_until(clock.now() + std::chrono::milliseconds(20));
  }
  return false;
}

class ServedFiles : public testing::Test {
 protected:
  void SetUp() override {
    for (const auto& [path, bytes] : scene) write_bytes(folder / path, bytes);
  }
  [[nodiscard]] FetchingNode fetcher(std::shared_ptr<grpc::Channel> coordinator) const {
    return {std::move(coordinator), cache};
  }
  /// Returns the status of one call, and the number of bytes that it brings.
  static grpc::Status fetch(const ServingCoordinator& coordinator, const std::string& sha256, std::uint64_t offset,
                            std::string* ret_bytes) {
    Transfer transfer(coordinator.dial(), sha256, offset);
    const grpc::Status end = transfer.end();
    *ret_bytes += transfer.bytes();
    return end;
  }

  TemporaryFolder temporary;
  const fs::path folder = temporary.path() / "scene";
  const fs::path cache = temporary.path() / "cache";
  const std::string walls = noise_bytes(5'000'000, 1);
  const SceneBytes scene{{"scene.toml", "title = \"x\""}, {"walls.ply", walls}, {"a/b.png", "b"}, {"none", ""}};
};

TEST_F(ServedFiles, reach_an_empty_cache_completely) {
  ServingCoordinator coordinator(folder);
  FetchingNode node = fetcher(coordinator.dial());
  std::vector<std::string> told;
  const auto found = node.find(
      order(coordinator.digest()), [&](const std::string& s) { told.push_back(s); }, never);
  ASSERT_TRUE(found) << found.error().message();
  EXPECT_EQ(scene_in(found->path), scene);
  EXPECT_EQ(found->fetched_bytes, scene_distribution::bytes_of(files_of(scene)));
  EXPECT_EQ(coordinator.files().sent_bytes(), found->fetched_bytes);
  EXPECT_THAT(told, testing::Contains("fetching scene 'grotto': 100 %"));
}

TEST_F(ServedFiles, are_resumed_after_the_node_died) {
  ServingCoordinator coordinator(folder);
  const std::string digest = coordinator.digest();
  std::atomic<bool> enough = false;
  {
    FetchingNode first = fetcher(coordinator.dial());
    const auto broken = first.find(
        order(digest), [&](const std::string& sentence) { enough = enough || is_under_way(sentence); },
        [&] { return enough.load(); });
    ASSERT_FALSE(broken);
    EXPECT_EQ(broken.error().code(), ErrorCode::kUnavailable);
  }
  const auto came = fs::file_size(cache / "files" / (scene_distribution::sha256_of(walls) + ".part"));
  EXPECT_GT(came, 0u);
  EXPECT_LT(came, walls.size());
  FetchingNode second = fetcher(coordinator.dial());
  const auto found = second.find(order(digest), silently, never);
  ASSERT_TRUE(found);
  EXPECT_EQ(scene_in(found->path), scene);
  std::uint64_t had = came;
  for (const char* const small : {"a/b.png", "scene.toml"}) {  // The files that the list has before the walls.
    had += scene.at(small).size();
  }
  EXPECT_EQ(found->fetched_bytes + had, scene_distribution::bytes_of(files_of(scene)));
}

TEST_F(ServedFiles, are_resumed_after_the_coordinator_restarted) {
  // The rate is low, so that the coordinator can be stopped in the middle.
  auto coordinator = std::make_unique<ServingCoordinator>(folder, FileServer::Options{.bytes_per_second = 20e6});
  const int port = coordinator->port();
  const std::string digest = coordinator->digest();
  FetchingNode node = fetcher(coordinator->dial());
  std::promise<void> begun;
  bool is_begun = false;
  auto found = std::async(std::launch::async, [&] {
    return node.find(
        order(digest),
        [&](const std::string& sentence) {
          if (!is_begun && is_under_way(sentence)) begun.set_value();
          is_begun = is_begun || is_under_way(sentence);
        },
        never);
  });
  begun.get_future().wait();
  const std::uint64_t sent_before = coordinator->files().sent_bytes();
  EXPECT_LT(sent_before, scene_distribution::bytes_of(files_of(scene)));
  coordinator.reset();
  ServingCoordinator again(folder, {}, port);
  (void)again.digest();
  const auto held = found.get();
  ASSERT_TRUE(held) << held.error().message();
  EXPECT_EQ(scene_in(held->path), scene);
  EXPECT_LT(again.files().sent_bytes(), walls.size());
}

TEST_F(ServedFiles, that_belong_to_no_scene_are_not_served) {
  ServingCoordinator coordinator(folder);
  const std::string digest = coordinator.digest();
  std::string bytes;
  EXPECT_EQ(fetch(coordinator, scene_distribution::sha256_of("other"), 0, &bytes).error_code(),
            grpc::StatusCode::NOT_FOUND);
  EXPECT_EQ(fetch(coordinator, "../scene.toml", 0, &bytes).error_code(), grpc::StatusCode::NOT_FOUND);
  EXPECT_EQ(fetch(coordinator, scene_distribution::sha256_of(walls), walls.size() + 1, &bytes).error_code(),
            grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_TRUE(fetch(coordinator, scene_distribution::sha256_of(walls), walls.size(), &bytes).ok());
  EXPECT_EQ(bytes, "");
  EXPECT_TRUE(fetch(coordinator, scene_distribution::sha256_of(walls), walls.size() - 3, &bytes).ok());
  EXPECT_EQ(bytes, walls.substr(walls.size() - 3));
  FetchingNode node = fetcher(coordinator.dial());
  EXPECT_THAT(node.find(order(scene_distribution::sha256_of("x")), silently, never).error().message(),
              HasSubstr("no such scene"));
}

TEST_F(ServedFiles, that_were_changed_on_the_coordinator_are_refused) {
  ServingCoordinator coordinator(folder);
  const std::string digest = coordinator.digest();
  write_bytes(folder / "walls.ply", walls + "!");
  FetchingNode node = fetcher(coordinator.dial());
  const auto found = node.find(order(digest), silently, never);
  ASSERT_FALSE(found);
  EXPECT_THAT(found.error().message(), HasSubstr("'walls.ply' was changed on the coordinator"));
  EXPECT_THAT(found.error().message(), HasSubstr("restart the coordinator"));
}

TEST_F(ServedFiles, that_cannot_be_read_are_reported_and_retried) {
  fs::rename(folder / "scene.toml", folder / "elsewhere");
  ServingCoordinator coordinator(folder);
  EXPECT_THAT(coordinator.complaint(), HasSubstr("scene 'grotto' cannot be given to nodes"));
  fs::rename(folder / "elsewhere", folder / "scene.toml");
  EXPECT_EQ(coordinator.digest(), scene_distribution::digest_of(files_of(scene)));
}

TEST_F(ServedFiles, are_sent_to_a_limited_number_of_nodes_at_once) {
  ServingCoordinator coordinator(folder, {.streams = 1});
  const std::string digest = coordinator.digest();
  grpc::ChannelArguments narrow;  // Keeps a fast machine from buffering the whole file in a growing window.
  narrow.SetInt(GRPC_ARG_HTTP2_BDP_PROBE, 0);
  narrow.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
  const auto stub = wire::Nodes::NewStub(grpc::CreateCustomChannel("[::1]:" + std::to_string(coordinator.port()),
                                                                   grpc::InsecureChannelCredentials(), narrow));
  grpc::ClientContext context;
  wire::FetchFileRequest request;
  request.set_sha256(scene_distribution::sha256_of(walls));
  const auto slow = stub->FetchFile(&context, request);
  wire::FileChunk piece;
  ASSERT_TRUE(slow->Read(&piece));  // It holds its slot and reads no further.
  std::string bytes;
  EXPECT_EQ(fetch(coordinator, scene_distribution::sha256_of("b"), 0, &bytes).error_code(),
            grpc::StatusCode::RESOURCE_EXHAUSTED);
  FetchingNode node = fetcher(coordinator.dial());
  int asked = 0;
  const auto found = node.find(
      order(digest),
      [&](const std::string& sentence) {
        if (sentence.find("are being sent already; try again; trying again") != std::string::npos && ++asked == 2) {
          context.TryCancel();
        }
      },
      never);
  ASSERT_TRUE(found) << found.error().message();
  EXPECT_EQ(scene_in(found->path), scene);
}

TEST_F(ServedFiles, reach_many_nodes_at_once) {
  ServingCoordinator coordinator(folder);
  const std::string digest = coordinator.digest();
  std::vector<std::future<bool>> nodes;
  for (int i = 0; i < 6; ++i) {
    nodes.push_back(std::async(std::launch::async, [&, i] {
      FetchingNode node(coordinator.dial(), temporary.path() / std::to_string(i));
      const auto found = node.find(order(digest), silently, never);
      return found && scene_in(found->path) == scene;
    }));
  }
  for (auto& node : nodes) EXPECT_TRUE(node.get());
}

TEST_F(ServedFiles, stop_when_the_node_cancels_while_the_coordinator_is_silent) {
  ServingCoordinator coordinator(folder, {.bytes_per_second = 1.0});
  const std::string digest = coordinator.digest();
  FetchingNode node = fetcher(coordinator.dial());
  std::atomic<bool> enough = false;
  const auto found = node.find(
      order(digest), [&](const std::string& sentence) { enough = enough || sentence.starts_with("fetching"); },
      [&] { return enough.load(); });
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().code(), ErrorCode::kUnavailable);
}

TEST_F(ServedFiles, of_a_revoked_node_are_cut_off_and_those_of_others_are_not) {
  TestAuthority authority;
  // The rate is so low that no file is complete before it is cut.
  ServingCoordinator coordinator(
      folder, {.bytes_per_second = 5e6, .streams = 2}, 0,
      {.tls = authority.coordinator(), .admit = [](const Identity&) { return std::nullopt; }});
  (void)coordinator.digest();
  const auto other_node = coordinator.dial(authority.node("n2"));
  // Neither transfer is read any further, so neither ends by itself.
  Transfer revoked(coordinator.dial(authority.node("n1")), scene_distribution::sha256_of(walls));
  Transfer other(other_node, scene_distribution::sha256_of(walls));
  ASSERT_TRUE(revoked.read());
  ASSERT_TRUE(other.read());
  EXPECT_EQ(Transfer(other_node, scene_distribution::sha256_of(walls), walls.size()).end().error_code(),
            grpc::StatusCode::RESOURCE_EXHAUSTED);
  coordinator.files().cut([](const Identity& who) { return who.name == "n1"; });
  EXPECT_EQ(revoked.end().error_code(), grpc::StatusCode::CANCELLED);
  EXPECT_LT(revoked.bytes().size(), walls.size());
  EXPECT_TRUE(finds_a_place(other_node, walls));
  EXPECT_TRUE(other.end().ok());
  EXPECT_EQ(other.bytes(), walls);
}

TEST_F(ServedFiles, that_are_cut_off_before_their_turn_hold_no_slot) {
  ServingCoordinator coordinator(folder, {.bytes_per_second = 1.0, .streams = 1});
  (void)coordinator.digest();
  Transfer transfer(coordinator.dial(), scene_distribution::sha256_of(walls));
  ASSERT_TRUE(transfer.read()) << "the next piece is due in days";
  coordinator.files().cut([](const Identity&) { return true; });
  EXPECT_EQ(transfer.end().error_code(), grpc::StatusCode::CANCELLED);
  EXPECT_TRUE(finds_a_place(coordinator.dial(), walls));
}

TEST_F(ServedFiles, of_a_dishonest_coordinator_are_refused) {
  const SceneBytes small{{"scene.toml", "right"}};
  const wire::SceneFiles list = scene_distribution::to_wire(files_of(small));
  const std::string digest = scene_distribution::digest_of(files_of(small));
  const auto refusal = [&](const wire::SceneFiles& told, const std::vector<wire::FileChunk>& chunks) {
    fs::remove_all(cache);
    LyingCoordinator coordinator(told, chunks);
    FetchingNode node = fetcher(coordinator.dial());
    const auto found = node.find(order(digest), silently, never);
    EXPECT_FALSE(found);
    EXPECT_FALSE(fs::exists(cache / "files" / scene_distribution::sha256_of("right")));
    return found ? "" : found.error().message();
  };
  wire::SceneFiles outside = list;
  outside.mutable_files(0)->set_path("../../etc/passwd");
  EXPECT_THAT(refusal(outside, {}), HasSubstr("begins with a dot"));
  EXPECT_THAT(refusal(scene_distribution::to_wire({{"scene.toml", 5, scene_distribution::sha256_of("wrong")}}), {}),
              HasSubstr("not the requested one"));
  EXPECT_THAT(refusal({}, {}), HasSubstr("no files"));
  EXPECT_THAT(refusal(list, {chunk(0, "wrong")}), HasSubstr("bytes for 'scene.toml' that do not match its list"));
  EXPECT_THAT(refusal(list, {chunk(0, "right!")}), HasSubstr("more of 'scene.toml'"));
  EXPECT_THAT(refusal(list, {chunk(0, "ri"), chunk(3, "ght")}), HasSubstr("out of order"));
  EXPECT_THAT(refusal(list, {chunk(0, "ri")}), HasSubstr("less of 'scene.toml'"));
  LyingCoordinator honest(list, {chunk(0, "ri"), chunk(2, ""), chunk(2, "ght")});
  fs::remove_all(cache);
  FetchingNode node = fetcher(honest.dial());
  EXPECT_TRUE(node.find(order(digest), silently, never));
}

TEST_F(ServedFiles, need_a_slot) {
  const auto channel = *make_channel("[::1]:1");
  FetchingNode none(channel, {});
  EXPECT_THAT(none.find(order(scene_distribution::sha256_of("x")), silently, never).error().message(),
              HasSubstr("'cache' in node.toml"));
  EXPECT_EQ(none.find(order("", "/srv/x"), silently, never)->path, "/srv/x");
  FetchingNode node = fetcher(channel);
  EXPECT_THAT(node.find(order("../x"), silently, never).error().message(), HasSubstr("neither a path nor a digest"));
}

}  // namespace
}  // namespace cyclorama::coordinator
