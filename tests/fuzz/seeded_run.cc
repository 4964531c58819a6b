// SPDX-License-Identifier: Apache-2.0
// Runs a fuzz target without libFuzzer, in every build:
//   TARGET             its seeds, and 4000 inputs that are made of them by mutations
//   TARGET --seeds DIR writes the seeds as files, for libFuzzer to begin with
#include <algorithm>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <random>

#include "tests/fuzz/fuzz_target.h"
#include "tests/fuzz/mutations.h"

namespace {

constexpr int kInputs = 4000;
constexpr std::size_t kMostKept = 64;  // mutations of mutations

void Run(const std::string& input) {
  const std::vector<std::uint8_t> bytes(input.begin(), input.end());  // so that ASan sees its end
  LLVMFuzzerTestOneInput(bytes.data(), bytes.size());
}

int WriteSeeds(const std::string& folder, const std::vector<std::string>& seeds) {
  for (std::size_t i = 0; i < seeds.size(); ++i) {
    std::ofstream file(folder + "/seed" + std::to_string(i), std::ios::binary);
    if (!(file << seeds[i] << std::flush)) return 1;
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<std::string> inputs = physpring::FuzzSeeds();
  if (argc == 3 && std::strcmp(argv[1], "--seeds") == 0) return WriteSeeds(argv[2], inputs);
  if (argc != 1) return 2;
  for (const std::string& input : inputs) Run(input);
  const std::size_t seeds = inputs.size();
  std::mt19937 random(1);
  for (int i = 0; i < kInputs; ++i) {
    std::string input = inputs[random() % inputs.size()];
    physpring::MutateBytes(random, &input);
    Run(input);
    if (inputs.size() < seeds + kMostKept) {
      inputs.push_back(input);
    } else if (random() % 8 == 0) {
      inputs[seeds + random() % kMostKept] = input;
    }
  }
  std::printf("%zu seeds and %d mutations\n", seeds, kInputs);
  return 0;
}
