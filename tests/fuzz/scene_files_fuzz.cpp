// SPDX-License-Identifier: Apache-2.0
// A list of a scene's files from the coordinator: protobuf, or lines of path and size, which are accepted more often.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <set>
#include <string>

#include "common/base/check.h"
#include "renderfarm/scene_distribution/scene_files.h"
#include "renderfarm/scene_distribution/sha256.h"

namespace {

using namespace cyclorama;

wire::SceneFiles lines_in(std::string_view text) {
  wire::SceneFiles message;
  while (!text.empty()) {
    const std::string_view line = text.substr(0, text.find('\n'));
    wire::SceneFile* const file = message.add_files();
    file->set_path(std::string(line));
    file->set_bytes(line.size());
    file->set_sha256(scene_distribution::sha256_of(line));
    text.remove_prefix(std::min(text.size(), line.size() + 1));
  }
  return message;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  wire::SceneFiles message;
  if (size > 0 && data[0] % 2 == 0) {
    message = lines_in(text.substr(1));
  } else if (!message.ParseFromArray(data, static_cast<int>(size))) {
    return 0;
  }
  scene_distribution::SceneFiles files;
  for (const wire::SceneFile& file : message.files()) files.push_back({file.path(), file.bytes(), file.sha256()});
  std::ranges::sort(files, {}, &scene_distribution::SceneFile::path);
  const bool good = scene_distribution::validate(files).has_value();
  const auto taken = scene_distribution::from_wire(message, scene_distribution::digest_of(files));
  CHECK(taken.has_value() == good);
  CHECK(!scene_distribution::from_wire(message, std::string(64, '0')));
  if (!good) return 0;
  CHECK(*taken == files &&
        scene_distribution::from_wire(scene_distribution::to_wire(files), scene_distribution::digest_of(files)));
  std::set<std::string> names;
  for (const scene_distribution::SceneFile& file : files) {
    const std::filesystem::path whole = std::filesystem::path("/cache") / file.path;
    CHECK(whole.lexically_normal() == whole && whole.string().starts_with("/cache/"));
    CHECK(names.insert(file.path).second && scene_distribution::is_sha256(file.sha256));
  }
  return 0;
}
