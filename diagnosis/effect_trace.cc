// SPDX-License-Identifier: Apache-2.0
#include "diagnosis/effect_trace.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <limits>
#include <optional>
#include <utility>

#include "trainer/solvers/levenberg_marquardt.h"
#include "twin/parallel.h"

namespace physpring {
namespace {

constexpr std::size_t kStarts = 2;  // so many starts of an effect are looked at closely
constexpr double kLongestStep = 1.5;
// The score where nothing is predicted.
constexpr double kNone = -std::numeric_limits<double>::infinity();

struct Job {
  std::size_t effect;
  Eigen::VectorXd start;
  double score = 0;
};

class Tracer {
 public:
  Tracer(const Fitting& fitting, const Descent& fit, double gain)
      : fitting_(fitting), fit_(fit), gain_(gain) {}

  // Sets the point to trace from; false if it cannot be evaluated.
  bool Prepare() {
    EffectProblem own = fitting_.Problem(fit_.hypothesis, gain_, Fitting::Care::kRough);
    if (!own.FixSubsteps(fit_.x)) return false;
    const auto r = own.Residuals(fit_.x);
    if (!r || r->size() == 0) return false;
    r_ = *r;
    j0_ = DifferenceColumns(
        ResidualsOf(own), fit_.x, r_,
        {0, static_cast<int>(fit_.x.size()), fitting_.difference(), fitting_.threads()});
    const Eigen::Index size = j0_.cols();
    normal0_.compute(j0_.transpose() * j0_ +
                     1e-9 * j0_.squaredNorm() * Eigen::MatrixXd::Identity(size, size));
    least_ = BestStep(&own, fit_.x, r_, j0_);
    return true;
  }

  // How well the whole response to the effect at its start fits the residuals.
  double Response(const Effect& effect, const Eigen::VectorXd& start) const {
    EffectProblem problem = Add(effect, start);
    const Eigen::VectorXd x = Extend(start);
    if (!problem.FixSubsteps(x)) return kNone;
    const auto at = problem.Residuals(x);
    if (!at) return kNone;
    Eigen::VectorXd response = *at - r_;
    response -= j0_ * normal0_.solve(j0_.transpose() * response);
    const double along = -response.dot(r_);
    return along > 0 ? along * along / std::max(1e-300, response.squaredNorm()) : 0;
  }

  // How much less a step with the effect leaves than one without it, as a part of that.
  double Score(const Effect& effect, const Eigen::VectorXd& start) const {
    EffectProblem problem = Add(effect, start);
    const Eigen::VectorXd x = Extend(start);
    if (!problem.FixSubsteps(x)) return kNone;
    const Eigen::Index own = fit_.x.size(), added = start.size();
    std::vector<Eigen::VectorXd> moved(static_cast<std::size_t>(added) + 1, x);
    for (Eigen::Index i = 0; i < added; ++i) moved[i + 1][own + i] += fitting_.difference();
    const auto at = problem.Residuals(moved);
    if (!at[0]) return kNone;
    Eigen::MatrixXd j = Eigen::MatrixXd::Zero(r_.size(), own + added);
    j.leftCols(own) = j0_;
    for (Eigen::Index i = 0; i < added; ++i) {
      if (at[i + 1]) j.col(own + i) = (*at[i + 1] - *at[0]) / fitting_.difference();
    }
    return 1 - BestStep(&problem, x, *at[0], j) / least_;
  }

 private:
  EffectProblem Add(const Effect& effect, const Eigen::VectorXd& start) const {
    Hypothesis with = fit_.hypothesis;
    with.effects.push_back({effect.name(), start});
    return fitting_.Problem(with, gain_, Fitting::Care::kRough);
  }
  Eigen::VectorXd Extend(const Eigen::VectorXd& start) const {
    Eigen::VectorXd x = Eigen::VectorXd::Zero(fit_.x.size() + start.size());
    x.head(fit_.x.size()) = fit_.x;
    return x;
  }

