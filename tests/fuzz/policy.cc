// SPDX-License-Identifier: Apache-2.0
// What a policy server says: its metadata and its answers, in msgpack.
#include <msgpack.hpp>
#include <stdexcept>

#include "rollout/policies/openpi_messages.h"
#include "tests/fuzz/fuzz_target.h"

namespace physpring {
namespace {

constexpr int kNumbers = 2;  // of an action

std::string Answer(const char* type, std::size_t bytes, std::uint64_t actions) {
  msgpack::sbuffer buffer;
  msgpack::packer<msgpack::sbuffer> packer(buffer);
  const auto pack_bytes = [&packer](const std::string& text) {
    packer.pack_bin(static_cast<std::uint32_t>(text.size()));
    packer.pack_bin_body(text.data(), static_cast<std::uint32_t>(text.size()));
  };
  packer.pack_map(2);
  packer.pack(std::string("policy_timing"));
  packer.pack(std::vector<double>{0.5, 2});
  packer.pack(std::string("actions"));
  packer.pack_map(4);
  pack_bytes("__ndarray__");
  packer.pack_true();
  pack_bytes("data");
  pack_bytes(std::string(bytes, '\1'));
  pack_bytes("dtype");
  packer.pack(std::string(type));
  pack_bytes("shape");
  packer.pack(std::vector<std::uint64_t>{actions, kNumbers});
  return {buffer.data(), buffer.size()};
}

}  // namespace
}  // namespace physpring

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace physpring;
  const std::string_view message = TextOf(data, size);
  MayRefuse("the policy server", [&] { CheckMetadata(message); });
  MayRefuse("the policy server", [&] {
    if (DecodeActions(message, kNumbers).rows() != kNumbers) throw std::logic_error("other rows");
  });
  return 0;
}

std::vector<std::string> physpring::FuzzSeeds() {
  return {Answer("<f4", 4 * 2 * 3, 3),
          Answer("<f8", 8 * 2, 1),
          "\x80",
          "\x81\xa1m\xc4\x01n",
          std::string("\xdd\0\x0f\xff\xff\xc0\xc0", 7),
          std::string(40, '\x91') + "\xc0"};
}
