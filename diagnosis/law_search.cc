// SPDX-License-Identifier: Apache-2.0
#include "diagnosis/law_search.h"

#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <optional>
#include <span>

#include "diagnosis/acceptance.h"
#include "diagnosis/halving.h"
#include "diagnosis/law_term.h"
#include "trainer/solvers/levenberg_marquardt.h"
#include "twin/parallel.h"

namespace physpring {
namespace {

constexpr int kMostTerms = 3;
constexpr std::size_t kMostFits = 5;      // with one more term
constexpr double kHalfOfTheError = 0.75;  // half of an error are three quarters of its square
constexpr double kTermGain = 0.1;
// With one more term; the best once more, and with a term less.
constexpr std::array<Cut, 2> kTermCuts = {{{kTermGain, 4, 3, 3}, {0, 15, 1, 1}}};
constexpr std::array<Cut, 1> kOnceMoreCuts = {{{0, 15, 1, 1}}};
constexpr double kLeastScore = 0.02;  // part of the squared misfit that a term may take, at least

struct ScoredTerm {
  LawTerm term;
  double score = 0;  // part of the squared misfit that it takes, in a linear fit
  Eigen::VectorXd coefficients;
};

// What is left to explain, beyond what the body and its effects could take.
class Leftover {
 public:
  Leftover(const Fitting& fitting, const Descent& from)
      : fitting_(fitting),
        from_(from),
        with_(from.WithNewEffect(LawTerm().With({}))),
        problem_(fitting.Problem(with_.hypothesis, kTermGain, Fitting::Care::kRough)) {}

  // False if the descent cannot be evaluated.
  bool Prepare() {
    if (!problem_.FixSubsteps(with_.x)) return false;
    const auto r = problem_.Residuals(with_.x);
    if (!r || r->size() == 0) return false;
    body_.compute(DifferenceColumns(ResidualsOf(problem_), with_.x, *r,
                                    {0, own(), fitting_.difference(), fitting_.threads()}));
    r_ = *r;
    left_ = Beyond(r_);
    return true;
  }

  // The best term of a kind. Of waves, those beside the best frequency are looked at, too.
  ScoredTerm BestOf(const LawTerm& kind) const {
    const Recording& recording = *fitting_.recordings()[0].recording;
    ScoredTerm best = BestAmong(TermsOf(kind, recording));
    if (!kind.periodic()) return best;
    std::vector<LawTerm> beside(2, best.term);
    beside[0].rate = std::max(beside[0].rate - SlowestRate(recording), SlowestRate(recording));
    beside[1].rate += SlowestRate(recording);
    const ScoredTerm other = BestAmong(beside);
    return other.score > best.score ? other : best;
  }

  // As much of the coefficients as leaves least; nothing if all leave more than none.
  std::optional<Eigen::VectorXd> Shortened(const ScoredTerm& scored) const {
    std::vector<Eigen::VectorXd> shortened;
    for (double part : {1.0, 0.5, 0.25, 0.1}) shortened.emplace_back(part * scored.coefficients);
    std::vector<SpringMassSystem> systems;
    for (const Eigen::VectorXd& one : shortened) systems.push_back(SystemWith(scored.term, one));
    const auto residuals = problem_.ResidualsOfSystems(std::move(systems));
    double least = r_.squaredNorm();
    std::optional<Eigen::VectorXd> best;
    for (std::size_t i = 0; i < shortened.size(); ++i) {
      if (!residuals[i] || residuals[i]->squaredNorm() >= least) continue;
      least = residuals[i]->squaredNorm();
      best = shortened[i];
    }
    return best;
  }

 private:
  int own() const { return static_cast<int>(from_.x.size()); }

  Eigen::VectorXd Beyond(const Eigen::VectorXd& r) const {
    Eigen::VectorXd turned = body_.householderQ().transpose() * r;
    turned.head(own()).setZero();
    return body_.householderQ() * turned;
  }

  SpringMassSystem SystemWith(const LawTerm& term, const Eigen::VectorXd& coefficients) const {
    SpringMassSystem system = problem_.SystemAt(with_.x);
    system.effects.back() = term.With(coefficients);
    return system;
  }

  // All go side by side. One that diverges has the score 0.
  ScoredTerm BestAmong(const std::vector<LawTerm>& terms) const {
    std::vector<SpringMassSystem> systems;
    for (const LawTerm& term : terms) {
      const Eigen::Index count = term.coefficient_count();
      for (Eigen::Index i = 0; i < count; ++i) {
        systems.push_back(SystemWith(term, term.step * Eigen::VectorXd::Unit(count, i)));
      }
    }
    const auto residuals = problem_.ResidualsOfSystems(std::move(systems));
    ScoredTerm best = {terms[0], 0, {}};
    std::size_t first = 0;
    for (const LawTerm& term : terms) {
      const auto count = static_cast<std::size_t>(term.coefficient_count());
      const std::span with(&residuals[first], count);
      first += count;
      if (!std::all_of(with.begin(), with.end(), [](const auto& r) { return r.has_value(); })) {
        continue;
      }
      ScoredTerm scored = Score(term, with);
      if (scored.score > best.score) best = std::move(scored);
    }
    return best;
  }

