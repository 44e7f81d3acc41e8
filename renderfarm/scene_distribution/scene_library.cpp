// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene_distribution/scene_library.h"

#include <fmt/format.h>

#include <utility>

namespace cyclorama::scene_distribution {
namespace {

constexpr Duration kProgressPeriod = std::chrono::seconds(5);
constexpr Duration kTryAgainAfter = std::chrono::seconds(2);

}  // namespace

SceneLibrary::SceneLibrary(std::vector<Source> sources, std::filesystem::path digests,
                           std::function<void(News)> on_news)
    : on_news_(std::move(on_news)) {
  is_reading_ = !sources.empty();
  if (sources.empty()) return;
  thread_ = std::jthread([this, sources = std::move(sources),
                          digests = std::move(digests)](const std::stop_token& stop) { run(stop, sources, digests); });
}

SceneLibrary::~SceneLibrary() = default;

std::shared_ptr<const SceneFiles> SceneLibrary::find(const std::string& digest) const {
  const std::lock_guard lock(mutex_);
  const auto found = scenes_.find(digest);
  return found == scenes_.end() ? nullptr : found->second;
}

Result<StampedFile> SceneLibrary::open(const std::string& sha256) const {
  std::vector<SceneListing::Place> places;
  const bool may_come = is_reading_;  // Read before the search, so that a file added in between is found.
  {
    const std::lock_guard lock(mutex_);
    if (const auto found = places_.find(sha256); found != places_.end()) places = found->second;
  }
  Error reason = may_come ? Error(ErrorCode::kUnavailable, "the coordinator is still reading its scenes")
                          : Error(ErrorCode::kNotFound, "no scene of this farm has that file");
  for (const SceneListing::Place& place : places) {
    auto file = open_stamped(place.path);
    // The file's name or owner may have changed, but not its bytes, which the receiver verifies.
    if (file && file->stamp.bytes == place.stamp.bytes && file->stamp.modified_ns == place.stamp.modified_ns) {
      return file;
    }
    reason = Error(ErrorCode::kNotFound,
                   fmt::format("'{}' was changed on the coordinator since it read it; restart the coordinator",
                               place.path.filename().string()));
  }
  return reason;
}

void SceneLibrary::run(const std::stop_token& stop, std::vector<Source> sources, const std::filesystem::path& digests) {
  DigestMemory memory(digests);
  std::map<std::string, std::string> last_reported;  // Sentence by scene; a repeated failure is not reported again.
  const auto on_news = [&](News news) {
    if (std::exchange(last_reported[news.scene], news.sentence) != news.sentence) on_news_(std::move(news));
  };
  for (std::size_t unread = sources.size(); !sources.empty();) {
    std::vector<Source> failed;
    for (Source& source : sources) {
      News news = read(stop, source, memory);
      if (stop.stop_requested()) return;
      if (unread > 0 && --unread == 0) is_reading_ = false;
      if (news.digest.empty()) failed.push_back(std::move(source));
      on_news(std::move(news));
    }
    sources = std::move(failed);
    if (const Status saved = memory.save(); !saved) {
      on_news({"", "", fmt::format("the scenes' digests cannot be kept: {}, ignoring", saved.error().message())});
    }
    std::unique_lock lock(mutex_);
    if (!sources.empty()) stopped_.wait_for(lock, stop, kTryAgainAfter, [] { return false; });
  }
}

SceneLibrary::News SceneLibrary::read(const std::stop_token& stop, const Source& source, DigestMemory& memory) {
  const SteadyClock clock;
  const TimePoint begun = clock.now();
  TimePoint reported_at = begun;
  auto listing = list_scene(source.path, memory, [&](double done) {
    if (clock.now() - reported_at > kProgressPeriod) {
      reported_at = clock.now();
      on_news_({source.name, "", fmt::format("reading the files of scene '{}': {:.0f} %", source.name, 100.0 * done)});
    }
    return !stop.stop_requested();
  });
  if (!listing) {
    return {source.name, "",
            fmt::format("scene '{}' cannot be given to nodes: {}", source.name, listing.error().message())};
  }
  News news{source.name, digest_of(listing->files), ""};
  news.sentence = fmt::format("scene '{}' is {} files of {:.2f} GiB, {}..., read in {:.1f} s", source.name,
                              listing->files.size(), static_cast<double>(bytes_of(listing->files)) / (1 << 30),
                              news.digest.substr(0, 12), to_seconds(clock.now() - begun));
  add(*std::move(listing));
  return news;
}

void SceneLibrary::add(SceneListing listing) {
  const std::lock_guard lock(mutex_);
  for (std::size_t i = 0; i < listing.files.size(); ++i) {
    places_[listing.files[i].sha256].push_back(std::move(listing.places[i]));
  }
  std::string digest = digest_of(listing.files);
  scenes_.emplace(std::move(digest), std::make_shared<const SceneFiles>(std::move(listing.files)));
}

}  // namespace cyclorama::scene_distribution
