// SPDX-License-Identifier: Apache-2.0
// A twin, exported to a folder that lives as long as the test, and its files in MuJoCo.
#ifndef PHYSPRING_TESTS_SUPPORT_EXPORTED_FOLDER_H_
#define PHYSPRING_TESTS_SUPPORT_EXPORTED_FOLDER_H_

#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "exporter/export.h"
#include "exporter/folder.h"
#include "rollout/scene.h"
#include "tests/support/temporary_folder.h"

namespace physpring {

class ExportedFolder {
 public:
  ExportedFolder(const Twin& twin, const ExportOptions& options)
      : result(ExportTwin(twin, options, "physpring export")) {
    WriteFolder(File(""), result.files, false);
  }

  std::string File(const std::string& name) const { return folder_.File("model/" + name); }

  // Compiles one of its files; throws when MuJoCo refuses or warns.
  ModelPtr Load(const std::string& name) const {
    std::vector<std::string> warnings;
    ModelPtr model = LoadScene(File(name), &warnings);
    if (!warnings.empty()) throw std::runtime_error(warnings.front());
    return model;
  }

  // Compiles a scene that may name files of the folder.
  ModelPtr LoadText(const std::string& mjcf) const {
    std::ofstream(File("of_the_test.xml")) << mjcf;
    return Load("of_the_test.xml");
  }

  const Export result;

 private:
  TemporaryFolder folder_;
};

}  // namespace physpring

#endif  // PHYSPRING_TESTS_SUPPORT_EXPORTED_FOLDER_H_
