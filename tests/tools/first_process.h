// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fcntl.h>
#include <sys/mount.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <string>
#include <system_error>
#include <vector>

namespace cyclorama {

/// Prepares the first process of a virtual machine: mounts the file systems that programs need, makes the console
/// standard output, and loads /modules/* in the order of their names, each with the parameters that `parameters_of`
/// returns for its name ("vivid").
inline void become_first_process(const std::function<std::string(const std::string&)>& parameters_of) {
  for (const char* folder : {"/dev", "/proc", "/sys", "/tmp"}) ::mkdir(folder, 0755);
  ::mount("none", "/dev", "devtmpfs", 0, nullptr);
  ::mount("none", "/proc", "proc", 0, nullptr);
  ::mount("none", "/sys", "sysfs", 0, nullptr);
  const int console = ::open("/dev/console", O_RDWR);
  for (int fd = 0; fd < 3; ++fd) ::dup2(console, fd);
  std::vector<std::filesystem::path> modules;
  std::error_code is_absent;
  for (const auto& entry : std::filesystem::directory_iterator("/modules", is_absent)) modules.push_back(entry.path());
  std::sort(modules.begin(), modules.end());
  for (const std::filesystem::path& module : modules) {
    const int fd = ::open(module.c_str(), O_RDONLY | O_CLOEXEC);
    const std::string stem = module.stem();
    const std::string parameters = parameters_of(stem.substr(stem.find('-') + 1));
    if (::syscall(SYS_finit_module, fd, parameters.c_str(), 0) != 0) std::perror(module.c_str());
    ::close(fd);
  }
}

}  // namespace cyclorama
