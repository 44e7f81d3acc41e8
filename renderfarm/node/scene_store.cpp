// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/node/scene_store.h"

#include <fmt/format.h>

#include <exception>
#include <filesystem>
#include <new>

#include "common/base/clock.h"
#include "common/base/file.h"
#include "common/base/text.h"
#include "common/wire/convert.h"
#include "renderfarm/governor/front_file.h"

namespace cyclorama {
namespace {
constexpr std::size_t kLongestError = 1000;

/// What the scene's own front says, checked; empty without one.
Result<std::string> front_of(const std::filesystem::path& scene) {
  constexpr std::size_t kMostBytes = std::size_t{1} << 20;
  const std::filesystem::path file = scene / "front.toml";
  std::error_code none;
  if (!std::filesystem::exists(file, none)) return std::string();
  TRY_ASSIGN(std::string text, read_text_file(file, kMostBytes));
  TRY(parse_front(text, file.string()));
  return text;
}
}  // namespace

wire::SceneLoaded SceneStore::load(const wire::LoadScene& order, const std::function<void(double)>& progress) {
  if (const auto known = scenes_.find(order.scene()); known != scenes_.end()) {
    if (known->second.path == order.path()) return known->second.answer;
    scenes_.erase(known);  // First, so that memory never holds both.
  }
  wire::SceneLoaded answer;
  answer.set_scene(order.scene());
  const TimePoint begun = SteadyClock().now();
  const auto front = front_of(order.path());
  auto renderer = front ? load_guarded(order.path(), progress) : Error(front.error());
  if (!renderer) {
    answer.set_error(printable(renderer.error().message(), kLongestError));  // May quote a file's bytes.
    return answer;
  }
  answer.set_front(*front);
  *answer.mutable_description() = (*renderer)->description();
  answer.mutable_description()->set_name(order.scene());
  if (const Status fine = validate(answer.description()); !fine) {
    answer.set_error(fmt::format("'{}' cannot be walked in: {}", order.path(), fine.error().message()));
    return answer;
  }
  answer.set_load_seconds(to_seconds(SteadyClock().now() - begun));
  answer.set_memory_bytes((*renderer)->memory_bytes());
  scenes_[order.scene()] = {order.path(), *std::move(renderer), answer};
  return answer;
}

BlockRenderer* SceneStore::find(const std::string& scene) const {
  const auto known = scenes_.find(scene);
  return known == scenes_.end() ? nullptr : known->second.renderer.get();
}

Result<std::unique_ptr<BlockRenderer>> SceneStore::load_guarded(const std::string& path,
                                                                const std::function<void(double)>& progress) {
  try {
    return loader_(path, progress);
  } catch (const std::bad_alloc&) {
    return Error(ErrorCode::kSystem, fmt::format("'{}' needs more memory than this host has; take a smaller scene, or "
                                                 "leave this host out of the farm",
                                                 path));
  } catch (const std::exception& error) {
    return Error(ErrorCode::kSystem, fmt::format("'{}': unexpected: {}", path, error.what()));
  }
}

}  // namespace cyclorama
