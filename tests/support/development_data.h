// SPDX-License-Identifier: Apache-2.0
// Measured recordings for development, which are no part of the project: in the folder that the
// environment variable PHYSPRING_DATA names, else in ../shared/data from the project's root.
#ifndef PHYSPRING_TESTS_SUPPORT_DEVELOPMENT_DATA_H_
#define PHYSPRING_TESTS_SUPPORT_DEVELOPMENT_DATA_H_

#include <cstdlib>
#include <filesystem>
#include <string>

namespace physpring {

// The folder, or "" where there is none: then a test says so and is skipped,
//   if (DevelopmentData().empty()) GTEST_SKIP() << kNoDevelopmentData;
inline std::string DevelopmentData() {
  const char* const named = std::getenv("PHYSPRING_DATA");
  const std::filesystem::path folder =
      named ? std::filesystem::path(named)
            : std::filesystem::path(PHYSPRING_SOURCE_DIR) / "../shared/data";
  std::error_code missing;
  return std::filesystem::is_directory(folder, missing) ? folder.string() : "";
}

inline constexpr const char* kNoDevelopmentData =
    "the recordings for development are absent (PHYSPRING_DATA)";

}  // namespace physpring

#endif  // PHYSPRING_TESTS_SUPPORT_DEVELOPMENT_DATA_H_
