// SPDX-License-Identifier: Apache-2.0
// A .ply file of splats, up to a small picture.
#include <filesystem>
#include <stdexcept>

#include "splats/rasterise.h"
#include "splats/splat_file.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/splats/random_splats.h"
#include "twin/atomic_file.h"

namespace physpring {
namespace {

void Use(const Splats& splats) {
  PinholeCamera camera{8, 6};
  camera.shift = {0, 0, 1};
  camera.fx = camera.fy = 6;
  camera.cx = 4;
  camera.cy = 3;
  for (const float x : Rasterise(AsStored(splats), camera, {}, 1).rgb) {
    if (!(x >= 0)) throw std::logic_error("a colour that is none");
  }
}

std::string Bytes(int count, int degree) {
  const std::string file = FuzzFolder() + "/seed.ply";
  WriteSplats(RandomSplats(count, degree, 1), file);
  std::string bytes = ReadFile(file);
  std::filesystem::remove(file);
  return bytes;
}

}  // namespace
}  // namespace physpring

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace physpring;
  const std::string file = FuzzFolder() + "/a.ply";
  WriteFuzzFile(file, TextOf(data, size));
  MayRefuse(FuzzFolder(), [&] { Use(ReadSplats(file)); });
  return 0;
}

std::vector<std::string> physpring::FuzzSeeds() { return {Bytes(3, 0), Bytes(2, 1), Bytes(1, 3)}; }
