// SPDX-License-Identifier: Apache-2.0
// A test with MuJoCo scene files of its own.
#ifndef PHYSPRING_TESTS_SUPPORT_SCENE_TEST_H_
#define PHYSPRING_TESTS_SUPPORT_SCENE_TEST_H_

#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "tests/support/temporary_folder.h"

namespace physpring {

class SceneTest : public testing::Test {
 protected:
  // Writes `mjcf` to a file that lives as long as the test and returns its path.
  std::string WriteScene(const std::string& mjcf) const {
    const std::string path = folder_.File("scene.xml");
    std::ofstream(path) << mjcf;
    return path;
  }

  TemporaryFolder folder_;
};

}  // namespace physpring

#endif  // PHYSPRING_TESTS_SUPPORT_SCENE_TEST_H_
