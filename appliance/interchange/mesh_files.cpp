// SPDX-License-Identifier: Apache-2.0
#include "appliance/interchange/mesh_files.h"

#include <fmt/format.h>

#include <utility>

#include "common/base/file.h"

namespace cyclorama::interchange {
namespace {

template <typename Parse>
Result<WarpNet> read_with(const std::filesystem::path& path, const Parse& parse) {
  TRY_ASSIGN(const std::string text, read_text_file(path, kWarpTextLimitBytes));
  Result<WarpNet> net = parse(text);
  if (!net) return std::move(net).error().while_doing(fmt::format("reading mesh '{}'", path.string()));
  return net;
}

}  // namespace

Result<WarpNet> read_bourke(const std::filesystem::path& path, double aspect) {
  return read_with(path, [&](std::string_view text) { return parse_bourke(text, aspect); });
}

Result<WarpNet> read_warp_obj(const std::filesystem::path& path) { return read_with(path, parse_warp_obj); }

Result<WarpNet> read_domeprojection(const std::filesystem::path& path) { return read_with(path, parse_domeprojection); }

Result<WarpNet> read_simcad(const std::filesystem::path& path) { return read_with(path, parse_simcad); }

Status write_bourke(const std::filesystem::path& path, const WarpNet& net, double aspect) {
  TRY_ASSIGN(const std::string text, print_bourke(net, aspect));
  return write_file_atomically(path, text);
}

Status write_warp_obj(const std::filesystem::path& path, const WarpNet& net) {
  TRY_ASSIGN(const std::string text, print_warp_obj(net));
  return write_file_atomically(path, text);
}

}  // namespace cyclorama::interchange
