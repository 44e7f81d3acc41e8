// SPDX-License-Identifier: Apache-2.0
// Invalid files that have broken other importers give one clear error here, or load with correct data.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <sys/resource.h>

#include <fstream>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "common/base/file.h"
#include "renderfarm/scene/gltf_accessor.h"
#include "renderfarm/scene/gltf_container.h"
#include "tests/data_sets/shared_data.h"
#include "tests/unit/renderfarm/scene/gltf_builder.h"

namespace cyclorama::scene {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

std::vector<std::filesystem::path> gltf_files_below(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    const std::string extension = entry.path().extension().string();
    if (extension == ".gltf" || extension == ".glb") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

std::size_t peak_memory_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::size_t>(usage.ru_maxrss) << 10;
}

TEST(GltfBad, every_file_loads_or_gives_one_error_with_its_name) {
  CYCLORAMA_SHARED_DATA(folder, "bad");
  struct Count {
    int loaded = 0;
    int refused = 0;
  };
  std::map<std::string, Count> table;
  for (const std::filesystem::path& file : gltf_files_below(folder)) {
    const Result<Model> model = import_gltf(file, ImportLimits{});
    Count& count = table[std::filesystem::relative(file, folder).begin()->string()];
    ++(model ? count.loaded : count.refused);
    if (model) continue;
    EXPECT_THAT(model.error().message(), HasSubstr(file.filename().string()));
    EXPECT_EQ(model.error().message().find('\n'), std::string::npos) << model.error().message();
    EXPECT_LT(model.error().message().size(), 600u) << model.error().message();
  }
  std::cout << fmt::format("{:16} {:>7} {:>7}\n", "bad glTF files", "loaded", "refused");
  int total = 0;
  for (const auto& [group, count] : table) {
    std::cout << fmt::format("{:16} {:>7} {:>7}\n", group, count.loaded, count.refused);
    total += count.loaded + count.refused;
  }
  EXPECT_EQ(total, 157);
  EXPECT_LT(peak_memory_bytes(), std::size_t{4} << 30);
}

// Reported by the official validator as error or warning, and wrong data for this importer.
const std::set<std::string> kWrongData = {"ACCESSOR_SMALL_BYTESTRIDE",
                                          "ACCESSOR_SPARSE_COUNT_OUT_OF_RANGE",
                                          "ACCESSOR_TOO_LONG",
                                          "ARRAY_TYPE_MISMATCH",
                                          "BUFFER_BYTE_LENGTH_MISMATCH",
                                          "BUFFER_MISSING_GLB_DATA",
                                          "BUFFER_VIEW_TOO_LONG",
                                          "GLB_CHUNK_LENGTH_UNALIGNED",
                                          "GLB_CHUNK_TOO_BIG",
                                          "GLB_DUPLICATE_CHUNK",
                                          "GLB_EMPTY_CHUNK",
                                          "GLB_INVALID_MAGIC",
                                          "GLB_INVALID_VERSION",
                                          "GLB_LENGTH_MISMATCH",
                                          "GLB_LENGTH_TOO_SMALL",
                                          "GLB_UNEXPECTED_BIN_CHUNK",
                                          "GLB_UNEXPECTED_END_OF_CHUNK_DATA",
                                          "GLB_UNEXPECTED_END_OF_CHUNK_HEADER",
                                          "GLB_UNEXPECTED_END_OF_HEADER",
                                          "GLB_UNEXPECTED_FIRST_CHUNK",
                                          "INVALID_JSON",
                                          "INVALID_URI",
                                          "IO_ERROR",
                                          "MESH_PRIMITIVE_ATTRIBUTES_ACCESSOR_INVALID_FORMAT",
                                          "MESH_PRIMITIVE_ATTRIBUTES_ACCESSOR_UNSIGNED_INT",
                                          "MESH_PRIMITIVE_INDICES_ACCESSOR_INVALID_FORMAT",
                                          "MESH_PRIMITIVE_INDICES_ACCESSOR_WITH_BYTESTRIDE",
                                          "MESH_PRIMITIVE_UNEQUAL_ACCESSOR_COUNT",
                                          "NODE_LOOP",
                                          "NODE_MATRIX_TRS",
                                          "NODE_PARENT_OVERRIDE",
                                          "NON_RELATIVE_URI",
                                          "SCENE_NON_ROOT_NODE",
                                          "TYPE_MISMATCH",
                                          "UNDEFINED_PROPERTY",
                                          "UNRESOLVED_REFERENCE",
                                          "VALUE_NOT_IN_LIST"};

// Reported, but the data is correct nevertheless, is corrected with a note, or is not read. Each entry is a decision.
const std::set<std::string> kHarmless = {
    "ACCESSOR_ELEMENT_OUT_OF_MAX_BOUND",
    "ACCESSOR_ELEMENT_OUT_OF_MIN_BOUND",  // The importer computes bounds itself.
    "ACCESSOR_MAX_MISMATCH",
    "ACCESSOR_MIN_MISMATCH",
    "MESH_PRIMITIVE_POSITION_ACCESSOR_WITHOUT_BOUNDS",
    "ACCESSOR_INVALID_FLOAT",  // Corrected and noted.
    "ACCESSOR_MATRIX_ALIGNMENT",
    "ACCESSOR_OFFSET_ALIGNMENT",
    "ACCESSOR_TOTAL_OFFSET_ALIGNMENT",
    "MESH_PRIMITIVE_ACCESSOR_UNALIGNED",
    "VALUE_MULTIPLE_OF",            // The importer reads at any alignment.
    "ACCESSOR_NORMALIZED_INVALID",  // Floats are read unchanged.
    "BUFFER_DATA_URI_MIME_TYPE_INVALID",
    "BUFFER_GLB_CHUNK_TOO_BIG",
    "DATA_URI_GLB",
    "GLB_EXTRA_DATA",
    "GLB_UNKNOWN_CHUNK_TYPE",
    "BUFFER_VIEW_TARGET_OVERRIDE",
    "BUFFER_VIEW_TOO_BIG_BYTE_STRIDE",
    "MESH_PRIMITIVE_ACCESSOR_WITHOUT_BYTESTRIDE",
    "VALUE_NOT_IN_RANGE",               // Empty views contain nothing.
    "BUFFER_VIEW_INVALID_BYTE_STRIDE",  // Refused for indices and sparse accessors.
    "EMPTY_ENTITY",
    "UNEXPECTED_PROPERTY",
    "UNSATISFIED_DEPENDENCY",  // The file requests nothing that depends on it.
    "MESH_PRIMITIVE_INVALID_ATTRIBUTE",
    "MESH_PRIMITIVE_INDEXED_SEMANTIC_CONTINUITY",
    "MESH_PRIMITIVE_JOINTS_WEIGHTS_MISMATCH",
    "MESH_INVALID_WEIGHTS_COUNT",
    "MESH_PRIMITIVES_UNEQUAL_TARGETS_COUNT",
    "MESH_PRIMITIVE_MORPH_TARGET_INVALID_ATTRIBUTE_COUNT",
    "MESH_PRIMITIVE_MORPH_TARGET_NO_BASE_ACCESSOR",
    "NODE_SKIN_WITH_NON_SKINNED_MESH",
    "NODE_SKINNED_MESH_WITHOUT_SKIN",
    "NODE_WEIGHTS_INVALID",  // Not read; noted.
    "MESH_PRIMITIVE_GENERATED_TANGENT_SPACE",
    "MESH_PRIMITIVE_TANGENT_WITHOUT_NORMAL",
    "MESH_PRIMITIVE_INCOMPATIBLE_MODE",
    "MESH_PRIMITIVE_NO_POSITION",
    "MESH_PRIMITIVE_TOO_FEW_TEXCOORDS",  // Noted.
    "NODE_MATRIX_NON_TRS",               // Any affine transform can be shown.
    "ROTATION_NON_UNIT"};                // Noted.

// Files whose outcome differs from their codes, and the reasons.
const std::map<std::string, bool> kRefusedInstead = {
    {"buffer/invalid_uri_data.gltf", false},  // A stray ';' in the media type; the data is complete.
    {"glb/bom.glb", false},                   // The specification says that importers should ignore byte order marks.
    {"json/bom.gltf", false},
    {"glb/unaligned_chunk.glb", false},         // The end of the file shows where the chunk ends.
    {"accessor/matrix_alignment.gltf", false},  // Too long as well, but matrices are not read.
    {"node/matrix_indecomposable.gltf", true},  // Not even affine.
    {"node/infinite_transform.gltf", true},     // Infinity, not an empty view.
    {"node/matrix_indecomposable.gltf", true},  // Not even affine.
};

bool is_read(const std::string& pointer) {
  for (const char* const unread : {"/skin", "/targets/", "/attributes/_"}) {
    if (pointer.find(unread) != std::string::npos) return false;
  }
  return true;
}

/// Returns nothing if the validator reports an unlisted code, which the test then fails on.
std::optional<bool> must_be_refused(const std::string& name, const json& report) {
  bool refused = false;
  for (const json& message : report["issues"].value("messages", json::array())) {
    constexpr int kWarning = 1;
    if (message["severity"].get<int>() > kWarning) continue;
    const std::string code = message["code"];
    if (kWrongData.count(code) == 0 && kHarmless.count(code) == 0) return std::nullopt;
    refused = refused || (kWrongData.count(code) != 0 && is_read(message.value("pointer", std::string())));
  }
  const auto exception = kRefusedInstead.find(name);
  return exception == kRefusedInstead.end() ? refused : exception->second;
}

/// Imports the file and then reads everything that it does not refer to, since the validator checks all of it. Many of
/// its files have buffers without data, which stand for data that the program provides; they get zeros here.
std::string read_everything(const std::filesystem::path& file) {
  const MappedFile bytes = *MappedFile::open(file);
  const Result<GltfChunks> chunks = split_gltf(bytes.bytes());
  if (!chunks) return chunks.error().message();
  GltfContext context{ImportLimits{}};
  GltfBuilder whole;
  const Status parsed = parse_gltf_json(chunks->json, &context.budget, &whole.json);
  if (!parsed) return parsed.error().message();
  if (!whole.json.is_object()) return import_gltf(file, ImportLimits{}).error().message();
  const json buffers = whole.json.value("buffers", json::array());
  if (chunks->binary) whole.binary.assign(chunks->binary->begin(), chunks->binary->end());
  const std::size_t accessors = whole.json.value("accessors", json::array()).size();
  for (std::size_t i = 0; i < buffers.size(); ++i) {
    whole.json["bufferViews"].push_back({{"buffer", i}, {"byteLength", 0}});
    const bool has_no_data = buffers[i].is_object() && !buffers[i].contains("uri");
    if (!has_no_data || (i == 0 && file.extension() == ".glb")) continue;
    const auto length = static_cast<std::size_t>(buffers[i].value("byteLength", 0.0));
    whole.json["buffers"][i]["uri"] = "data:;base64," + std::string((length + 2) / 3 * 4, 'A');
  }
  const std::vector<std::byte> rebuilt = whole.glb();
  const Result<Model> model = import_gltf_bytes(rebuilt, file.parent_path(), ImportLimits{});
  if (!model) return model.error().message();
  Result<GltfDocument> document = GltfDocument::open(rebuilt, file.parent_path(), &context);
  if (!document) return document.error().message();
  for (std::size_t i = 0; i < whole.json.value("bufferViews", json::array()).size(); ++i) {
    const Result<GltfBufferView> view = document->buffer_view(i);
    if (!view) return view.error().message();
  }
  for (std::size_t i = 0; i < accessors; ++i) {
    if (whole.json["accessors"][i].value("type", std::string()).rfind("MAT", 0) == 0)
      continue;  // The importer reads no matrices.
    const Result<GltfAccessor> accessor = read_accessor(&*document, i, &context.budget);
    if (!accessor) return accessor.error().message();
  }
  return "";
}

TEST(GltfBad, agrees_with_the_official_validator_about_wrong_data) {
  CYCLORAMA_SHARED_DATA(folder, "bad/gltf_validator/base/data");
  int compared = 0;
  int refused = 0;
  for (const std::filesystem::path& file : gltf_files_below(folder)) {
    const std::string name = std::filesystem::relative(file, folder).string();
    std::ifstream report_file(file.string() + ".report.json");
    ASSERT_TRUE(report_file.is_open()) << name;
    const json report = json::parse(report_file);
    const std::optional<bool> expected = must_be_refused(name, report);
    ASSERT_TRUE(expected.has_value()) << name << ": a code that this test does not know: " << report["issues"].dump();
    const std::string error = read_everything(file);
    EXPECT_EQ(!error.empty(), *expected) << name << ": " << (error.empty() ? "read without an error" : error) << '\n'
                                         << report["issues"]["messages"].dump();
    ++compared;
    refused += error.empty() ? 0 : 1;
  }
  std::cout << fmt::format("validator's files: {} compared, {} refused\n", compared, refused);
  EXPECT_GT(compared, 130);
}

TEST(GltfBad, errors_of_missing_and_unreadable_files_have_their_codes) {
  EXPECT_EQ(import_gltf("/nonexistent/scene.glb", ImportLimits{}).error().code(), ErrorCode::kNotFound);
  EXPECT_EQ(import_gltf("/", ImportLimits{}).error().code(), ErrorCode::kBadData);
  CYCLORAMA_SHARED_DATA(file, "bad/assimp/MissingBin/BoxTextured.gltf");
  const Result<Model> model = import_gltf(file, ImportLimits{});
  ASSERT_FALSE(model.has_value());
  EXPECT_EQ(model.error().code(), ErrorCode::kNotFound);
  EXPECT_THAT(model.error().message(), HasSubstr("BoxTextured.gltf: /buffers/0/uri: opening"));
}

}  // namespace
}  // namespace cyclorama::scene
