// SPDX-License-Identifier: Apache-2.0
#include "diagnosis/law_search.h"

#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "diagnosis/acceptance.h"
#include "diagnosis/halving.h"
#include "trainer/solvers/levenberg_marquardt.h"
#include "trainer/solvers/parallel.h"
#include "twin/effects/registry.h"

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
constexpr double kFewestFrames = 8;   // in a period

// What the values of `custom` say, as far as they do not move.
struct Term {
  double acts_on, in_time;
  double step;  // of a coefficient, whose response is well above rounding
  double rate = 0;

  bool periodic() const { return in_time == 3; }
  bool of_springs() const { return acts_on >= 3; }
  bool IsLike(const Term& other) const {
    return acts_on == other.acts_on && in_time == other.in_time;
  }

  // The places of its coefficients among the values.
  std::vector<int> Coefficients() const {
    std::vector<int> places;
    for (int first : {3, 6}) {
      if (first == 6 && !periodic()) continue;
      for (int i = 0; i < (of_springs() ? 1 : 3); ++i) places.push_back(first + i);
    }
    return places;
  }

  EffectValues With(const Eigen::VectorXd& coefficients) const {
    Eigen::VectorXd values = Eigen::VectorXd::Zero(9);
    values.head(3) << acts_on, in_time, rate;
    const std::vector<int> places = Coefficients();
    for (std::size_t i = 0; i < places.size(); ++i) {
      values[places[i]] = coefficients[static_cast<Eigen::Index>(i)];
    }
    return {"custom", values};
  }
};

// Those that are not an effect of the list already, as a constant acceleration is.
constexpr std::array<Term, 11> kLibrary = {{{0, 1, 0.1},
                                            {0, 2, 0.1},
                                            {0, 3, 0.1},
                                            {1, 0, 1},
                                            {1, 2, 1},
                                            {1, 3, 1},
                                            {2, 0, 0.1},
                                            {2, 3, 0.1},
                                            {3, 2, 0.01},
                                            {3, 3, 0.01},
                                            {4, 0, 0.1}}};

// The lowest frequency that is tried, rad/s: half a period in the recording. Others are as far
// apart: at twice that distance a wave is of the wrong sign at one end.
double SlowestRate(const Recording& recording) {
  return std::numbers::pi * recording.fps / recording.frame_count();
}

std::vector<Term> LibraryFor(const Recording& recording) {
  const double slowest = SlowestRate(recording);
  const double fastest = 2 * std::numbers::pi * recording.fps / kFewestFrames;
  std::vector<Term> terms;
  for (Term term : kLibrary) {
    if (!term.periodic()) terms.push_back(term);
    for (int n = 1; term.periodic() && n * slowest < fastest; ++n) {
      term.rate = n * slowest;
      terms.push_back(term);
    }
  }
  return terms;
}

// Whether a wave is so slow that it stands for another course.
bool IsTooSlow(const Fitting& fitting, const EffectValues& effect) {
  const double slowest = 0.5 * SlowestRate(*fitting.recordings()[0].recording);
  return effect.name == "custom" && effect.values[1] == 3 && effect.values[2] < slowest;
}

// The fit with constant terms in place of waves that are too slow: what they degenerate to.
Descent WithoutSlowWaves(const Fitting& fitting, Descent fit) {
  const double middle = 0.5 * fitting.recordings()[0].recording->frame_count() /
                        fitting.recordings()[0].recording->fps;
  const std::vector<EffectValues> now = fitting.Model(fit.hypothesis).Apply(fit.x).effects;
  std::vector<EffectValues>& starts = fit.hypothesis.effects;
  Eigen::Index behind = 0;  // entries of x behind the effect's
  for (std::size_t n = 1; n <= starts.size(); ++n) {
    const EffectValues& effect = now[now.size() - n];
    const Eigen::Index size = effect.values.size();
    if (IsTooSlow(fitting, effect)) {
      Eigen::VectorXd constant = Eigen::VectorXd::Zero(size);
      constant[0] = effect.values[0];
      constant.segment<3>(3) = std::sin(effect.values[2] * middle) * effect.values.segment<3>(3) +
                               std::cos(effect.values[2] * middle) * effect.values.segment<3>(6);
      starts[starts.size() - n].values = constant;
      fit.x.segment(fit.x.size() - behind - size, size).setZero();
    }
    behind += size;
  }
  return fit;
}

struct ScoredTerm {
  Term term;
  double score;  // part of the squared misfit that it takes, in a linear fit
  Eigen::VectorXd coefficients;
};

// What is left to explain, beyond what the body and its effects could take.
class Leftover {
 public:
  Leftover(const Fitting& fitting, const Descent& from) : fitting_(fitting), from_(from) {}

  // False if the descent cannot be evaluated.
  bool Prepare() {
    EffectProblem problem = fitting_.Problem(from_.hypothesis, kTermGain, Fitting::Care::kRough);
    if (!problem.FixSubsteps(from_.x)) return false;
    const auto r = problem.Residuals(from_.x);
    if (!r || r->size() == 0) return false;
    const int size = static_cast<int>(from_.x.size());
    const Eigen::MatrixXd j = DifferenceColumns(
        ResidualsOf(problem), from_.x, *r, {0, size, fitting_.difference(), fitting_.threads()});
    body_.compute(j);
    r_ = *r;
    left_ = Beyond(r_);
    return true;
  }

