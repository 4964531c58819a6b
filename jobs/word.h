// SPDX-License-Identifier: Apache-2.0
// A word and what it stands for: how options are spelled for people.
#ifndef PHYSPRING_JOBS_WORD_H_
#define PHYSPRING_JOBS_WORD_H_

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <optional>
#include <string>

namespace physpring {

template <class Value>
struct Word {
  const char* word;
  Value meaning;
};

// The words for the precision of the simulation's numbers, and whether it is single.
inline constexpr Word<bool> kPrecisionWords[] = {{"double", false}, {"float", true}};

// The word for `value`, which must be one of those listed.
template <class Value, std::size_t kCount>
std::string WordOf(const Word<Value> (&words)[kCount], const Value& value) {
  const auto stands_for = [&](const Word<Value>& word) { return word.meaning == value; };
  return std::find_if(std::begin(words), std::end(words), stands_for)->word;
}

// What the word stands for, or nothing.
template <class Value, std::size_t kCount>
std::optional<Value> MeaningOf(const Word<Value> (&words)[kCount], const std::string& word) {
  const auto is_it = [&](const Word<Value>& one) { return one.word == word; };
  const auto found = std::find_if(std::begin(words), std::end(words), is_it);
  if (found == std::end(words)) return std::nullopt;
  return found->meaning;
}

}  // namespace physpring

#endif  // PHYSPRING_JOBS_WORD_H_
