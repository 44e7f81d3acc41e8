// SPDX-License-Identifier: Apache-2.0
// Geometry never leaves the farm: a whole session at the museums' port, with a real coordinator, a real node and a
// scene whose vertices are recognised wherever they occur.
#include <fmt/format.h>
#include <google/protobuf/descriptor.h>
#include <google/protobuf/message.h>
#include <google/protobuf/unknown_field_set.h>
#include <grpcpp/client_context.h>
#include <gtest/gtest-spi.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <bit>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <set>

#include "common/image/inverse_depth.h"
#include "common/image/jpeg.h"
#include "common/wire/channel.h"
#include "common/wire/farm.grpc.pb.h"
#include "common/wire/nodes.grpc.pb.h"
#include "common/wire/payload.h"
#include "renderfarm/coordinator/coordinator.h"
#include "renderfarm/node/embree_block_renderer.h"
#include "renderfarm/node/farm_node.h"

namespace cyclorama::coordinator {
namespace {

using google::protobuf::Descriptor;
using google::protobuf::FieldDescriptor;
using google::protobuf::Message;
using google::protobuf::Reflection;

/// All fields of the museums' port. Adding a field here asserts that it reveals nothing of a scene's geometry.
const std::set<std::string> kReviewed = {
    "EyePair.distance_m: double",
    "EyePair.screen_distance_m: double",
    "FrameEnd.balance_efficiency: double",
    "FrameEnd.complete: bool",
    "FrameEnd.late: bool",
    "FrameEnd.nodes: uint32",
    "FrameEnd.reason: string",
    "FrameEnd.reference_samples: uint32",
    "FrameEnd.samples: uint32",
    "FrameEnd.stages: StageTime",
    "FrameEnd.tiles: uint32",
    "FrameEnd.view_number: uint64",
    "GroundPoint.x_m: double",
    "GroundPoint.z_m: double",
    "GroundPolygon.corners: GroundPoint",
    "ListScenesReply.scenes: SceneSummary",
    "Panorama.azimuth_span_rad: double",
    "Panorama.eyes: EyePair",
    "Panorama.field_rad: double",
    "Panorama.height_px: uint32",
    "Panorama.projection: enum",
    "Panorama.tan_bottom: double",
    "Panorama.tan_elevation_bottom: double",
    "Panorama.tan_elevation_top: double",
    "Panorama.tan_left: double",
    "Panorama.tan_right: double",
    "Panorama.tan_top: double",
    "Panorama.tilt_rad: double",
    "Panorama.width_px: uint32",
    "SceneDescription.credits: string",
    "SceneDescription.eye_height_m: double",
    // Names that the scene's author gave.
    "SceneDescription.lamp_groups: string",
    "SceneDescription.name: string",
    "SceneDescription.start_eye_m: Vector3",
    "SceneDescription.start_heading_rad: double",
    "SceneDescription.stops: TourStop",
    "SceneDescription.title: string",
    "SceneDescription.triangles_seen: uint64",
    "SceneDescription.triangles_stored: uint64",
    "SceneDescription.walkable: GroundPoint",
    "SceneDescription.walkable_holes: GroundPolygon",
    "SceneDescription.walking_scale: double",
    "SceneSummary.name: string",
    "SceneSummary.title: string",
    "StageTime.name: string",
    "StageTime.seconds: double",
    // Distances to 12 bits, one for 16 pixels and only those that the eye sees: what a museum can compute from two of
    // its pictures by triangulation, and no more of the geometry than that.
    "Tile.depth: bytes",
    "Tile.height_px: uint32",
    "Tile.jpeg: bytes",
    "Tile.view_number: uint64",
    "Tile.width_px: uint32",
    "Tile.x_px: uint32",
    "Tile.y_px: uint32",
    "TourStop.eye_m: Vector3",
    "TourStop.heading_rad: double",
    "TourStop.title: string",
    "Vector3.x: double",
    "Vector3.y: double",
    "Vector3.z: double",
    "View.adaptive_error: float",
    "View.adaptive_minimum: uint32",
    "View.bounces: uint32",
    "View.denoise: bool",
    "View.depth: bool",
    "View.eye_m: Vector3",
    "View.firefly_limit: float",
    "View.first_sample: uint32",
    "View.heading_rad: double",
    "View.jpeg_quality: uint32",
    "View.lamp_levels: float",
    // SHA-256 of the light's file: a name, from which nothing of the scene can be computed.
    "View.light: string",
    "View.light_samples: uint32",
    "View.number: uint64",
    "View.panorama: Panorama",
    "View.prior_samples: uint32",
    "View.prior_weight: float",
    "View.samples: uint32",
    "View.sequence: uint32",
    "View.shutter_ns: int64",
    "View.stored_light: bool",
    "View.subsample_chroma: bool",
    "SessionReply.begin: View",
    "SessionReply.end: FrameEnd",
    "SessionReply.opened: SceneDescription",
    "SessionReply.tile: Tile",
};

void add_fields(const Descriptor& message, std::set<std::string>* ret_fields) {
  for (int i = 0; i < message.field_count(); ++i) {
    const FieldDescriptor& field = *message.field(i);
    const bool nested = field.message_type() != nullptr;
    const std::string type = nested ? field.message_type()->name() : field.type_name();
    const bool is_new = ret_fields->insert(message.name() + "." + field.name() + ": " + type).second;
    if (nested && is_new) add_fields(*field.message_type(), ret_fields);
  }
}

TEST(Leak, the_museums_port_has_no_unreviewed_field) {
  const auto* const service = wire::SessionReply::descriptor()->file()->FindServiceByName("Farm");
  ASSERT_NE(service, nullptr);
  std::set<std::string> fields;
  for (int i = 0; i < service->method_count(); ++i) add_fields(*service->method(i)->output_type(), &fields);
  EXPECT_EQ(fields, kReviewed);
}

/// 32 odd triangles on the walls of an odd room, no two coordinates alike.
struct OddScene {
  std::vector<std::array<double, 3>> vertices;
  std::set<double> coordinates;
  std::filesystem::path folder;
};

OddScene odd_scene() {
  OddScene scene;
  scene.folder = std::filesystem::path(testing::TempDir()) / ("leak_test_" + std::to_string(::getpid()));
  std::filesystem::create_directories(scene.folder);
  std::ofstream obj(scene.folder / "odd.obj");
  for (int i = 0; i < 96; ++i) {
    const double turn = 0.0651 * i + 0.0217;
    // Rounded to single precision, in which the scene is stored.
    const auto odd = [](double value) { return static_cast<double>(static_cast<float>(value)); };
    const std::array<double, 3> vertex{odd(3.3713 * std::sin(turn) + 0.000173 * i), odd(0.2137 + 0.029311 * i),
                                       odd(3.7719 * std::cos(turn) - 0.000319 * i)};
    scene.vertices.push_back(vertex);
    scene.coordinates.insert(vertex.begin(), vertex.end());
    obj << fmt::format("v {:.9g} {:.9g} {:.9g}\n", vertex[0], vertex[1], vertex[2]);
  }
  for (int i = 0; i < 96; i += 3) obj << fmt::format("f {} {} {}\n", i + 1, i + 2, i + 3);
  std::ofstream(scene.folder / "scene.toml")
      << "title = \"Odd\"\n[start]\neye_m = [0.0, 1.6, 0.0]\n[visitor]\n"
         "walkable_m = [[-1, -1], [1, -1], [1, 1], [-1, 1]]\n"
         "[light]\nambient = [0.3, 0.3, 0.3]\n[[geometry]]\nfile = \"odd.obj\"\n";
  return scene;
}

/// Searches everything that the farm sends for the scene's geometry.
class Searcher {
 public:
  explicit Searcher(const OddScene& scene) : scene_(scene) {
    for (const auto& vertex : scene.vertices) {
      // Two adjacent coordinates: eight bytes of floats do not occur by chance in a JPEG, as four do.
      for (std::size_t i = 0; i + 1 < vertex.size(); ++i) {
        patterns_.insert(bytes_of(static_cast<float>(vertex[i])) + bytes_of(static_cast<float>(vertex[i + 1])));
      }
      for (const double value : vertex) {
        patterns_.insert(bytes_of(value));
        patterns_.insert(fmt::format("{:.9f}", value).substr(0, 7));  // Decimal text, truncated rather than rounded.
      }
    }
  }

