// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/node/scene_store.h"

#include <fmt/format.h>

#include <exception>
#include <new>

#include "common/base/clock.h"
#include "common/base/text.h"
#include "common/wire/convert.h"

namespace cyclorama {
namespace {
constexpr std::size_t kLongestError = 1000;
}  // namespace

wire::SceneLoaded SceneStore::load(const wire::LoadScene& order, const std::function<void(double)>& progress) {
  if (const auto known = scenes_.find(order.scene()); known != scenes_.end()) {
    if (known->second.path == order.path()) return known->second.answer;
    scenes_.erase(known);  // First, so that memory never holds both.
  }
  wire::SceneLoaded answer;
  answer.set_scene(order.scene());
  const TimePoint begun = SteadyClock().now();
  auto renderer = load_guarded(order.path(), progress);
  if (!renderer) {
    answer.set_error(printable(renderer.error().message(), kLongestError));  // May quote a file's bytes.
    return answer;
  }
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
