// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/node/scene_store.h"

#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <filesystem>
#include <new>

#include "common/base/clock.h"
#include "common/base/file.h"
#include "common/base/text.h"
#include "common/wire/convert.h"
#include "renderfarm/governor/pareto_front_file.h"
#include "renderfarm/governor/stored_light_front.h"

namespace cyclorama::node {
namespace {
constexpr std::size_t kMaxErrorBytes = 1000;

/// Returns the scene's own Pareto front, validated; empty if it has none.
Result<std::string> front_of(const std::filesystem::path& scene) {
  constexpr std::size_t kMaxBytes = std::size_t{1} << 20;
  const std::filesystem::path file = scene / governor::kParetoFrontFileName;
  std::error_code none;
  if (std::filesystem::exists(scene / "front.toml", none)) {
    return Error(ErrorCode::kBadData, fmt::format("'{}' is called {} now; rename it", (scene / "front.toml").string(),
                                                  governor::kParetoFrontFileName));
  }
  if (!std::filesystem::exists(file, none)) return std::string();
  TRY_ASSIGN(std::string text, read_text_file(file, kMaxBytes));
  TRY(governor::parse_pareto_front(text, file.string()));
  return text;
}

/// Returns a lower bound for the scene's memory: geometry usually takes at least its size on disk, and textures take
/// more.
std::uint64_t bytes_on_disk(const std::filesystem::path& scene) {
  std::error_code none;
  if (!std::filesystem::is_directory(scene, none)) {
    const auto bytes = std::filesystem::file_size(scene, none);
    return none ? 0 : bytes;
  }
  std::uint64_t sum = 0;
  for (std::filesystem::recursive_directory_iterator file(scene, none), end; !none && file != end;
       file.increment(none)) {
    std::error_code unknown;
    if (const auto bytes = file->file_size(unknown); !unknown) sum += bytes;
  }
  return sum;
}

bool has_light(const BlockRenderer& renderer) {
  return renderer.light_versions() != nullptr && renderer.light_versions()->newest();
}

double gibibytes(std::uint64_t bytes) { return static_cast<double>(bytes) / static_cast<double>(1 << 30); }

wire::SceneLoaded failed(const wire::LoadScene& order, const std::string& why) {
  wire::SceneLoaded answer;
  answer.set_scene(order.scene());
  answer.set_error(printable(why, kMaxErrorBytes));  // The reason may quote bytes of a file.
  return answer;
}

}  // namespace

wire::SceneLoaded SceneStore::load(LinkId link, const wire::LoadScene& order, const std::string& path,
                                   const std::function<void(double)>& progress, std::vector<Name>* ret_left) {
  const Name name{link, order.scene()};
  const auto named = [&](Loaded& loaded) {
    paths_[name] = path;
    loaded.used = ++uses_;
    return answer_for(loaded, order.scene());
  };
  Leaving leaving;
  {
    const std::lock_guard lock(mutex_);
    in_use_[link] = {order.in_use().begin(), order.in_use().end()};
    if (const auto known = scenes_.find(path); known != scenes_.end()) return named(known->second);
    rename(name, &leaving);
  }
  const std::uint64_t guess = max_bytes_ > 0 ? bytes_on_disk(path) : 0;
  {
    const std::lock_guard lock(mutex_);
    make_room(guess, &leaving);
  }
  leaving.renderers.clear();
  auto loaded = loaded_from(order.scene(), path, progress);
  const std::uint64_t needed = loaded ? loaded->answer.memory_bytes() : 0;
  const std::lock_guard lock(mutex_);
  const bool fits = loaded && make_room(needed, &leaving);
  *ret_left = std::move(leaving.names);
  if (!loaded) return failed(order, loaded.error().message());
  if (!fits) {
    return failed(order, fmt::format("'{}' takes {:.2f} GiB of memory, and this node may use {:.2f} GiB for scenes, of "
                                     "which {:.2f} GiB are in use; give it more (memory_gib), or end other sessions",
                                     path, gibibytes(needed), gibibytes(max_bytes_), gibibytes(bytes_in_use())));
  }
  return named(scenes_.emplace(path, *std::move(loaded)).first->second);
}

std::string SceneStore::path_of(LinkId link, const std::string& scene) const {
  const std::lock_guard lock(mutex_);
  const auto path = paths_.find({link, scene});
  return path == paths_.end() ? std::string() : path->second;
}

std::shared_ptr<BlockRenderer> SceneStore::at_path(const std::string& path) const {
  const std::lock_guard lock(mutex_);
  const auto scene = scenes_.find(path);
  return scene == scenes_.end() ? nullptr : scene->second.renderer;
}

std::vector<SceneStore::Name> SceneStore::names_of(const std::string& path) const {
  std::vector<Name> names;
  const std::lock_guard lock(mutex_);
  for (const auto& [name, at] : paths_) {
    if (at == path) names.push_back(name);
  }
  return names;
}

std::vector<std::pair<LinkId, wire::SceneLight>> SceneStore::light_reports(const std::string& path,
                                                                           const Result<VersionedLight>& light) {
  std::vector<std::pair<LinkId, wire::SceneLight>> reports;
  const std::lock_guard lock(mutex_);
  const auto scene = scenes_.find(path);
  if (scene == scenes_.end()) return reports;
  wire::SceneLight report;
  if (light) {
    *report.mutable_light() = version_message(*light);
    *scene->second.answer.mutable_light() = report.light();
    scene->second.answer.set_memory_bytes(scene->second.renderer->memory_bytes());
  } else {
    report.set_error(printable(light.error().message(), kMaxErrorBytes));
  }
  for (const auto& [name, at] : paths_) {
    if (at != path) continue;
    report.set_scene(name.scene);
    reports.emplace_back(name.link, report);
  }
  return reports;
}

wire::SceneLoaded SceneStore::answer_for(const Loaded& loaded, const std::string& name) {
  wire::SceneLoaded answer = loaded.answer;
  answer.set_scene(name);
  answer.mutable_description()->set_name(name);
  return answer;
}

bool SceneStore::has(const std::string& path) const {
  const std::lock_guard lock(mutex_);
  return scenes_.contains(path);
}

void SceneStore::rename(const Name& name, Leaving* ret_leaving) {
  const auto other = paths_.find(name);
  if (other == paths_.end()) return;
  const std::string path = other->second;
  paths_.erase(other);
  const auto scene = scenes_.find(path);
  const bool known = std::ranges::any_of(paths_, [&](const auto& entry) { return entry.second == path; });
  // Unloads the old scene first, so that memory never holds both, unless it is in use elsewhere.
  if (!known && may_leave(*scene)) drop(scene, ret_leaving);
}

std::shared_ptr<BlockRenderer> SceneStore::find(LinkId link, const std::string& scene) {
  const std::lock_guard lock(mutex_);
  const auto path = paths_.find({link, scene});
  if (path == paths_.end()) return nullptr;
  Loaded& loaded = scenes_.at(path->second);
  loaded.used = ++uses_;
  return loaded.renderer;
}

void SceneStore::forget_link(LinkId link) {
  const std::lock_guard lock(mutex_);
  std::erase_if(paths_, [&](const auto& entry) { return entry.first.link == link; });
  in_use_.erase(link);
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

Result<SceneStore::Loaded> SceneStore::loaded_from(const std::string& name, const std::string& path,
                                                   const std::function<void(double)>& progress) {
  const TimePoint begun = SteadyClock().now();
  TRY_ASSIGN(std::string front, front_of(path));
  TRY_ASSIGN(std::shared_ptr<BlockRenderer> renderer, load_guarded(path, progress));
  const bool uses_light = renderer->can_have_light() &&
                          (front.empty() || governor::uses_stored_light(*governor::parse_pareto_front(front, path)));
  std::string note = renderer->note();
  if (uses_light && !has_light(*renderer)) {
    if (const Status light = read_kept_light(path, *renderer); !light) note = light.error().message();
  }
  wire::SceneLoaded answer;
  answer.set_front(std::move(front));
  answer.set_note(printable(note, kMaxErrorBytes));
  answer.set_can_compute_light(uses_light && computes_light_);
  if (has_light(*renderer)) *answer.mutable_light() = version_message(*renderer->light_versions()->newest());
  *answer.mutable_description() = renderer->description();
  answer.mutable_description()->set_name(name);
  if (const Status fine = validate(answer.description()); !fine) {
    return Error(fine.error()).while_doing(fmt::format("'{}' cannot be walked in", path));
  }
  answer.set_load_seconds(to_seconds(SteadyClock().now() - begun));
  answer.set_memory_bytes(renderer->memory_bytes());
  answer.set_bounces(static_cast<std::uint32_t>(renderer->bounces()));
  answer.set_probe_cpu_seconds(renderer->probe_cpu_seconds());
  return Loaded{std::move(renderer), std::move(answer)};
}

Status SceneStore::read_kept_light(const std::string& path, BlockRenderer& renderer) const {
  const std::filesystem::path file = light_.file_of(path);
  std::error_code none;
  if (file.empty() || !std::filesystem::is_regular_file(file, none)) return Done{};
  TRY_ASSIGN(const MappedFile mapped, MappedFile::open(file));
  TRY(renderer.add_light(mapped.bytes(), file.string()));
  return Done{};
}

bool SceneStore::make_room(std::uint64_t needed, Leaving* ret_leaving) {
  if (max_bytes_ == 0) return true;
  if (bytes_in_use() + needed > max_bytes_) return false;  // Unloading cannot free enough memory.
  while (bytes() + needed > max_bytes_) {
    auto oldest = scenes_.end();
    for (auto scene = scenes_.begin(); scene != scenes_.end(); ++scene) {
      if (!may_leave(*scene)) continue;
      if (oldest == scenes_.end() || scene->second.used < oldest->second.used) oldest = scene;
    }
    drop(oldest, ret_leaving);
  }
  return true;
}

void SceneStore::drop(Scenes::iterator scene, Leaving* ret_leaving) {
  std::erase_if(paths_, [&](const auto& entry) {
    if (entry.second != scene->first) return false;
    ret_leaving->names.push_back(entry.first);
    return true;
  });
  ret_leaving->renderers.push_back(std::move(scene->second.renderer));
  scenes_.erase(scene);
}

bool SceneStore::may_leave(const Scenes::value_type& scene) const {
  if (scene.second.renderer.use_count() > 1) return false;  // Blocks that wait for the scene hold a pointer to it.
  return std::ranges::none_of(paths_, [&](const auto& entry) {
    const auto used = in_use_.find(entry.first.link);
    return entry.second == scene.first && used != in_use_.end() && used->second.contains(entry.first.scene);
  });
}

std::uint64_t SceneStore::bytes_in_use() const {
  std::uint64_t sum = 0;
  for (const auto& scene : scenes_) sum += may_leave(scene) ? 0 : scene.second.answer.memory_bytes();
  return sum;
}

std::uint64_t SceneStore::bytes() const {
  std::uint64_t sum = 0;
  for (const auto& [path, loaded] : scenes_) sum += loaded.answer.memory_bytes();
  return sum;
}

}  // namespace cyclorama::node
