// SPDX-License-Identifier: Apache-2.0
#include "kiosk/provision/folder_check.h"

#include <fmt/format.h>

#include <system_error>

#include "common/base/file.h"
#include "common/base/text.h"
#include "common/process/child.h"
#include "common/wire/openssl.h"

namespace cyclorama::provision {

namespace fs = std::filesystem;

namespace {
constexpr std::size_t kMaxTextBytes = 1 << 20;
/// Generous, so that only a program that hangs exceeds it: a computer that is busy with the show is slow, and that does
/// not make its settings wrong.
constexpr ChildLimits kCheckLimits{std::chrono::minutes(5)};
}  // namespace

bool FolderCheck::has(const std::string& name) const {
  std::error_code ignored;
  return fs::is_regular_file(fs::symlink_status(in(name), ignored));
}

std::string FolderCheck::without_folder(std::string text) const {
  const std::string prefix = folder_.string() + "/";
  for (std::size_t at = 0; (at = text.find(prefix, at)) != std::string::npos;) text.erase(at, prefix.size());
  return text;
}

void FolderCheck::problem(const std::string& text) { verdict_.problems.push_back(without_folder(text)); }
void FolderCheck::remark(const std::string& text) { verdict_.remarks.push_back(without_folder(text)); }

bool FolderCheck::is_within(const fs::path& path, const std::string& where, const std::string& name) {
  const fs::path within = path.lexically_normal().lexically_relative(folder_);
  if (within.empty() || within.is_absolute() || *within.begin() == "..") {
    problem(fmt::format(
        "{} names {}, which is not in the folder; put it beside the settings and name it without a path", where, name));
    return false;
  }
  std::error_code ignored;
  if (fs::is_regular_file(fs::symlink_status(path, ignored))) return true;
  problem(fmt::format("{} names {}, which is not there; copy it too", where, name));
  return false;
}

bool FolderCheck::is_ours(const fs::path& path, const std::string& where) {
  const std::string name = path.string();
  const bool is_content = name.find('\n') != std::string::npos || name.find("-----") != std::string::npos;
  return is_within(path, where, is_content ? "a file's content" : "'" + printable(name, 200) + "'");
}

bool FolderCheck::is_ours_unquoted(const fs::path& path, const std::string& where) {
  return is_within(path, where, "a file");
}

void FolderCheck::keep_secret(const fs::path& path, const std::string& group) {
  verdict_.secrets.push_back({path.lexically_normal().lexically_relative(folder_), group});
}

void FolderCheck::check_certificates(const TlsFiles& files, Role role, const std::string& where,
                                     const std::string& group, const std::string& words) {
  bool all = is_ours(files.authority, where + " authority");
  all = is_ours(files.certificate, where + " certificate") && all;
  all = is_ours(files.key, where + " key") && all;
  if (!all) return;
  keep_secret(files.key, group);
  const auto owner = check(files);
  if (!owner) return problem(owner.error().message());
  if (owner->role != role) {
    return problem(fmt::format("'{}' is the certificate of {}; a {} needs one that cyclorama-authority made with '{}'",
                               files.certificate.string(), to_text(*owner), to_text(role), words));
  }
  const auto pem = read_text_file(files.certificate, kMaxTextBytes);
  if (!pem) return problem(pem.error().message());
  const auto certificate = parse_certificate(*pem);
  if (!certificate) return;
  const std::string until = day_text(X509_get0_notAfter(certificate->get()));
  if (verdict_.certificate_until.empty() || until < verdict_.certificate_until) verdict_.certificate_until = until;
}

void FolderCheck::ask(std::vector<std::string> command) {
  if (how_.programs.empty() || !verdict_.problems.empty()) return;
  const std::string name = command.front();
  command.front() = (how_.programs / name).string();
  const auto end = run_child(command, kCheckLimits);
  if (!end) return problem(end.error().message());
  if (end->exit_code == 0) return;
  // The last line of the output contains the reason.
  std::string said = end->output;
  while (!said.empty() && said.back() == '\n') said.pop_back();
  said.erase(0, said.rfind('\n') + 1);
  if (said.starts_with("<") && said.find('>') == 2) said.erase(0, 3);  // Removes the journal's priority prefix.
  problem(fmt::format("{} refuses them: {}", name, printable(without_folder(said), 1000)));
}

}  // namespace cyclorama::provision
