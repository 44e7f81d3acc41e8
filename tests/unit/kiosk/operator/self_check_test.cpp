// SPDX-License-Identifier: Apache-2.0
#include "kiosk/operator/self_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <httplib.h>

#include <ctime>
#include <filesystem>
#include <future>
#include <thread>

#include "common/http/http_server.h"
#include "kiosk/operator/page_certificate.h"

namespace cyclorama::operations {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

/// A page with two workers, whose handlers hang as long as the test likes.
struct HangingPage {
  std::promise<void> promise;
  std::shared_future<void> end = promise.get_future().share();
  std::filesystem::path folder;
  std::unique_ptr<HttpServer> server;

  explicit HangingPage(const std::string& address) {
    std::string name = (std::filesystem::temp_directory_path() / "self-check-XXXXXX").string();
    CHECK(::mkdtemp(name.data()) != nullptr);
    folder = name;
    const auto certificate = page_certificate(folder, std::time(nullptr));
    CHECK(certificate);
    const auto routes = [wait = end](httplib::Server& handlers) {
      handlers.Get(
          "/", [](const httplib::Request&, httplib::Response& response) { response.set_redirect("/login.html", 303); });
      handlers.Get("/hang", [wait](const httplib::Request&, httplib::Response&) { wait.wait(); });
    };
    auto started =
        HttpServer::start(address, {.threads = 2}, routes, HttpTls{certificate->certificate_pem, certificate->key_pem});
    CHECK(started);
    server = *std::move(started);
  }
  ~HangingPage() { std::filesystem::remove_all(folder); }
  HangingPage(const HangingPage&) = delete;
  HangingPage& operator=(const HangingPage&) = delete;
};

TEST(SelfCheck, succeeds_when_the_page_answers_over_tls) {
  for (const char* const address : {"[::1]:0", "[::]:0", "127.0.0.1:0", "0.0.0.0:0"}) {
    const HangingPage page(address);
    const Status checked = SelfCheck(address, page.server->port(), SelfCheck::kTls).run();
    EXPECT_TRUE(checked) << address << ": " << checked.error().message();
  }
}

TEST(SelfCheck, fails_while_all_workers_hang) {
  HangingPage page("[::1]:0");
  const SelfCheck check("[::1]:0", page.server->port(), SelfCheck::kTls, 500ms);
  std::vector<std::thread> clients;
  clients.reserve(2);
  for (int i = 0; i < 2; ++i) {
    clients.emplace_back([&] {
      httplib::SSLClient client("::1", page.server->port());
      client.enable_server_certificate_verification(false);
      client.set_read_timeout(60s);
      EXPECT_TRUE(client.Get("/hang"));
    });
  }
  // The clients may take some time until they occupy both workers.
  Status checked = Done{};
  for (int i = 0; i < 1000 && checked; ++i) checked = check.run();
  ASSERT_FALSE(checked);
  EXPECT_THAT(checked.error().message(), HasSubstr("the page does not answer itself"));
  page.promise.set_value();
  for (std::thread& client : clients) client.join();
  EXPECT_TRUE(check.run());
}

TEST(SelfCheck, fails_when_nobody_listens) {
  int port = 0;
  {
    const HangingPage page("[::1]:0");
    port = page.server->port();
  }
  EXPECT_FALSE(SelfCheck("[::1]:0", port, SelfCheck::kTls, 500ms).run());
}

}  // namespace
}  // namespace cyclorama::operations