  // The score and the coefficients of a term, as one vector; a score of 0 where it diverges.
  Eigen::VectorXd Score(const Term& term) const {
    const Eigen::Index count = static_cast<Eigen::Index>(term.Coefficients().size());
    Eigen::VectorXd scored = Eigen::VectorXd::Zero(1 + count);
    Eigen::MatrixXd responses(r_.size(), count);
    for (Eigen::Index i = 0; i < count; ++i) {
      const auto with = ResidualsWith(term.With(term.step * Eigen::VectorXd::Unit(count, i)));
      if (!with) return scored;
      responses.col(i) = Beyond((*with - r_) / term.step);
    }
    Eigen::MatrixXd normal = responses.transpose() * responses;
    normal.diagonal() *= 1 + 1e-6;
    const Eigen::VectorXd along = responses.transpose() * left_;
    scored.tail(count) = -normal.ldlt().solve(along);
    scored[0] = -along.dot(scored.tail(count)) / left_.squaredNorm();
    return scored;
  }

  // As much of the coefficients as leaves least; nothing if all leave more than none.
  std::optional<Eigen::VectorXd> Shortened(const ScoredTerm& scored) const {
    double least = r_.squaredNorm();
    std::optional<Eigen::VectorXd> best;
    for (double part : {1.0, 0.5, 0.25, 0.1}) {
      const auto with = ResidualsWith(scored.term.With(part * scored.coefficients));
      if (!with || with->squaredNorm() >= least) continue;
      least = with->squaredNorm();
      best = part * scored.coefficients;
    }
    return best;
  }

 private:
  Eigen::VectorXd Beyond(const Eigen::VectorXd& r) const {
    const Eigen::Index size = from_.x.size();
    Eigen::VectorXd turned = body_.householderQ().transpose() * r;
    turned.head(size).setZero();
    return body_.householderQ() * turned;
  }

  std::optional<Eigen::VectorXd> ResidualsWith(const EffectValues& effect) const {
    const Descent with = from_.WithNewEffect(effect);
    EffectProblem problem = fitting_.Problem(with.hypothesis, kTermGain, Fitting::Care::kRough);
    if (!problem.FixSubsteps(with.x)) return {};
    return problem.Residuals(with.x);
  }

  const Fitting& fitting_;
  const Descent& from_;
  Eigen::HouseholderQR<Eigen::MatrixXd> body_;  // of the responses to the body and its effects
  Eigen::VectorXd r_, left_;
};

// The terms that take most, the best frequency of each.
std::vector<ScoredTerm> BestTerms(const Fitting& fitting, const Descent& from, const Leftover& left,
                                  const WorkShare& stage) {
  const std::vector<Term> library = LibraryFor(*fitting.recordings()[0].recording);
  std::vector<Eigen::VectorXd> found(library.size());
  fitting.journal().Stage(stage, static_cast<int>(library.size()), "trying the terms of a law");
  ParallelFor(static_cast<int>(library.size()), fitting.threads(), [&](int n) {
    const auto i = static_cast<std::size_t>(n);
    const Term& term = library[i];
    PieceKey key = KeyOf("term", from.hypothesis);
    key.Add(from.x).Add(term.acts_on).Add(term.in_time).Add(term.rate);
    found[i] = fitting.journal().Get(key, [&] { return left.Score(term); });
  });
  std::vector<ScoredTerm> scored;
  for (std::size_t i = 0; i < library.size(); ++i) {
    const Eigen::Index count = found[i].size() - 1;
    if (found[i][0] >= kLeastScore) {
      scored.push_back({library[i], found[i][0], found[i].tail(count)});
    }
  }
  std::stable_sort(scored.begin(), scored.end(),
                   [](const ScoredTerm& p, const ScoredTerm& q) { return p.score > q.score; });
  std::vector<ScoredTerm> best;
  for (const ScoredTerm& one : scored) {
    const bool known = std::any_of(best.begin(), best.end(),
                                   [&](const ScoredTerm& b) { return b.term.IsLike(one.term); });
    if (!known && best.size() < kMostFits) best.push_back(one);
  }
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

// The fit without one of its last effects, `from_last` before the last one.
Descent WithoutTerm(Descent fit, std::size_t from_last) {
  std::vector<EffectValues>& effects = fit.hypothesis.effects;
  const auto term = effects.end() - 1 - static_cast<long>(from_last);
  Eigen::Index behind = 0;  // values of those behind it
  for (auto effect = term + 1; effect != effects.end(); ++effect) behind += effect->values.size();
  Eigen::VectorXd x(fit.x.size() - term->values.size());
  x << fit.x.head(x.size() - behind), fit.x.tail(behind);
  fit.x = x;
  effects.erase(term);
  return fit;
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
  Threshold threshold = inquiry.ThresholdFor(kLibrary.size());
  threshold.least_gain = std::max(threshold.least_gain, kHalfOfTheError);
  const BootstrapResult gain = inquiry.Gain(without, law.verdict);
  if (!IsWorthIt(gain, without.track.held, threshold)) return {};
  return law;
}

}  // namespace physpring
