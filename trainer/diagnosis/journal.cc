// SPDX-License-Identifier: Apache-2.0
#include "trainer/diagnosis/journal.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <vector>

#include "twin/error.h"

namespace physpring {
namespace {

constexpr std::size_t kHashDigits = 16;
constexpr char kFit[] = "fit/";  // then the hash, a slash, and an array of the fit's state

}  // namespace

PieceKey& PieceKey::Add(const std::string& word) {
  Add(static_cast<double>(word.size()));
  bytes_ += word;
  return *this;
}

PieceKey& PieceKey::Add(double number) {
  bytes_.append(reinterpret_cast<const char*>(&number), sizeof(number));
  return *this;
}

PieceKey& PieceKey::Add(const Eigen::VectorXd& numbers) {
  Add(static_cast<double>(numbers.size()));
  for (double number : numbers) Add(number);
  return *this;
}

PieceKey& PieceKey::Add(const std::vector<EffectValues>& effects) {
  Add(static_cast<double>(effects.size()));
  for (const EffectValues& effect : effects) Add(effect.name).Add(effect.values);
  return *this;
}

std::string PieceKey::Hash() const { return HashBytes(bytes_); }

void Journal::Stage(const WorkShare& share, int pieces, const std::string& status) {
  const std::lock_guard lock(mutex_);
  share_ = share;
  pieces_ = std::max(1, pieces), done_ = 0;
  status_ = status;
}

Eigen::VectorXd Journal::Get(const PieceKey& key, const std::function<Eigen::VectorXd()>& work) {
  const std::string hash = key.Hash();
  {
    const std::lock_guard lock(mutex_);
    const auto found = results_.find(hash);
    if (found != results_.end()) {
      ++done_;
      return found->second;
    }
    const double part = std::min(1.0, static_cast<double>(done_) / pieces_);
    if (progress) progress(share_.At(part), status_);
  }
  const Eigen::VectorXd result = work();
  const std::lock_guard lock(mutex_);
  ++done_;
  results_[hash] = result;
  if (kept) kept();
  return result;
}

void Journal::Finish(const PieceKey& key, const WorkShare& share, const std::string& status,
                     Fitter* fitter) {
  const std::string hash = key.Hash();
  const auto begun = fits_.find(hash);
  if (begun != fits_.end()) fitter->Load(begun->second);
  do {
    if (progress) progress(share.At(fitter->Progress()), status + ": " + fitter->Status());
    fits_[hash] = fitter->Save();
    if (kept) kept();
  } while (fitter->Step());
}

StateArrays Journal::Save() const {
  std::string hashes;
  std::vector<int> sizes;
  std::vector<double> values;
  for (const auto& [hash, result] : results_) {
    hashes += hash;
    sizes.push_back(static_cast<int>(result.size()));
    values.insert(values.end(), result.begin(), result.end());
  }
  StateArrays state{{"hashes", NpzArray::Text(hashes)},
                    {"sizes", NpzArray::Ints({sizes.size()}, sizes.data())},
                    {"values", NpzArray::Doubles({values.size()}, values.data())}};
  for (const auto& [hash, fit] : fits_) {
    for (const auto& [name, values_of_fit] : fit) {
      state[fmt::format("{}{}/{}", kFit, hash, name)] = values_of_fit;
    }
  }
  return state;
}

void Journal::Load(const StateArrays& state) {
  const auto array = [&](const char* name) -> const NpzArray& {
    const auto found = state.find(name);
    if (found == state.end()) throw Error(std::string("array ") + name + " is missing");
    return found->second;
  };
  const std::string hashes = array("hashes").ToText();
  const std::vector<int> sizes = array("sizes").ToInts();
  const std::vector<double> values = array("values").ToDoubles();
  const bool positive = std::all_of(sizes.begin(), sizes.end(), [](int size) { return size >= 0; });
  if (!positive || hashes.size() != kHashDigits * sizes.size() ||
      std::accumulate(sizes.begin(), sizes.end(), std::size_t{0}) != values.size()) {
    throw Error("arrays hashes, sizes and values do not belong together");
  }
  std::size_t first = 0;
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    results_[hashes.substr(kHashDigits * i, kHashDigits)] =
        Eigen::Map<const Eigen::VectorXd>(values.data() + first, sizes[i]);
    first += static_cast<std::size_t>(sizes[i]);
  }
  constexpr std::size_t kHash = sizeof(kFit) - 1, kName = kHash + kHashDigits + 1;
  for (const auto& [name, values_of_fit] : state) {
    if (!name.starts_with(kFit) || name.size() <= kName) continue;
    fits_[name.substr(kHash, kHashDigits)][name.substr(kName)] = values_of_fit;
  }
}

}  // namespace physpring
