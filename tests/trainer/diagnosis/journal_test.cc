// SPDX-License-Identifier: Apache-2.0
#include "trainer/diagnosis/journal.h"

#include <gtest/gtest.h>

#include <stdexcept>

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

// Counts to 3.
class Counting : public Fitter {
 public:
  bool Step() override {
    if (count_ == 3) return false;
    ++count_;
    ++steps;
    return true;
  }
  double Progress() const override { return count_ / 3.0; }
  std::string Status() const override { return "counting"; }
  StateArrays Save() const override { return {{"train/count", NpzArray::Ints({}, &count_)}}; }
  void Load(const StateArrays& state) override { count_ = state.at("train/count").ToInts()[0]; }
  Twin Result() const override { return {}; }

  int steps = 0;

 private:
  int count_ = 0;
};

TEST(Journal, TakesAFitToItsEndFromWhereItWas) {
  Journal journal;
  StateArrays after_two;
  std::vector<double> shares;
  journal.progress = [&](double share, const std::string&) { shares.push_back(share); };
  journal.kept = [&] {
    if (shares.size() == 3) after_two = journal.Save();
  };
  Counting whole, rest, other;
  journal.Finish(PieceKey("a"), {0.4, 1}, "testing", &whole);
  EXPECT_EQ(whole.steps, 3);
  ASSERT_EQ(shares.size(), 4u);
  EXPECT_DOUBLE_EQ(shares[2], 0.8);
  Journal resumed;
  resumed.Load(after_two);
  resumed.Finish(PieceKey("a"), {0, 1}, "testing", &rest);
  EXPECT_EQ(rest.steps, 1);
  resumed.Finish(PieceKey("b"), {0, 1}, "testing", &other);
  EXPECT_EQ(other.steps, 3);
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
  for (const char* name : {"hashes", "sizes", "values"}) {
    StateArrays missing = journal.Save(), empty = missing;
    missing.erase(name);
    empty[name].data.clear();
    empty[name].shape = {0};
    EXPECT_THROW(Journal().Load(missing), Error) << name;
    EXPECT_THROW(Journal().Load(empty), Error) << name;
  }
}

}  // namespace
}  // namespace physpring
