// SPDX-License-Identifier: Apache-2.0
// The header of one .npy array.
#include "twin/npy.h"

#include <stdexcept>

#include "tests/fuzz/fuzz_target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace physpring;
  const std::string_view bytes = TextOf(data, size);
  MayRefuse("", [&] {
    const std::size_t length = NpyHeaderLength(bytes.substr(0, kNpyPreamble));
    if (length > bytes.size()) return;  // the archive refuses it
    const NpyHeader header = ParseNpyHeader(bytes.substr(0, length));
    if (BytesOfType(header.type) == 0) throw std::logic_error("a type that is not read");
    CountOfShape(header.shape);
    FormatShape(header.shape);
  });
  return 0;
}

std::vector<std::string> physpring::FuzzSeeds() {
  std::string second = FormatNpyHeader({"|u1", {3, 4}});
  second[6] = 2;  // version 2: a length of 4 bytes
  second.insert(10, 2, '\0');
  return {FormatNpyHeader({"<f8", {}}), FormatNpyHeader({"<f4", {120, 76, 3}}), second,
          FormatNpyHeader({"<f2", {std::size_t{1} << 30, 0, 3}})};
}