  // From the residuals with a small step of each coefficient.
  ScoredTerm Score(const LawTerm& term,
                   std::span<const std::optional<Eigen::VectorXd>> with) const {
    Eigen::MatrixXd responses(r_.size(), static_cast<Eigen::Index>(with.size()));
    for (std::size_t i = 0; i < with.size(); ++i) {
      responses.col(static_cast<Eigen::Index>(i)) = Beyond((*with[i] - r_) / term.step);
    }
    Eigen::MatrixXd normal = responses.transpose() * responses;
    normal.diagonal() *= 1 + 1e-6;
    const Eigen::VectorXd along = responses.transpose() * left_;
    const Eigen::VectorXd coefficients = -normal.ldlt().solve(along);
    return {term, -along.dot(coefficients) / left_.squaredNorm(), coefficients};
  }

  const Fitting& fitting_;
  const Descent& from_;
  Descent with_;  // from_ with a term of no strength
  EffectProblem problem_;
  Eigen::HouseholderQR<Eigen::MatrixXd> body_;  // of the responses to the body and its effects
  Eigen::VectorXd r_, left_;
};

// The terms that take most, one of each kind.
std::vector<ScoredTerm> BestTerms(const Fitting& fitting, const Descent& from, const Leftover& left,
                                  const WorkShare& stage) {
  std::vector<ScoredTerm> best(kLawLibrary.size());
  fitting.journal().Stage(stage, static_cast<int>(kLawLibrary.size()), "trying the terms of a law");
  ParallelFor(static_cast<int>(kLawLibrary.size()), fitting.threads(), [&](int n) {
    const auto i = static_cast<std::size_t>(n);
    PieceKey key = KeyOf("term", from.hypothesis);
    key.Add(from.x).Add(static_cast<double>(i));
    const Eigen::VectorXd found = fitting.journal().Get(key, [&] {
      const ScoredTerm scored = left.BestOf(kLawLibrary[i]);
      Eigen::VectorXd piece(2 + scored.coefficients.size());
      piece << scored.score, scored.term.rate, scored.coefficients;
      return piece;
    });
    best[i] = {kLawLibrary[i], found[0], found.tail(found.size() - 2)};
    best[i].term.rate = found[1];
  });
  std::erase_if(best, [](const ScoredTerm& scored) { return scored.score < kLeastScore; });
  std::stable_sort(best.begin(), best.end(),
                   [](const ScoredTerm& p, const ScoredTerm& q) { return p.score > q.score; });
  best.resize(std::min(best.size(), kMostFits));
  return best;
}

// The best fit with one more term.
std::optional<Descent> AddTerm(const Fitting& fitting, const Descent& from,
                               const WorkShare& stage) {
  Leftover left(fitting, from);
  if (!left.Prepare()) return {};
  std::vector<Descent> fits;
  for (const ScoredTerm& scored : BestTerms(fitting, from, left, stage.Part(0, 0.4))) {
    const auto start = left.Shortened(scored);
    if (start) fits.push_back(from.WithNewEffect(scored.term.With(*start)));
  }
  Halve(fitting, kTermCuts, stage.Part(0.4, 0.9), " with a term of a law", &fits);
  for (Descent& fit : fits) fit = WithoutSlowWaves(fitting, std::move(fit));
  Halve(fitting, kOnceMoreCuts, stage.Part(0.9, 1), " with a term of a law", &fits);
  if (fits.empty()) return {};
  return fits.front();
}

// The law without those of its first terms without which it is as good: a term may have stood for
// one that was found after it.
Law Shorter(const Inquiry& inquiry, Law law, const WorkShare& stage) {
  for (int from_last = law.terms - 1; from_last > 0; --from_last) {
    std::vector<Descent> fits = {
        WithoutTerm(law.verdict.descent, static_cast<std::size_t>(from_last))};
    Halve(inquiry.fitting, kOnceMoreCuts, stage, " with a term less", &fits);
    const auto verdict = fits.empty() ? std::nullopt : inquiry.fitting.Judge(fits.front());
    if (!verdict || IsSurelyBetter(inquiry.Gain(*verdict, law.verdict))) continue;
    law = {*verdict, law.terms - 1};
  }
  return law;
}

// The fits with one, two, ... terms. The first one may predict badly alone, and well with the next.
std::vector<Verdict> FindTerms(const Inquiry& inquiry, const Descent& from,
                               const WorkShare& stage) {
  std::vector<Verdict> found;
  for (int n = 0; n < kMostTerms; ++n) {
    const WorkShare part = stage.Part(n / double{kMostTerms}, (n + 1) / double{kMostTerms});
    const auto fit = AddTerm(inquiry.fitting, found.empty() ? from : found.back().descent, part);
    const auto verdict = fit ? inquiry.fitting.Judge(*fit) : std::nullopt;
    if (!verdict) break;
    found.push_back(*verdict);
    if (IsExplained(verdict->track.held, inquiry.noise_floor)) break;
  }
  return found;
}

}  // namespace

std::optional<Law> FindLaw(const Inquiry& inquiry, const Verdict& without, const Descent& from,
                           const WorkShare& stage) {
  const std::vector<Verdict> found = FindTerms(inquiry, from, stage.Part(0, 0.9));
  if (found.empty()) return {};
  std::size_t last = 0;  // each term but the first must help surely
  while (last + 1 < found.size() && IsSurelyBetter(inquiry.Gain(found[last], found[last + 1]))) {
    ++last;
  }
  Law law = Shorter(inquiry, {found[last], static_cast<int>(last) + 1}, stage.Part(0.9, 1));
  Threshold threshold = inquiry.ThresholdFor(kLawLibrary.size());
  threshold.least_gain = std::max(threshold.least_gain, kHalfOfTheError);
  const BootstrapResult gain = inquiry.Gain(without, law.verdict);
  if (!IsWorthIt(gain, without.track.held, threshold)) return {};
  return law;
}

}  // namespace physpring