  void search(const Message& message) {
    numbers(message);
    search_bytes(message.SerializeAsString());
  }
  void search_bytes(const std::string& bytes) {
    for (const std::string& pattern : patterns_) {
      EXPECT_EQ(bytes.find(pattern), std::string::npos) << "a vertex in " << bytes.size() << " bytes";
    }
  }

 private:
  template <typename Value>
  static std::string bytes_of(Value value) {
    const auto bytes = std::bit_cast<std::array<char, sizeof(Value)>>(value);
    return {bytes.begin(), bytes.end()};
  }
  void number(double value, const FieldDescriptor& field) {
    const auto near = scene_.coordinates.lower_bound(value - 1e-6);
    EXPECT_FALSE(near != scene_.coordinates.end() && *near <= value + 1e-6)
        << field.full_name() << " is " << value << ", as a vertex has it";
  }
  void numbers(const Message& message) {
    const Reflection& reflection = *message.GetReflection();
    EXPECT_TRUE(reflection.GetUnknownFields(message).empty()) << message.GetTypeName();
    std::vector<const FieldDescriptor*> set;
    reflection.ListFields(message, &set);
    for (const FieldDescriptor* const field : set) {
      const int count = field->is_repeated() ? reflection.FieldSize(message, field) : 1;
      for (int i = 0; i < count; ++i) {
        if (field->cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE) {
          numbers(field->is_repeated() ? reflection.GetRepeatedMessage(message, field, i)
                                       : reflection.GetMessage(message, field));
        } else if (field->cpp_type() == FieldDescriptor::CPPTYPE_DOUBLE) {
          number(field->is_repeated() ? reflection.GetRepeatedDouble(message, field, i)
                                      : reflection.GetDouble(message, field),
                 *field);
        } else if (field->cpp_type() == FieldDescriptor::CPPTYPE_FLOAT) {
          number(static_cast<double>(field->is_repeated() ? reflection.GetRepeatedFloat(message, field, i)
                                                          : reflection.GetFloat(message, field)),
                 *field);
        }
      }
    }
  }

