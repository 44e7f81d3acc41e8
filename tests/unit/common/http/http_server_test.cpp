// SPDX-License-Identifier: Apache-2.0
#include "common/http/http_server.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <httplib.h>

#include <future>

#include "tests/doubles/fake_clock.h"
#include "tests/support/raw_client.h"

namespace cyclorama {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using testing::StartsWith;

constexpr std::string_view kGet = "GET /small HTTP/1.1\r\nHost: localhost\r\n\r\n";

/// A server whose deadlines are over when the test decides so.
struct Served {
  FakeClock clock;
  std::unique_ptr<HttpServer> server;
  std::promise<void> hang;

  explicit Served(const HttpLimits& limits = {}, const std::string& address = "[::1]:0") {
    const auto may_end = std::make_shared<std::shared_future<void>>(hang.get_future().share());
    const auto routes = [may_end](httplib::Server& handlers) {
      handlers.Get("/small", [](const httplib::Request& request, httplib::Response& response) {
        response.set_content("from " + request.remote_addr, "text/plain");
      });
      handlers.Get("/large", [](const httplib::Request&, httplib::Response& response) {
        response.set_content(std::string(std::size_t{32} << 20, 'x'), "text/plain");
      });
      handlers.Get("/hang", [may_end](const httplib::Request&, httplib::Response&) { may_end->wait(); });
      handlers.Post("/echo", [](const httplib::Request& request, httplib::Response& response) {
        response.set_content(request.body, "text/plain");
      });
      handlers.Get("/busy", [](const httplib::Request&, httplib::Response& response) {
        answer_error(Error(ErrorCode::kBusy, "four \xff watch"), response);
      });
    };
    auto started = HttpServer::start(address, limits, routes, std::nullopt, clock);
    CHECK(started);
    server = *std::move(started);
  }
  /// Lets time pass until the server closes the connection. The client sends `text` meanwhile.
  bool closes(const RawClient& client, std::string_view text = {}) {
    for (int i = 0; i < 1000 && !client.is_readable(20); ++i) {
      clock.advance(4s);
      client.send(text);
    }
    return client.is_closed();
  }
  [[nodiscard]] RawClient client(const char* address = "::1") const { return RawClient(address, server->port()); }
};

TEST(HttpServer, maps_error_codes_to_http_status) {
  const Served served;
  httplib::Client client("::1", served.server->port());
  const auto busy = client.Get("/busy");
  ASSERT_TRUE(busy);
  EXPECT_EQ(busy->status, 429);
  EXPECT_NE(busy->body.find("four \uFFFD watch"), std::string::npos) << "always UTF-8: " << busy->body;
  EXPECT_EQ(client.Get("/nothing")->status, 404);
  EXPECT_EQ(client.Post("/busy", std::string(100'000, 'x'), "text/plain")->status, 413);
}

TEST(HttpServer, keeps_a_connection_and_answers_requests_that_arrive_together_or_in_pieces) {
  const Served served;
  RawClient client = served.client();
  client.send(std::string(kGet) + std::string(kGet));
  EXPECT_THAT(client.answer(), HasSubstr("from ::1"));
  EXPECT_THAT(client.answer(), HasSubstr("from ::1"));
  for (const char byte : std::string_view("POST /echo HTTP/1.1\r\nHost: x\r\nContent-Length: 5\r\n\r\nhello")) {
    client.send({&byte, 1});
  }
  EXPECT_THAT(client.answer(), HasSubstr("\r\n\r\nhello"));
  client.send("GET /small HTTP/1.1\r\nHost: x\r\nConnection: close\r\n\r\n");
  EXPECT_THAT(client.answer(), HasSubstr("from ::1"));
  EXPECT_TRUE(client.is_closed());
}

TEST(HttpServer, closes_a_client_whose_request_is_not_whole_in_time_however_often_it_sends) {
  Served served;
  RawClient client = served.client();
  client.send("GET /small HTTP/1.1\r\n");
  EXPECT_TRUE(served.closes(client, "X: y\r\n"));
}

TEST(HttpServer, closes_a_client_that_is_idle_between_requests) {
  Served served;
  RawClient client = served.client();
  client.send(kGet);
  EXPECT_THAT(client.answer(), StartsWith("HTTP/1.1 200"));
  EXPECT_TRUE(served.closes(client));
}

TEST(HttpServer, answers_while_200_clients_do_not_finish_their_requests) {
  const Served served({.threads = 2});
  std::vector<RawClient> slow;
  for (int i = 0; i < 200; ++i) {
    slow.push_back(served.client());
    slow.back().send("POST /echo HTTP/1.1\r\nContent-Length: 100\r\n\r\nhalf");
  }
  RawClient owner = served.client();
  owner.send(kGet);
  EXPECT_THAT(owner.answer(), StartsWith("HTTP/1.1 200"));
}

TEST(HttpServer, takes_room_for_new_clients_from_the_network_that_has_the_most) {
  const Served served({.threads = 1, .max_connections = 4}, "[::]:0");
  RawClient owner = served.client("::1");
  owner.send("GET /small HTTP/1.1\r\n");
  std::vector<RawClient> crowd;
  for (int i = 0; i < 8; ++i) {
    crowd.push_back(served.client("127.0.0.1"));
    crowd.back().send("GET /small HTTP/1.1\r\n");
  }
  for (int i = 0; i < 5; ++i) EXPECT_TRUE(crowd[static_cast<std::size_t>(i)].is_closed()) << i;
  owner.send("Host: localhost\r\n\r\n");
  EXPECT_THAT(owner.answer(), HasSubstr("from ::1"));
  crowd.back().send("Host: localhost\r\n\r\n");
  EXPECT_THAT(crowd.back().answer(), HasSubstr("127.0.0.1"));
}

TEST(HttpServer, releases_a_worker_whose_client_does_not_read_its_answer) {
  Served served({.threads = 1});
  RawClient greedy = served.client();
  greedy.send("GET /large HTTP/1.1\r\nHost: x\r\n\r\n");
  std::string answer;
  for (int i = 0; i < 1000 && answer.empty(); ++i) {
    RawClient other = served.client();
    other.send(kGet);
    for (int j = 0; j < 100 && !other.is_readable(20); ++j) served.clock.advance(31s);
    answer = other.answer();
  }
  EXPECT_THAT(answer, StartsWith("HTTP/1.1 200"));
}

TEST(HttpServer, sends_a_large_answer_whole) {
  const Served served;
  httplib::Client client("::1", served.server->port());
  const auto answer = client.Get("/large");
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->body.size(), std::size_t{32} << 20);
}

TEST(HttpServer, refuses_what_has_no_end_or_is_no_request) {
  const Served served;
  const auto refused = [&](const std::string& request) {
    RawClient client = served.client();
    client.send(request);
    const std::string answer = client.answer().substr(0, 12);
    return client.is_closed() ? answer : answer + " and stays";
  };
  EXPECT_EQ(refused("GET /small HTTP/1.1\r\nX: " + std::string(20'000, 'x')), "HTTP/1.1 431");
  EXPECT_EQ(refused("POST /echo HTTP/1.1\r\nTransfer-Encoding: chunked\r\n\r\n"), "HTTP/1.1 411");
  EXPECT_EQ(refused("POST /echo HTTP/1.1\r\nContent-Length: -1\r\n\r\n"), "HTTP/1.1 400");
  EXPECT_EQ(refused("POST /echo HTTP/1.1\r\nContent-Length: 5000\r\n\r\n"), "HTTP/1.1 413");
  RawClient no_http = served.client();
  no_http.send("\x16\x03\x01\r\n\r\n");
  EXPECT_THAT(no_http.answer(), StartsWith("HTTP/1.1 400"));
}

TEST(HttpServer, stops_although_a_client_does_not_read_and_another_sends_nothing) {
  Served served({.threads = 2});
  RawClient silent = served.client();
  RawClient greedy = served.client();
  greedy.send("GET /large HTTP/1.1\r\nHost: x\r\n\r\n");
  EXPECT_THAT(greedy.some(), StartsWith("HTTP/1.1 200"));
  served.server->stop();
  EXPECT_TRUE(silent.is_closed());
}

TEST(HttpServer, survives_a_client_that_leaves_while_its_request_is_handled) {
  Served served({.threads = 2});
  {
    RawClient leaver = served.client();
    leaver.send("GET /hang HTTP/1.1\r\nHost: x\r\n\r\n");
  }
  RawClient client = served.client();
  client.send(kGet);
  EXPECT_THAT(client.answer(), StartsWith("HTTP/1.1 200"));
  served.hang.set_value();
}

}  // namespace
}  // namespace cyclorama
