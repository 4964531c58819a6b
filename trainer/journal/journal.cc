// SPDX-License-Identifier: Apache-2.0
#include "trainer/journal/journal.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <vector>

#include "twin/error.h"

namespace physpring {
namespace {

constexpr std::size_t kHashDigits = 16;

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
    at_ = share_.At(std::min(1.0, static_cast<double>(done_) / pieces_));
    if (progress) progress(at_, status_);
  }
  const Eigen::VectorXd result = work();
  const std::lock_guard lock(mutex_);
  ++done_;
  results_[hash] = result;
  if (kept) kept({at_, status_, status_});
  return result;
}

Journal::Chain Journal::FindChain(const std::string& hash) {
  const std::lock_guard lock(mutex_);
  const auto found = chains_.find(hash);
  return found == chains_.end() ? Chain() : found->second;
}

void Journal::KeepChain(const std::string& hash, const Chain& chain, const std::string& name,
                        double share) {
  const std::lock_guard lock(mutex_);
  chains_[hash] = chain;
  at_ = std::min(1.0, at_ + share);
  if (kept) kept({at_, name, chain.status});
}

void Journal::Announce(const std::string& status) {
  const std::lock_guard lock(mutex_);
  if (progress) progress(at_, status);
}

void Journal::Reach(double share) {
  const std::lock_guard lock(mutex_);
  at_ = std::max(at_, share);
}

void Journal::Advance(double share) {
  const std::lock_guard lock(mutex_);
  at_ = std::min(1.0, at_ + share);
}

namespace {

// Rows of different lengths under hashes, as three arrays, and back.
class Rows {
 public:
  void Add(const std::string& hash, const Eigen::VectorXd& row) {
    hashes_ += hash;
    sizes_.push_back(static_cast<int>(row.size()));
    values_.insert(values_.end(), row.begin(), row.end());
  }
  void SaveAs(const std::string& prefix, Journal::Arrays* arrays) const {
    (*arrays)[prefix + "hashes"] = NpzArray::Text(hashes_);
    (*arrays)[prefix + "sizes"] = NpzArray::Ints({sizes_.size()}, sizes_.data());
    (*arrays)[prefix + "values"] = NpzArray::Doubles({values_.size()}, values_.data());
  }

 private:
  std::string hashes_;
  std::vector<int> sizes_;
  std::vector<double> values_;
};

const NpzArray& Find(const Journal::Arrays& arrays, const std::string& name) {
  const auto found = arrays.find(name);
  if (found == arrays.end()) throw Error("array " + name + " is missing");
  return found->second;
}

std::map<std::string, Eigen::VectorXd> LoadRows(const Journal::Arrays& arrays,
                                                const std::string& prefix) {
  const std::string hashes = Find(arrays, prefix + "hashes").ToText();
  const std::vector<int> sizes = Find(arrays, prefix + "sizes").ToInts();
  const std::vector<double> values = Find(arrays, prefix + "values").ToDoubles();
  const bool positive = std::all_of(sizes.begin(), sizes.end(), [](int size) { return size >= 0; });
  if (!positive || hashes.size() != kHashDigits * sizes.size() ||
      std::accumulate(sizes.begin(), sizes.end(), std::size_t{0}) != values.size()) {
    throw Error(
        fmt::format("arrays {0}hashes, {0}sizes and {0}values do not belong together", prefix));
  }
  std::map<std::string, Eigen::VectorXd> rows;
  std::size_t first = 0;
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    rows[hashes.substr(kHashDigits * i, kHashDigits)] =
        Eigen::Map<const Eigen::VectorXd>(values.data() + first, sizes[i]);
    first += static_cast<std::size_t>(sizes[i]);
  }
  return rows;
}

constexpr char kResults[] = "", kChains[] = "chain_";

}  // namespace

// A chain is kept as a row: whether it is done, its part, then its state. The status is not kept.
Journal::Arrays Journal::Save() const {
  Rows results, chains;
  for (const auto& [hash, result] : results_) results.Add(hash, result);
  for (const auto& [hash, chain] : chains_) {
    Eigen::VectorXd row(2 + chain.state.size());
    row << (chain.done ? 1 : 0), chain.part, chain.state;
    chains.Add(hash, row);
  }
  Arrays arrays;
  results.SaveAs(kResults, &arrays);
  chains.SaveAs(kChains, &arrays);
  return arrays;
}

void Journal::Load(const Arrays& arrays) {
  results_ = LoadRows(arrays, kResults);
  chains_.clear();
  for (const auto& [hash, row] : LoadRows(arrays, kChains)) {
    if (row.size() < 2) throw Error("array chain_sizes: a chain has no state");
    chains_[hash] = {row.tail(row.size() - 2), row[0] != 0, row[1], "going on"};
  }
}

}  // namespace physpring
