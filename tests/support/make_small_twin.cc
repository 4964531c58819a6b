// SPDX-License-Identifier: Apache-2.0
// For tests in Python: make_small_twin FOLDER writes a twin of two levels that was trained on the
// motion of a body that weighs more on one side, that recording, another one to judge by, whose
// name has letters that a page must escape, one whose points have no names, and one that declares
// two objects.
#include <filesystem>

#include "tests/support/small_twin.h"

namespace physpring {
namespace {

Recording CloudsOf(const Recording& recording) {
  Recording clouds = recording;
  clouds.surface = recording.points;
  clouds.points.assign(recording.points.size(), Points(3, 0));
  clouds.interior.resize(3, 0);
  clouds.velocity.resize(3, 0);
  return clouds;
}

void WriteInto(const std::filesystem::path& folder) {
  Twin heavy = SmallTwin(1);
  heavy.levels[0].system.mass.head(8) *= 3;
  const std::string swing = folder / "swing.npz";
  WriteRecording(RecordingOfMotion(heavy, 10), swing);
  WriteRecording(RecordingOfMotion(heavy, 12), folder / "<b>held & 'back'.npz");
  WriteRecording(CloudsOf(RecordingOfMotion(heavy, 10)), folder / "clouds.npz");
  Recording two = RecordingOfMotion(heavy, 10);
  two.object = Eigen::VectorXi::Zero(two.start.cols());
  two.object.head(16).setOnes();
  WriteRecording(two, folder / "two.npz");
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
