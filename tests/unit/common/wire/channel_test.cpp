// SPDX-License-Identifier: Apache-2.0
#include "common/wire/channel.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

#include "common/image/jpeg.h"
#include "common/wire/inspection_service.h"

namespace cyclorama {
namespace {

TEST(Channel, every_error_code_survives_a_call) {
  for (const ErrorCode code :
       {ErrorCode::kInvalidArgument, ErrorCode::kNotFound, ErrorCode::kBusy, ErrorCode::kUnavailable,
        ErrorCode::kTimedOut, ErrorCode::kBadData, ErrorCode::kSystem}) {
    const Error back = from_grpc(to_grpc(Error(code, "why")), "asking");
    EXPECT_EQ(back.code(), code);
    EXPECT_EQ(back.message(), "asking: why");
  }
}

TEST(Channel, addresses_require_host_and_port_and_ipv6_brackets) {
  for (const char* const good : {"[::1]:7401", "localhost:1", "10.0.0.1:65535"}) {
    EXPECT_TRUE(make_channel(good).has_value()) << good;
  }
  for (const char* const bad : {"", ":80", "::1:80", "host", "host:", "host:99999", "host:-1", "host:80x"}) {
    EXPECT_EQ(make_channel(bad).error().code(), ErrorCode::kInvalidArgument) << bad;
  }
}

TEST(Channel, works_over_a_unix_socket) {
  const std::string folder = testing::TempDir() + "cyclorama-channel-" + std::to_string(::getpid());
  std::filesystem::create_directories(folder);
  const std::string address = "unix:" + folder + "/inspect.sock";
  InspectionService service("coordinator");
  for (int start = 0; start < 2; ++start) {  // A socket file left by a killed process is replaced.
    const auto server = WireServer::start(address, {&service});
    ASSERT_TRUE(server) << server.error().message();
    EXPECT_EQ((*server)->port(), 0);
    const auto channel = make_channel(address);
    ASSERT_TRUE(channel);
    grpc::ClientContext context;
    context.set_deadline(std::chrono::system_clock::now() + std::chrono::seconds(10));
    wire::ProcessStatus status;
    ASSERT_TRUE(wire::Inspection::NewStub(*channel)->GetStatus(&context, {}, &status).ok());
    EXPECT_EQ(status.process(), "coordinator");
  }
  const auto nowhere = WireServer::start("unix:" + folder + "/none/inspect.sock", {&service});
  ASSERT_FALSE(nowhere);
  EXPECT_EQ(nowhere.error().code(), ErrorCode::kBusy);
  std::filesystem::remove_all(folder);
}

class InspectionTest : public ::testing::Test {
 protected:
  InspectionTest() {
    server_ = std::move(*WireServer::start("[::1]:0", {&service_}));
    auto channel = make_channel("[::1]:" + std::to_string(server_->port()));
    stub_ = wire::Inspection::NewStub(*channel);
    context_.set_deadline(std::chrono::system_clock::now() + std::chrono::seconds(10));
  }
  InspectionService service_{"tour"};
  std::unique_ptr<WireServer> server_;
  std::unique_ptr<wire::Inspection::Stub> stub_;
  grpc::ClientContext context_;
};

TEST_F(InspectionTest, a_second_server_on_a_taken_port_is_refused) {
  const auto second = WireServer::start("[::1]:" + std::to_string(server_->port()), {&service_});
  ASSERT_FALSE(second.has_value());
  EXPECT_EQ(second.error().code(), ErrorCode::kBusy);
}

TEST_F(InspectionTest, status_reports_stages_gauges_and_state) {
  service_.set_state("waits for the farm", false);
  for (int ms = 1; ms <= 100; ++ms) service_.add_stage_time("plan", std::chrono::milliseconds(ms));
  wire::Table table;
  table.set_name("nodes");
  table.add_columns("threads");
  table.add_rows()->add_cells()->set_number(8);
  service_.set_table(table);
  service_.set_table(table);  // Replaces the first.
  service_.count("frames", 2);
  service_.count("frames");
  wire::ProcessStatus status;
  ASSERT_TRUE(stub_->GetStatus(&context_, {}, &status).ok());
  EXPECT_EQ(status.process(), "tour");
  EXPECT_EQ(status.state(), "waits for the farm");
  EXPECT_FALSE(status.healthy());
  ASSERT_EQ(status.tables_size(), 1);
  EXPECT_EQ(status.tables(0).rows(0).cells(0).number(), 8);
  ASSERT_EQ(status.stages_size(), 1);
  EXPECT_DOUBLE_EQ(status.stages(0).p95_ms(), 95.0);
  ASSERT_EQ(status.gauges_size(), 1);
  EXPECT_EQ(status.gauges(0).value(), 3.0);
}

TEST_F(InspectionTest, renders_a_picture_only_on_request) {
  EXPECT_FALSE(service_.is_watched("wall"));
  wire::PictureRequest request;
  request.set_name("wall");
  wire::Picture picture;
  EXPECT_EQ(stub_->GetPicture(&context_, request, &picture).error_code(), grpc::StatusCode::NOT_FOUND);
  EXPECT_TRUE(service_.is_watched("wall"));

  service_.set_picture("wall", std::make_shared<const RgbImage>(32, 16, std::uint8_t{200}));
  grpc::ClientContext again;
  ASSERT_TRUE(stub_->GetPicture(&again, request, &picture).ok());
  const auto decoded = JpegDecoder().decode(std::as_bytes(std::span(picture.jpeg())), 1000);
  ASSERT_TRUE(decoded.has_value());
  EXPECT_EQ(decoded->width(), 32);
  EXPECT_NEAR(decoded->at(5, 5)[1], 200, 2);
}

}  // namespace
}  // namespace cyclorama