  const OddScene& scene_;
  std::set<std::string> patterns_;
};

/// Expects a JPEG with tables and coefficients only: no comment, no foreign APP segment, nothing after its end.
void expect_plain(const std::string& jpeg) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(jpeg.at(i)); };
  ASSERT_TRUE(jpeg.size() > 4 && byte(0) == 0xff && byte(1) == 0xd8);
  std::size_t at = 2;
  for (int marker = 0; marker != 0xda;) {
    ASSERT_LT(at + 4, jpeg.size());
    ASSERT_EQ(byte(at), 0xff);
    marker = byte(at + 1);
    EXPECT_TRUE(marker == 0xe0 || marker == 0xdb || marker == 0xc0 || marker == 0xc4 || marker == 0xda)
        << "segment " << std::hex << marker;
    const std::size_t length = byte(at + 2) * 256u + byte(at + 3);
    EXPECT_TRUE(marker != 0xe0 || length == 16u) << length;
    at += 2 + length;
  }
  const std::size_t end = jpeg.find("\xff\xd9", at);
  EXPECT_EQ(end + 2, jpeg.size());
  EXPECT_TRUE(JpegDecoder().decode(std::as_bytes(std::span(jpeg)), 1 << 20));
}

class MuseumsPortTest : public testing::Test {
 protected:
  void SetUp() override {
    CoordinatorOptions options;
    options.scenes = {{"odd", scene.folder.string()}, {"absent", (scene.folder / "absent").string()}};
    options.museums = options.nodes = "[::1]:0";
    auto started = Coordinator::start(options, [](const std::string&, const NoticeAbout&) {});
    ASSERT_TRUE(started) << started.error().message();
    coordinator = *std::move(started);
    node::FarmNodeOptions node_options;
    node_options.coordinators = {"[::1]:" + std::to_string(coordinator->node_port())};
    node_options.name = "node";
    auto node_started =
        node::FarmNode::start(node_options, node::embree_scene_loader(std::make_shared<render::Crew>(1)));
    ASSERT_TRUE(node_started);
    node = *std::move(node_started);
    channel = *make_channel("[::1]:" + std::to_string(coordinator->museum_port()));
  }
  void TearDown() override {
    if (node) node->stop();
    if (coordinator) coordinator->stop();
    std::filesystem::remove_all(scene.folder);
  }
  static void set_deadline(grpc::ClientContext* context) {
    context->set_deadline(std::chrono::system_clock::now() + std::chrono::seconds(30));
  }
  /// Opens a session, requests the views, and reads until that many frames have ended or the stream ends.
  grpc::Status session(const wire::OpenSession& open, const std::vector<wire::View>& views, std::size_t frames) {
    grpc::ClientContext context;
    set_deadline(&context);
    const auto stub = wire::Farm::NewStub(channel);
    const auto stream = stub->Session(&context);
    wire::SessionRequest request;
    *request.mutable_open() = open;
    stream->Write(request);
    wire::SessionReply reply;
    std::size_t next = 0;
    std::size_t ended = 0;
    const auto request_view = [&] {
      if (next == views.size()) return;
      *request.mutable_view() = views[next++];
      stream->Write(request);
    };
    while (ended < frames && stream->Read(&reply)) {
      searcher.search(reply);
      said.push_back(reply);
      if (reply.has_opened()) request_view();
      if (reply.has_end()) {
        ++ended;
        request_view();
      }
    }
    stream->WritesDone();
    while (stream->Read(&reply)) searcher.search(reply);
    const grpc::Status status = stream->Finish();
    searcher.search_bytes(status.error_message() + status.error_details());
    return status;
  }
  /// Retries until the node has the scene.
  grpc::Status patient_session(const wire::OpenSession& open, const std::vector<wire::View>& views,
                               std::size_t frames) {
    const TimePoint deadline = SteadyClock().now() + std::chrono::seconds(30);
    grpc::Status status;
    do {
      status = session(open, views, frames);
    } while (status.error_code() == grpc::StatusCode::UNAVAILABLE && SteadyClock().now() < deadline);
    return status;
  }

