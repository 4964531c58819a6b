// SPDX-License-Identifier: Apache-2.0
// An .npz archive: zip, members, headers, and values as numbers and text.
#include "twin/npz.h"

#include <stdexcept>

#include "tests/fuzz/fuzz_target.h"

namespace physpring {
namespace {

void Use(const NpzArray& array) {
  MayRefuse("has the type", [&] { array.ToText(); });
  MayRefuse("holds ", [&] { array.ToInts(); });
  if (array.ToDoubles().size() != array.size()) throw std::logic_error("sizes differ");
}

}  // namespace
}  // namespace physpring

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace physpring;
  MayRefuse("file: ", [&] {
    const Npz arrays = ParseNpz(std::string(TextOf(data, size)), "file");
    for (const auto& [name, array] : arrays) Use(array);
  });
  return 0;
}

std::vector<std::string> physpring::FuzzSeeds() {
  const std::vector<double> values{1, -2.5, 1e300, 0, 7, 3};
  const std::vector<int> whole{-1, 2147483647};
  const Npz arrays{{"a", NpzArray::Doubles({2, 3}, values.data())},
                   {"b/c", NpzArray::Ints({2}, whole.data())},
                   {"text", NpzArray::Text(std::string(2000, 'x'))}};
  return {PackNpz(arrays, "file"), PackNpz({{"a", NpzArray::Floats({6}, values.data())}}, "file"),
          PackNpz({{"scalar", NpzArray::Doubles({}, values.data())},
                   {"none", NpzArray::Doubles({4, 0, 3}, nullptr)}},
                  "file")};
}
