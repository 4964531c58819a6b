// SPDX-License-Identifier: Apache-2.0
// For tests in Python: make_small_twin FOLDER writes a twin of two levels that was trained on the
// motion of a body that weighs more on one side, that recording, and another one to judge by. Its
// name has letters that a page must escape.
#include <filesystem>

#include "tests/support/small_twin.h"

namespace physpring {
namespace {

void WriteInto(const std::filesystem::path& folder) {
  Twin heavy = SmallTwin(1);
  heavy.levels[0].system.mass.head(8) *= 3;
  const std::string swing = folder / "swing.npz";
  WriteRecording(RecordingOfMotion(heavy, 10), swing);
  WriteRecording(RecordingOfMotion(heavy, 12), folder / "<b>held & 'back'.npz");
  Twin twin = SmallTwin(2);
  twin.trained_on = {{"swing", ReadRecording(swing).hash, 10}};
  WriteTwin(twin, folder / "small.twin.npz");
}

}  // namespace
}  // namespace physpring

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  physpring::WriteInto(argv[1]);
  return 0;
}
