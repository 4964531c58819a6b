// SPDX-License-Identifier: Apache-2.0
#include "tests/fuzz/mutations.h"

#include <algorithm>
#include <array>
#include <string_view>

namespace physpring {
namespace {

using namespace std::string_view_literals;

constexpr std::size_t kLongest = 1 << 14;  // bytes, after doubling

constexpr std::array kForgotten{"\0"sv,        "\xff"sv,       "\xff\xff\xff\xff"sv,
                                "\x7f"sv,      "\x80"sv,       "\xff\xff\xff\x7f"sv,
                                "0"sv,         "-1"sv,         "1e308"sv,
                                "-1e-320"sv,   "4294967296"sv, "18446744073709551616"sv,
                                "nan"sv,       "[[[["sv,       "{\"a\":"sv,
                                "null"sv,      "\"\""sv,       "[]"sv,
                                ","sv,         " "sv,          "\n"sv,
                                "2147483647"sv};

std::size_t Draw(std::mt19937& random, std::size_t count) { return random() % count; }

void MutateOnce(std::mt19937& random, std::string* bytes) {
  const std::size_t size = bytes->size();
  const std::size_t at = Draw(random, size + 1);
  const std::size_t length = std::min(size - at, 1 + Draw(random, Draw(random, 4) == 0 ? 64 : 4));
  const std::string_view forgotten = kForgotten[Draw(random, kForgotten.size())];
  switch (Draw(random, 7)) {
    case 0:
      if (at < size) (*bytes)[at] = static_cast<char>((*bytes)[at] ^ 1 << Draw(random, 8));
      break;
    case 1:
      if (at < size) (*bytes)[at] = static_cast<char>(random());
      break;
    case 2:
      bytes->erase(at, length);
      break;
    case 3:
      bytes->insert(at, bytes->substr(at, length));
      break;
    case 4:
      bytes->replace(at, std::min(length, forgotten.size()), forgotten);
      break;
    case 5:
      bytes->insert(at, forgotten);
      break;
    default:
      bytes->insert(Draw(random, size + 1), bytes->substr(at, length));
  }
  if (bytes->size() > kLongest) bytes->resize(kLongest);
}

}  // namespace

void MutateBytes(std::mt19937& random, std::string* bytes) {
  for (std::size_t change = 1 + Draw(random, 4); change > 0; --change) MutateOnce(random, bytes);
}

}  // namespace physpring