  OddScene scene = odd_scene();
  Searcher searcher{scene};
  std::unique_ptr<Coordinator> coordinator;
  std::unique_ptr<node::FarmNode> node;
  std::shared_ptr<grpc::Channel> channel;
  std::vector<wire::SessionReply> said;
};

wire::View view_of(std::uint64_t number, double heading) {
  wire::View view;
  view.set_number(number);
  view.set_samples(1);
  view.set_jpeg_quality(90);
  view.mutable_eye_m()->set_y(1.6);
  view.set_heading_rad(heading);
  view.mutable_panorama()->set_width_px(320);
  view.mutable_panorama()->set_height_px(160);
  view.mutable_panorama()->set_azimuth_span_rad(2.0);
  view.mutable_panorama()->set_tan_elevation_top(0.7);
  view.mutable_panorama()->set_tan_elevation_bottom(-0.7);
  return view;
}

TEST_F(MuseumsPortTest, reveals_pictures_but_no_geometry) {
  wire::View deep = view_of(3, -2.5);
  deep.set_depth(true);
  ASSERT_TRUE(patient_session({}, {view_of(1, 0.0), view_of(2, 1.5), deep}, 3).ok());
  wire::OpenSession governed;  // Comes to rest, so that refined pictures are sent as well.
  governed.set_scene("odd");
  governed.set_frame_budget_ms(200);
  governed.set_reference_samples(4);
  ASSERT_TRUE(session(governed, {view_of(1, 0.3)}, 2).ok());

  grpc::ClientContext context;
  set_deadline(&context);
  wire::ListScenesReply scenes;
  ASSERT_TRUE(wire::Farm::NewStub(channel)->ListScenes(&context, {}, &scenes).ok());
  searcher.search(scenes);
  EXPECT_EQ(scenes.scenes_size(), 2);
  EXPECT_LE(scenes.ByteSizeLong(), 200u);

  std::size_t frames = 0;
  std::size_t tiles = 0;
  std::size_t other_bytes = 0;
  std::set<int> colours;
  std::set<int> depths;
  for (const wire::SessionReply& reply : said) {
    other_bytes += reply.ByteSizeLong() - (reply.has_tile() ? payload_bytes(reply.tile()) : 0);
    frames += reply.has_end() ? 1u : 0u;
    if (!reply.has_tile()) continue;
    ++tiles;
    expect_plain(reply.tile().jpeg());
    const auto pixels = JpegDecoder().decode(std::as_bytes(std::span(reply.tile().jpeg())), 1 << 20);
    if (pixels) colours.insert(pixels->data().begin(), pixels->data().end());
    if (reply.tile().depth().empty()) continue;
    InverseDepthImage depth(static_cast<int>(reply.tile().width_px()) / kDepthCellPx,
                            static_cast<int>(reply.tile().height_px()) / kDepthCellPx);
    EXPECT_TRUE(decode_inverse_depth(std::as_bytes(std::span(reply.tile().depth())),
                                     {0, 0, depth.width(), depth.height()}, &depth))
        << "nothing but depth";
    depths.insert(depth.data().begin(), depth.data().end());
  }
  EXPECT_GT(depths.size(), 2u) << "the depth must be the scene's";
  EXPECT_EQ(frames, 5u);
  EXPECT_GT(colours.size(), 10u) << "the pictures must show the scene, or the search proves nothing";
  // The scene description and the frames' metadata are too small to hold a scene.
  EXPECT_LE(other_bytes, 1000 + 500 * frames + 50 * tiles);
}

