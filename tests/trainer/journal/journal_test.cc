// SPDX-License-Identifier: Apache-2.0
#include "trainer/journal/journal.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <vector>

#include "trainer/journal/work.h"
#include "twin/error.h"

namespace physpring {
namespace {

Eigen::VectorXd Numbers() { return Eigen::Vector3d(0.1, -2, 1e-300); }

TEST(Journal, WorksOnAPieceOnce) {
  Journal journal;
  int worked = 0;
  const auto work = [&] { return ++worked, Numbers(); };
  EXPECT_EQ(journal.Get(PieceKey("a"), work), Numbers());
  EXPECT_EQ(journal.Get(PieceKey("a"), work), Numbers());
  EXPECT_EQ(worked, 1);
  journal.Get(PieceKey("b"), work);
  EXPECT_EQ(worked, 2);
}

TEST(Journal, IsTheSameAfterSaveAndLoad) {
  Journal journal, other;
  journal.Get(PieceKey("a"), Numbers);
  journal.Get(PieceKey("nothing"), [] { return Eigen::VectorXd(); });
  other.Load(journal.Save());
  const auto never = []() -> Eigen::VectorXd { throw std::logic_error("worked again"); };
  EXPECT_EQ(other.Get(PieceKey("a"), never), Numbers());
  EXPECT_EQ(other.Get(PieceKey("nothing"), never).size(), 0);
  EXPECT_THROW(other.Get(PieceKey("c"), never), std::logic_error);
}

TEST(Journal, KeysTellApartWhatPiecesDependOn) {
  const auto hash = [](const auto&... parts) {
    PieceKey key("kind");
    (key.Add(parts), ...);
    return key.Hash();
  };
  const Eigen::VectorXd one = Eigen::VectorXd::Ones(1), two = Eigen::VectorXd::Ones(2);
  EXPECT_NE(hash(1.0), hash(1.0 + 1e-15));
  EXPECT_NE(hash(one, two), hash(two, one));
  EXPECT_NE(hash(std::string("ab"), std::string("c")), hash(std::string("a"), std::string("bc")));
  EXPECT_NE(hash(std::vector<EffectValues>{{"yield", one}}),
            hash(std::vector<EffectValues>{{"tether", one}}));
  EXPECT_EQ(hash(one, 2.0), hash(one, 2.0));
}

struct Counter {
  int count = 0;
  std::vector<std::vector<double>> halves = {};

  template <class Visitor>
  void Visit(Visitor&& visit) {
    visit(count, halves);
  }
};

// Counts to 3 from `first` on, and says in `steps` how many steps that took.
Counter CountTo3(const Work& work, int* steps, int first = 0) {
  return work.Follow(Counter{first}, [&](Counter* counter) -> StepReport {
    ++*steps;
    ++counter->count;
    counter->halves.push_back({counter->count / 2.0});
    return {counter->count >= 3, counter->count / 3.0, "counting"};
  });
}

TEST(Work, FollowsAChainFromWhereItWas) {
  Journal journal;
  Journal::Arrays after_two;
  std::vector<double> shares;
  journal.kept = [&](const Journal::Piece& piece) {
    shares.push_back(piece.share);
    EXPECT_EQ(piece.name, "chain");
    EXPECT_EQ(piece.status, "testing: counting");
    if (shares.size() == 2) after_two = journal.Save();
  };
  const auto work = [](Journal* of) {
    return Work(of, PieceKey("a"), {}, "testing: ").Part("chain", 0.4, 1);
  };
  int whole = 0, rest = 0, again = 0, other = 0;
  EXPECT_EQ(CountTo3(work(&journal), &whole).halves.size(), 3u);
  EXPECT_EQ(whole, 3);
  ASSERT_EQ(shares.size(), 3u);
  EXPECT_DOUBLE_EQ(shares[1], 0.8);
  EXPECT_DOUBLE_EQ(shares[2], 1);
  Journal resumed;
  resumed.Load(after_two);
  const Counter counter = CountTo3(work(&resumed), &rest);
  EXPECT_EQ(rest, 1);
  EXPECT_EQ(counter.halves, (std::vector<std::vector<double>>{{0.5}, {1}, {1.5}}));
  CountTo3(work(&resumed), &again);
  EXPECT_EQ(again, 0);
  CountTo3(work(&resumed), &other, 1);  // a chain is known by where it starts
  EXPECT_EQ(other, 2);
}

TEST(Work, KeepsChainsOfItemsAndPartsApart) {
  Journal journal;
  const Work work(&journal, PieceKey("a"));
  int steps = 0;
  CountTo3(work.Part("x", 0, 0.5), &steps);
  CountTo3(work.Part("y", 0.5, 1), &steps);
  for (int i = 0; i < 2; ++i) CountTo3(work.Item(i, 2), &steps);
  EXPECT_EQ(steps, 12);
}

TEST(Packing, RefusesNumbersOfAnotherState) {
  Counter counter{1, {{1, 2}}};
  Eigen::VectorXd numbers = Pack(counter);
  EXPECT_NO_THROW(Unpack(numbers, &counter));
  EXPECT_THROW(Unpack(numbers.head(3), &counter), Error);
  Eigen::VectorXd longer(numbers.size() + 1);
  longer << numbers, 0;
  EXPECT_THROW(Unpack(longer, &counter), Error);
  for (const double size : {-1.0, 1e9, std::nan("")}) {
    numbers[1] = size;
    EXPECT_THROW(Unpack(numbers, &counter), Error) << size;
  }
}

TEST(Journal, TellsTheShareBeforeMissingPieces) {
  Journal journal;
  std::vector<double> shares;
  journal.progress = [&](double share, const std::string&) { shares.push_back(share); };
  journal.Get(PieceKey("a"), Numbers);
  journal.Stage({0.2, 0.6}, 4, "testing");
  for (const char* name : {"a", "b", "c"}) journal.Get(PieceKey(name), Numbers);
  // "a" is there by then: one of four pieces, then two
  ASSERT_EQ(shares.size(), 3u);
  EXPECT_DOUBLE_EQ(shares[1], 0.3);
  EXPECT_DOUBLE_EQ(shares[2], 0.4);
}

TEST(Journal, RefusesArraysThatDoNotBelongTogether) {
  Journal journal;
  journal.Get(PieceKey("a"), Numbers);
  int steps = 0;
  CountTo3(Work(&journal, PieceKey("b")), &steps);
  for (const char* name :
       {"hashes", "sizes", "values", "chain_hashes", "chain_sizes", "chain_values"}) {
    Journal::Arrays missing = journal.Save(), empty = missing;
    missing.erase(name);
    empty[name].data.clear();
    empty[name].shape = {0};
    EXPECT_THROW(Journal().Load(missing), Error) << name;
    EXPECT_THROW(Journal().Load(empty), Error) << name;
  }
}

}  // namespace
}  // namespace physpring