  // The least squared misfit after a damped step of Gauss-Newton.
  double BestStep(EffectProblem* problem, const Eigen::VectorXd& x, const Eigen::VectorXd& at,
                  const Eigen::MatrixXd& j) const {
    const double variance = r_.squaredNorm() / static_cast<double>(r_.size());
    const Eigen::MatrixXd precision = problem->model().Precision(x);
    const Eigen::MatrixXd normal = j.transpose() * j / variance + precision;
    const Eigen::VectorXd gradient = j.transpose() * at / variance + precision * x;
    std::vector<Eigen::VectorXd> tried;
    for (double damping : {1e-3, 3e-2, 1.0, 30.0}) {
      Eigen::MatrixXd damped = normal;
      damped.diagonal() += damping * normal.diagonal();
      Eigen::VectorXd step = -damped.ldlt().solve(gradient);
      step *= std::min(1.0, kLongestStep / std::max(1e-300, step.cwiseAbs().maxCoeff()));
      tried.emplace_back(x + step);
    }
    double least = at.squaredNorm();
    for (const auto& there : problem->Residuals(tried)) {
      if (there) least = std::min(least, there->squaredNorm());
    }
    return least;
  }

  const Fitting& fitting_;
  const Descent& fit_;
  const double gain_;
  Eigen::VectorXd r_;
  Eigen::MatrixXd j0_;  // the columns of the model's own parameters
  Eigen::LDLT<Eigen::MatrixXd> normal0_;
  double least_ = 0;  // squared misfit after a step without a new effect
};

}  // namespace

std::vector<EffectTrace> TraceEffects(const Fitting& fitting, const Descent& fit,
                                      const std::vector<const Effect*>& effects, double gain,
                                      const WorkShare& stage) {
  std::vector<EffectTrace> traces;
  for (const Effect* effect : effects) traces.push_back({effect, 0, {}});
  Tracer tracer(fitting, fit, gain);
  if (!tracer.Prepare()) return traces;
  const SpringMassSystem system = fitting.Model(fit.hypothesis).Apply(fit.x);
  std::vector<Job> jobs;
  for (std::size_t i = 0; i < effects.size(); ++i) {
    for (Eigen::VectorXd& start : effects[i]->Starts(system)) jobs.push_back({i, std::move(start)});
  }
  const auto for_each_job = [&](const char* kind, auto score) {
    ParallelFor(static_cast<int>(jobs.size()), fitting.threads(), [&](int n) {
      Job& job = jobs[static_cast<std::size_t>(n)];
      const Effect& effect = *effects[job.effect];
      PieceKey key = KeyOf(kind, fit.hypothesis);
      job.score = fitting.journal().Get(
          key.Add(gain).Add(fit.x).Add(effect.name()).Add(job.start),
          [&] { return Eigen::VectorXd::Constant(1, score(effect, job.start)); })[0];
    });
  };
  fitting.journal().Stage(stage.Part(0, 0.4), static_cast<int>(jobs.size()), "tracing the effects");
  for_each_job("response", [&](const Effect& effect, const Eigen::VectorXd& start) {
    return tracer.Response(effect, start);
  });
  std::stable_sort(jobs.begin(), jobs.end(), [](const Job& p, const Job& q) {
    return p.effect != q.effect ? p.effect < q.effect : p.score > q.score;
  });
  std::vector<std::size_t> kept(effects.size(), 0);
  // what begins as no effect at all responds with nothing, and may be right all the same
  std::erase_if(jobs, [&](const Job& job) {
    if (job.score == kNone) return true;
    return !job.start.isZero(0) && kept[job.effect]++ >= kStarts;
  });
  fitting.journal().Stage(stage.Part(0.4, 1), static_cast<int>(jobs.size()), "tracing the effects");
  for_each_job("score", [&](const Effect& effect, const Eigen::VectorXd& start) {
    return tracer.Score(effect, start);
  });
  for (const Job& job : jobs) {
    EffectTrace& trace = traces[job.effect];
    if (job.score == kNone || (trace.start.size() > 0 && job.score <= trace.score)) continue;
    trace.score = job.score;
    trace.start = job.start;
  }
  for (EffectTrace& trace : traces) trace.score = std::max(0.0, trace.score);
  return traces;
}

}  // namespace physpring
