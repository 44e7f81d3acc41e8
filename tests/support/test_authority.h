// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "common/wire/tls.h"

namespace cyclorama {

/// Returns the output of a shell command from both streams.
inline std::string output_of(const std::string& command) {
  std::string text;
  FILE* const pipe = ::popen(("{ " + command + "; } 2>&1").c_str(), "r");
  if (pipe == nullptr) return "it cannot be started";
  std::array<char, 4096> part{};
  for (std::size_t n = 0; (n = std::fread(part.data(), 1, part.size(), pipe)) > 0;) text.append(part.data(), n);
  ::pclose(pipe);
  return text;
}

/// A temporary authority in a separate folder, made by the program that farms use.
class TestAuthority {
 public:
  TestAuthority() {
    std::string folder = (std::filesystem::temp_directory_path() / "authority-XXXXXX").string();
    EXPECT_NE(::mkdtemp(folder.data()), nullptr);
    folder_ = folder;
    run("init");
  }
  ~TestAuthority() { std::filesystem::remove_all(folder_); }
  TestAuthority(const TestAuthority&) = delete;
  TestAuthority& operator=(const TestAuthority&) = delete;

  /// Runs cyclorama-authority with these arguments and returns its output.
  std::string run(const std::string& words) {
    const char* const source = std::getenv("CYCLORAMA_SOURCE");
    return output_of("cd '" + folder_.string() + "' && '" + (source != nullptr ? source : ".") +
                     "/renderfarm/authority/cyclorama-authority' --folder ca " + words);
  }
  /// Makes a bundle with arguments such as "node n1", and unpacks it over the previous bundle with this name.
  TlsFiles make(const std::string& words, const std::string& name) {
    const std::string said = run(words + " --output bundle.tar --replace");
    const std::filesystem::path to = folder_ / name;
    std::filesystem::create_directories(to);
    EXPECT_EQ(output_of("tar -xf '" + (folder_ / "bundle.tar").string() + "' -C '" + to.string() + "'"), "") << said;
    return {to / "authority.crt", to / "certificate.crt", to / "key.pem"};
  }
  TlsFiles coordinator(const std::string& address = "::1") {
    return make("coordinator farm --address " + address, "farm");
  }
  TlsFiles node(const std::string& name) { return make("node " + name, name); }
  TlsFiles museum(const std::string& name) { return make("museum " + name, name); }

  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }
  [[nodiscard]] std::filesystem::path revocations() const { return folder_ / "ca" / "crl.pem"; }

 private:
  std::filesystem::path folder_;
};

}  // namespace cyclorama