TEST_F(MuseumsPortTest, errors_reveal_no_geometry) {
  wire::OpenSession open;
  open.set_scene("absent");
  EXPECT_FALSE(session(open, {}, 1).ok());
  open.set_scene("unheard of");
  EXPECT_EQ(session(open, {}, 1).error_code(), grpc::StatusCode::NOT_FOUND);
}

TEST_F(MuseumsPortTest, refuses_the_nodes_calls_at_the_museums_port) {
  const auto stub = wire::Nodes::NewStub(channel);
  {
    grpc::ClientContext context;
    set_deadline(&context);
    wire::SceneFiles files;
    EXPECT_EQ(stub->ListFiles(&context, {}, &files).error_code(), grpc::StatusCode::UNIMPLEMENTED);
  }
  {
    grpc::ClientContext context;
    set_deadline(&context);
    wire::FileChunk chunk;
    const auto stream = stub->FetchFile(&context, {});
    EXPECT_FALSE(stream->Read(&chunk));
    EXPECT_EQ(stream->Finish().error_code(), grpc::StatusCode::UNIMPLEMENTED);
  }
  grpc::ClientContext context;
  set_deadline(&context);
  wire::NodeCommand command;
  const auto stream = stub->Work(&context);
  EXPECT_FALSE(stream->Read(&command));
  EXPECT_EQ(stream->Finish().error_code(), grpc::StatusCode::UNIMPLEMENTED);
}

TEST(Searcher, finds_a_vertex_in_every_encoding) {
  const OddScene scene = odd_scene();
  std::filesystem::remove_all(scene.folder);
  const auto& vertex = scene.vertices[40];
  const auto is_found = [&](const Message& message) {
    testing::TestPartResultArray failures;
    {
      const testing::ScopedFakeTestPartResultReporter reporter(&failures);
      Searcher(scene).search(message);
    }
    return failures.size() > 0;
  };
  wire::SessionReply reply;
  EXPECT_FALSE(is_found(reply));
  reply.mutable_opened()->mutable_start_eye_m()->set_z(vertex[2] + 1e-8);
  EXPECT_TRUE(is_found(reply));
  reply.Clear();
  reply.mutable_opened()->set_credits(fmt::format("at {:.8f}", vertex[0]));
  EXPECT_TRUE(is_found(reply));
  reply.Clear();
  const std::array<float, 3> floats{static_cast<float>(vertex[0]), static_cast<float>(vertex[1]),
                                    static_cast<float>(vertex[2])};
  reply.mutable_tile()->mutable_jpeg()->assign("JPEG").append(reinterpret_cast<const char*>(floats.data()),
                                                              sizeof(floats));
  EXPECT_TRUE(is_found(reply));
  reply.Clear();
  reply.GetReflection()->MutableUnknownFields(&reply)->AddFixed64(99, 7);
  EXPECT_TRUE(is_found(reply));
}

}  // namespace
}  // namespace cyclorama::coordinator
