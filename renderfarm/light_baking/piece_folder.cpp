// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/light_baking/piece_folder.h"

#define XXH_INLINE_ALL
#include <fmt/format.h>
#include <xxhash.h>

#include <cerrno>
#include <cstring>
#include <string_view>
#include <system_error>

#include "common/base/file.h"

namespace cyclorama::light_baking {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kMagic = "CYCPIECE";
constexpr std::uint32_t kFileVersion = 1;
constexpr std::size_t kHashBytes = sizeof(XXH128_hash_t);
constexpr std::size_t kMaxFileBytes = std::size_t{1} << 30;

PieceBytes header_of(const LightStage& stage, std::uint32_t piece) {
  PieceBytes header;
  const auto add = [&](const void* from, std::size_t bytes) {
    const auto* const begin = static_cast<const std::byte*>(from);
    header.insert(header.end(), begin, begin + bytes);
  };
  add(kMagic.data(), kMagic.size());
  for (const std::uint32_t number : {kFileVersion, stage.number, piece}) add(&number, sizeof(number));
  add(stage.key.data(), stage.key.size());
  return header;
}

Error write_error(const fs::path& folder, const Error& reason) {
  const int number = reason.errno_value();
  if (number != ENOSPC && number != EDQUOT && number != EFBIG) return reason;
  return Error(ErrorCode::kSystem,
               fmt::format("writing to '{}': its disk is full; free some of it and compute the light again: it goes on "
                           "where it ended",
                           folder.string()));
}

}  // namespace

fs::path unfinished_light(const fs::path& file) {
  // A hidden folder is no part of a scene that is distributed.
  return file.parent_path() / ("." + file.filename().string() + ".unfinished");
}

void PieceFolder::begin(const std::string& computation) {
  computation_ = computation;
  std::error_code error;
  std::vector<fs::path> others;
  for (fs::directory_iterator at(folder_, error), end; !error && at != end; at.increment(error)) {
    if (at->path().filename() != computation_) others.push_back(at->path());
  }
  for (const fs::path& other : others) fs::remove_all(other, error);
}

fs::path PieceFolder::file_of(std::uint32_t stage, std::uint32_t piece) const {
  return folder_ / computation_ / fmt::format("{}-{}", stage, piece);
}

std::optional<PieceBytes> PieceFolder::load(const LightStage& stage, std::uint32_t piece) const {
  Result<PieceBytes> file = read_file(file_of(stage.number, piece), kMaxFileBytes);
  const PieceBytes header = header_of(stage, piece);
  if (!file || file->size() < header.size() + kHashBytes) return std::nullopt;
  const std::size_t end = file->size() - kHashBytes;
  const XXH128_hash_t hash = XXH3_128bits(file->data(), end);
  if (std::memcmp(&hash, file->data() + end, kHashBytes) != 0) return std::nullopt;
  if (std::memcmp(header.data(), file->data(), header.size()) != 0) return std::nullopt;
  file->resize(end);
  file->erase(file->begin(), file->begin() + static_cast<std::ptrdiff_t>(header.size()));
  return *std::move(file);
}

Status PieceFolder::save(const LightStage& stage, std::uint32_t piece, std::span<const std::byte> results) const {
  PieceBytes file = header_of(stage, piece);
  file.insert(file.end(), results.begin(), results.end());
  const XXH128_hash_t hash = XXH3_128bits(file.data(), file.size());
  const std::span bytes = std::as_bytes(std::span(&hash, 1));
  file.insert(file.end(), bytes.begin(), bytes.end());
  const fs::path path = file_of(stage.number, piece);
  std::error_code error;
  fs::create_directories(path.parent_path(), error);
  if (const Status written = write_file_atomically(path, file); !written) return write_error(folder_, written.error());
  return Done{};
}

void PieceFolder::remove() const {
  std::error_code error;
  fs::remove_all(folder_, error);
}

Status KeptPieces::begin(const std::string& computation) {
  folder_.begin(computation);
  return Done{};
}

Status KeptPieces::complete(const LightStage& stage, const StageWork& work) {
  return for_pieces(all_pieces(stage), work.in_parallel, [&](std::uint32_t piece) -> Status {
    if (const auto kept = folder_.load(stage, piece); kept && work.take(piece, *kept)) return Done{};
    TRY_ASSIGN(const PieceBytes bytes, work.compute(piece));
    TRY(folder_.save(stage, piece, bytes));
    return work.take(piece, bytes);
  });
}

}  // namespace cyclorama::light_baking
