// SPDX-License-Identifier: Apache-2.0
#include "tests/fuzz/fuzz_target.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "tests/support/temporary_folder.h"

namespace physpring {
namespace {

constexpr std::size_t kLongestMessage = 1500;

[[noreturn]] void Give(const char* problem, const std::string& message) {
  std::fprintf(stderr, "a refusal %s: %s\n", problem, message.c_str());
  std::abort();
}

void CheckMessage(std::string_view start, const std::string& message) {
  if (!message.starts_with(start)) Give("begins otherwise", message);
  if (message.size() > kLongestMessage) Give("is long", message);
  const auto is_control = [](char c) { return c >= '\0' && c < ' '; };
  if (std::any_of(message.begin(), message.end(), is_control)) Give("is no plain line", message);
}

}  // namespace

void MayRefuse(std::string_view start, const std::function<void()>& parse) {
  try {
    parse();
  } catch (const std::runtime_error& error) {  // Error and PolicyError
    CheckMessage(start, error.what());
  }
}

const std::string& FuzzFolder() {
  const std::filesystem::path memory = "/dev/shm";
  static const TemporaryFolder folder(
      std::filesystem::is_directory(memory) ? memory : std::filesystem::temp_directory_path());
  return folder.path();
}

void WriteFuzzFile(const std::string& path, std::string_view bytes) {
  std::ofstream(path, std::ios::binary | std::ios::trunc) << bytes;
}

}  // namespace physpring
