// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/generator/package.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <system_error>

#include "common/base/file.h"
#include "renderfarm/generator/interior.h"
#include "renderfarm/generator/ply_writer.h"
#include "renderfarm/generator/relic.h"
#include "renderfarm/generator/scene_writer.h"

namespace cyclorama::generator {
namespace {

namespace fs = std::filesystem;

/// A new folder; the destructor removes whatever is then at its path.
class Scaffold {
 public:
  static Result<Scaffold> beside(const fs::path& target) {
    std::string name = target.string() + ".XXXXXX";
    if (::mkdtemp(name.data()) == nullptr)
      return Error::from_errno(fmt::format("creating a folder beside '{}'", target.string()));
    return Scaffold(name);
  }
  Scaffold(Scaffold&& other) noexcept : path_(std::exchange(other.path_, {})) {}
  Scaffold& operator=(Scaffold&&) = delete;
  ~Scaffold() {
    std::error_code ignored;
    if (!path_.empty()) fs::remove_all(path_, ignored);
  }

  [[nodiscard]] const fs::path& path() const { return path_; }

 private:
  explicit Scaffold(fs::path path) : path_(std::move(path)) {}
  fs::path path_;
};

bool is_grotto(const fs::path& folder) {
  const auto text = read_text_file(folder / "scene.toml", std::size_t{1} << 20);
  return text && text->starts_with(kSceneMark);
}

/// Checks that the target does not exist, is empty, or is a grotto that may be replaced.
Status check_target(const fs::path& folder, bool replace) {
  std::error_code error;
  const fs::file_status status = fs::status(folder, error);
  if (status.type() == fs::file_type::not_found) return Done{};
  if (error) return Error(ErrorCode::kSystem, fmt::format("'{}': {}", folder.string(), error.message()));
  if (status.type() != fs::file_type::directory) {
    return Error(ErrorCode::kBusy,
                 fmt::format("'{}' exists and is not a folder: choose another --out", folder.string()));
  }
  const bool empty = fs::is_empty(folder, error);
  if (error) return Error(ErrorCode::kSystem, fmt::format("'{}': {}", folder.string(), error.message()));
  if (empty) return Done{};
  if (!is_grotto(folder)) {
    return Error(ErrorCode::kBusy,
                 fmt::format("'{}' holds something that is not a grotto: choose another --out", folder.string()));
  }
  if (replace) return Done{};
  return Error(ErrorCode::kBusy, fmt::format("'{}' holds a grotto already: --force replaces it", folder.string()));
}

Status check_space(const fs::path& folder, const fs::path& target, std::uint64_t bytes) {
  std::error_code error;
  const fs::space_info space = fs::space(folder, error);
  if (error || space.available >= bytes) return Done{};
  constexpr double kGigabyte = 1e9;
  return Error(ErrorCode::kSystem,
               fmt::format("the disk of '{}' has {:.3f} GB free; this grotto takes {:.3f} GB", target.string(),
                           static_cast<double>(space.available) / kGigabyte, static_cast<double>(bytes) / kGigabyte));
}

Status rename_folder(const fs::path& from, const fs::path& to) {
  if (::rename(from.c_str(), to.c_str()) == 0) return Done{};
  return Error::from_errno(fmt::format("renaming to '{}'", to.string()));
}

/// Moves the finished folder to its place; the path of `scaffold` then names the previous content, which its destructor
/// removes.
Status put_in_place(const Scaffold& scaffold, const fs::path& target) {
  if (::renameat2(AT_FDCWD, scaffold.path().c_str(), AT_FDCWD, target.c_str(), RENAME_EXCHANGE) == 0) return Done{};
  if (errno == ENOENT) return rename_folder(scaffold.path(), target);  // There is nothing to exchange with.
  if (errno != EINVAL && errno != ENOSYS) return Error::from_errno(fmt::format("replacing '{}'", target.string()));
  // The file system does not support exchange: the old folder is moved aside first.
  TRY_ASSIGN(const Scaffold old, Scaffold::beside(target));
  TRY(rename_folder(target, old.path()));
  if (Status status = rename_folder(scaffold.path(), target); !status) {
    TRY(rename_folder(old.path(), target));
    return status;
  }
  return Done{};
}

Result<Grotto> plan(const PackageOrder& order) {
  if (order.kind == Kind::kInterior) return plan_interior(order.triangles, order.seed, order.lamps);
  if (order.kind == Kind::kRelic) return plan_relic(order.triangles, order.seed);
  return plan_grotto(order.triangles, order.seed);
}

}  // namespace

Result<PackageReport> write_package(const PackageOrder& order, const KeepGoing& keep_going) {
  TRY_ASSIGN(const Grotto grotto, plan(order));
  const Shading shading = grotto.kind == Kind::kInterior ? Shading::kFlat : Shading::kSmooth;
  // 'grottos/one/' names the same folder as 'grottos/one'.
  const fs::path target = order.folder.has_filename() ? order.folder : order.folder.parent_path();
  TRY(check_target(target, order.replace));
  PackageReport report{.counts = grotto.counts()};
  for (const Part& part : grotto.parts) report.bytes += ply_bytes(part.counts(), shading);
  TRY_ASSIGN(const Scaffold scaffold, Scaffold::beside(target));
  TRY(check_space(scaffold.path(), target, report.bytes));
  PlySink sink(scaffold.path(), shading);
  TRY(generate(grotto, sink, order.threads, keep_going));
  TRY(write_file_atomically(scaffold.path() / "scene.toml", scene_toml(grotto, order.seed)));
  if (::chmod(scaffold.path().c_str(), 0755) != 0)
    return Error::from_errno(fmt::format("opening '{}' to readers", target.string()));
  TRY(put_in_place(scaffold, target));
  return report;
}

}  // namespace cyclorama::generator
