// SPDX-License-Identifier: Apache-2.0
// The text of a dataset.json, beside the one recording that it may list.
#include "twin/dataset.h"

#include "tests/fuzz/fuzz_target.h"

namespace physpring {
namespace {

// A folder with a file `a.npz`; nobody looks into it.
const std::string& DatasetFolder() {
  static const std::string folder = [] {
    WriteFuzzFile(FuzzFolder() + "/a.npz", "");
    return FuzzFolder();
  }();
  return folder;
}

}  // namespace
}  // namespace physpring

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace physpring;
  const std::string& folder = DatasetFolder();
  WriteFuzzFile(folder + "/dataset.json", TextOf(data, size));
  MayRefuse(folder, [&] { ListRecordings({folder}, Role::kFit); });
  MayRefuse(folder, [&] { ListRecordings({folder + "/a.npz"}, Role::kHeldout); });
  return 0;
}

std::vector<std::string> physpring::FuzzSeeds() {
  return {R"({"recordings": [{"file": "a.npz", "role": "fit", "continuous_recording": 0}]})",
          R"({"published_l1_m": {"a": 0.01}, "recordings": [{"file": "a.npz", "role": "heldout"},)"
          R"({"file": "./a.npz", "role": "fit"}], "more": [[[{}]], null, true, -1.5e-3]})"};
}
