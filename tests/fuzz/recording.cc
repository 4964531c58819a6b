// SPDX-License-Identifier: Apache-2.0
// The arrays of a recording, as array_bytes.h writes them.
#include "twin/recording.h"

#include "report/info_text.h"
#include "tests/fuzz/array_bytes.h"
#include "tests/fuzz/fuzz_target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace physpring;
  const Npz arrays = ArraysOf(TextOf(data, size));
  MayRefuse("file: ", [&] {
    const Recording recording = ParseRecording(arrays, "file");  // what is read can be described
    DescribeRecording(recording);
    RecordingToJson(recording).dump();
  });
  return 0;
}

std::vector<std::string> physpring::FuzzSeeds() {
  // 4 frames of 3 points, 1 interior particle and 1 controller, with every array
  Npz arrays;
  std::vector<double> numbers(4 * 3 * 3);
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    numbers[i] = 0.1 * static_cast<double>(i * i % 17) + 0.01 * static_cast<double>(i);
  }
  const double fps = 30, mass = 0.2, ground[] = {0, 0, 1, -1}, gravity[] = {0, 0, -9.81};
  const int train_frames = 3;
  arrays["points"] = NpzArray::Floats({4, 3, 3}, numbers.data());
  arrays["controllers"] = NpzArray::Floats({4, 1, 3}, numbers.data());
  arrays["fps"] = NpzArray::Doubles({}, &fps);
  const Npz least = arrays;
  arrays["mass"] = NpzArray::Doubles({}, &mass);
  arrays["gravity"] = NpzArray::Doubles({3}, gravity);
  arrays["ground"] = NpzArray::Doubles({4}, ground);
  arrays["interior"] = NpzArray::Floats({1, 3}, numbers.data() + 20);
  arrays["rest"] = NpzArray::Floats({5, 3}, numbers.data() + 3);
  arrays["velocity"] = NpzArray::Floats({4, 3}, numbers.data());
  arrays["order"] = NpzArray::Doubles({5}, numbers.data());
  arrays["surface"] = NpzArray::Floats({4, 2, 3}, numbers.data());
  arrays["track"] = NpzArray::Floats({4, 1, 3}, numbers.data());
  arrays["train_frames"] = NpzArray::Ints({}, &train_frames);
  Npz clouds = least;
  clouds.erase("points");
  clouds["surface"] = arrays["surface"];
  const double times[] = {0, 0.1, 0.2, 0.4}, hand_times[] = {0.05, 0.15, 0.3, 0.35};
  const int held[] = {0, 1, 1, 0};
  Npz timed = least;
  timed["timestamps"] = NpzArray::Doubles({4}, times);
  timed["controller_timestamps"] = NpzArray::Doubles({4}, hand_times);
  timed["force"] = NpzArray::Doubles({4, 1, 3}, numbers.data());
  timed["held"] = NpzArray::Ints({4, 1}, held);
  const double weight[] = {1, 1, 1, 0, 2, 2, 1, 1, 1, 0.5, 1, 1};
  timed["weight"] = NpzArray::Doubles({4, 3}, weight);
  timed.erase("fps");
  Npz forked = least;
  const int edges[] = {0, 1, 1, 2, 1, 3};
  forked["rod"] = NpzArray::Ints({3, 2}, edges);
  Npz empty = least;
  empty["points"] = NpzArray::Floats({65535, 0, 3}, nullptr);  // 2^31 - 1 frames of nothing
  empty["controllers"] = empty["points"];
  Npz none = least;
  none["points"] = NpzArray::Floats({0, 3, 3}, nullptr);
  return {BytesOf(arrays), BytesOf(least), BytesOf(clouds), BytesOf(timed),
          BytesOf(forked), BytesOf(empty), BytesOf(none)};
}
