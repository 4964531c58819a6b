// SPDX-License-Identifier: Apache-2.0
#include "trainer/diagnosis/diagnosis.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <set>

#include "trainer/diagnosis/noise_floor.h"
#include "trainer/levenberg_marquardt.h"
#include "trainer/parallel.h"
#include "twin/effects/registry.h"
#include "twin/error.h"
#include "twin/predict.h"

namespace physpring {
namespace {

using Use = SplitRecording::Use;

constexpr double kTrustedScale = 0.05;  // of the own parameters of a twin trained on other data
constexpr int kRefitted = 6;            // candidates after the trace
constexpr int kFinalists = 2;           // of these, with single springs
constexpr int kFirstSteps = 5, kLastSteps = 12, kSpringSteps = 4;
constexpr int kDraws = 2000;
constexpr double kBlock = 0.2;      // s, of the bootstrap
constexpr double kHeldBlock = 0.3;  // s, of held-out blocks within a recording

SplitRecording Split(const Recording& recording, bool hold_out) {
  const auto frames = static_cast<std::size_t>(recording.frame_count());
  SplitRecording split{&recording, std::vector<Use>(frames, Use::kFit)};
  split.use[0] = Use::kNone;
  const auto block = static_cast<std::size_t>(std::max(1.0, kHeldBlock * recording.fps));
  for (std::size_t frame = 1; frame < frames; ++frame) {
    const bool future = frame >= static_cast<std::size_t>(recording.train_frames);
    const bool has_future = recording.train_frames < recording.frame_count();
    if (hold_out && (has_future ? future : frame / block % 4 == 3)) split.use[frame] = Use::kHeld;
  }
  return split;
}

// A model after a refit.
struct Fit {
  std::vector<EffectValues> start;  // of its effects
  Eigen::VectorXd x;                // common factors and effects
  double mean_square = 0;           // of the fit residuals
  // after the single springs, or the same as above
  SpringMassSystem system;
  std::vector<std::vector<Points>> predicted;
  FrameTrack held;
  TrackPair track{};
};

class Engine {
 public:
  Engine(const Twin& twin, std::vector<SplitRecording> recordings, bool trained_on,
         const DiagnosisOptions& options)
      : recordings_(std::move(recordings)), trained_on_(trained_on), options_(options) {
    const TwinLevel& level = twin.levels[0];
    known_ = level.system.effects;
    base_ = level.system;
    base_.effects.clear();
    has_ground_ = recordings_[0].recording->ground.has_value();
    problem_options_.controller_velocity = twin.controller_velocity;
    problem_options_.difference = has_ground_ ? 1e-3 : 1e-5;
  }

  const std::vector<EffectValues>& known() const { return known_; }

  // Fits common factors and effects from x, for at most `steps` steps.
  std::optional<Fit> Refit(const std::vector<EffectValues>& start, const Eigen::VectorXd& x,
                           int steps) const {
    EffectProblem problem = MakeProblem(CommonModel(start));
    LevenbergMarquardtOptions options;
    options.threads = options_.threads;
    options.difference = has_ground_ ? 1e-2 : 1e-3;
    LevenbergMarquardtState state;
    state.x = x;
    for (int step = 0; step < steps && !state.converged; ++step) {
      if (!problem.FixSubsteps(state.x)) return {};
      state = LevenbergMarquardtStep(
          [&](const Eigen::VectorXd& at) { return problem.Residuals(at); }, state, options);
    }
    Fit fit;
    fit.start = start;
    fit.x = state.x;
    fit.mean_square = state.mean_square;
    fit.system = problem.model().Apply(state.x);
    if (!Judge(&problem, fit.x, &fit)) return {};
    return fit;
  }

  // Goes on with single springs.
  void RefitSprings(Fit* fit) const {
    SpringMassSystem base = fit->system;
    base.effects.clear();
    ParameterOptions own;
    own.spring_rest_length = true;
    own.contact = has_ground_;
    EffectProblem problem = MakeProblem(EffectModel(Parameters(base, own), 1, fit->system.effects));
    GaussNewtonState state;
    state.x = Eigen::VectorXd::Zero(problem.model().size());
    state.damping = 1e-3;
    const GaussNewtonOptions prior = SpringPrior(problem.model());
    for (int step = 0; step < kSpringSteps && !state.converged; ++step) {
      state = GaussNewtonStep(&problem, state, prior);
    }
    Fit refitted = *fit;
    refitted.mean_square = state.mean_square;
    refitted.system = problem.model().Apply(state.x);
    if (problem.FixSubsteps(state.x) && Judge(&problem, state.x, &refitted)) *fit = refitted;
  }

  // Part of the squared misfit that a linearised fit takes away when `effect` is added at `start`
  // to `fit`, beyond what the model's own parameters can; and where that leads.
  struct Trace {
    double score = 0;
    Eigen::VectorXd start;
  };
  std::vector<Trace> TraceAll(const Fit& fit, const std::vector<const Effect*>& effects) const;

  EffectModel CommonModel(const std::vector<EffectValues>& start) const {
    ParameterOptions own;
    own.spring_stiffness = own.spring_dashpot = own.spring_rest_length = false;
    own.contact = has_ground_;
    return EffectModel(Parameters(base_, own), trained_on_ ? 1 : kTrustedScale, start);
  }

 private:
  EffectProblem MakeProblem(EffectModel model) const {
    EffectProblem::Options options = problem_options_;
    options.threads = static_cast<int>(recordings_.size()) > 1 ? options_.threads : 1;
    return EffectProblem(std::move(model), recordings_, options);
  }

  bool Judge(EffectProblem* problem, const Eigen::VectorXd& x, Fit* fit) const {
    if (!problem->FixSubsteps(x)) return false;
    auto predicted = problem->Predict(x);
    if (!predicted) return false;
    fit->predicted = std::move(*predicted);
    fit->held = TrackOf(recordings_, fit->predicted, Use::kHeld);
    fit->track = {Mean(TrackOf(recordings_, fit->predicted, Use::kFit)), Mean(fit->held)};
    return true;
  }

  static GaussNewtonOptions SpringPrior(const EffectModel& model) {
    GaussNewtonOptions options;
    options.conjugate_gradient_steps = 15;
    options.precision = Eigen::VectorXd::Constant(model.size(), 0.25);
    options.scale = Eigen::VectorXd::Constant(model.size(), 30);
    for (int i = 0; i < model.own().size(); ++i) {
      // standard deviations of single springs' stiffness and dashpot 0.5, of rest lengths 1 %
      const Parameters::Kind kind = model.own().kind(i);
      if (kind == Parameters::Kind::kGlobal) continue;
      const bool length = kind == Parameters::Kind::kRestLength;
      options.precision[i] = length ? 1e4 : 4;
      options.scale[i] = length ? 100 : 1;
    }
    return options;
  }

  std::vector<SplitRecording> recordings_;
  bool trained_on_;
  DiagnosisOptions options_;
  SpringMassSystem base_;            // without effects
  std::vector<EffectValues> known_;  // that the twin has already
  bool has_ground_ = false;
  EffectProblem::Options problem_options_;
};

std::vector<Engine::Trace> Engine::TraceAll(const Fit& fit,
                                            const std::vector<const Effect*>& effects) const {
  struct Job {
    std::size_t effect;
    Eigen::VectorXd start;
    double score = 0;
  };
  const SpringMassSystem system = CommonModel(fit.start).Apply(fit.x);
  std::vector<Job> jobs;
  for (std::size_t i = 0; i < effects.size(); ++i) {
    for (Eigen::VectorXd& start : effects[i]->Starts(system)) jobs.push_back({i, std::move(start)});
  }
  // the model's own columns: J0, with its prior
  constexpr double kDifference = 1e-3, kPrecision = 0.25;
  EffectProblem own = MakeProblem(CommonModel(fit.start));
  if (!own.FixSubsteps(fit.x)) return std::vector<Trace>(effects.size());
  const auto columns = [&](EffectProblem* problem, const Eigen::VectorXd& x,
                           const Eigen::VectorXd& r, int first, int count, int threads) {
    Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(r.size(), count);
    ParallelFor(count, threads, [&](int i) {
      Eigen::VectorXd moved = x;
      const double step = has_ground_ ? 10 * kDifference : kDifference;
      moved[first + i] += step;
      if (const auto at = problem->Residuals(moved)) jacobian.col(i) = (*at - r) / step;
    });
    return jacobian;
  };
  const auto r = own.Residuals(fit.x);
  if (!r) return std::vector<Trace>(effects.size());
  const int size = static_cast<int>(fit.x.size());
  const Eigen::MatrixXd j0 = columns(&own, fit.x, *r, 0, size, options_.threads);
  const double variance = r->squaredNorm() / static_cast<double>(r->size());
  const double count = static_cast<double>(r->size());

  ParallelFor(static_cast<int>(jobs.size()), options_.threads, [&](int n) {
    Job& job = jobs[static_cast<std::size_t>(n)];
    std::vector<EffectValues> start = fit.start;
    start.push_back({effects[job.effect]->name(), job.start});
    EffectProblem problem = MakeProblem(CommonModel(start));
    const int added = static_cast<int>(job.start.size());
    Eigen::VectorXd x = Eigen::VectorXd::Zero(size + added);
    x.head(size) = fit.x;
    if (!problem.FixSubsteps(x)) return;
    const auto at = problem.Residuals(x);
    if (!at) return;
    Eigen::MatrixXd j(r->size(), size + added);
    j << j0, columns(&problem, x, *at, size, added, 1);
    Eigen::MatrixXd normal = j.transpose() * j / variance;
    normal.diagonal().array() += kPrecision;
    const Eigen::VectorXd gradient = j.transpose() * *at / variance + kPrecision * x;
    Eigen::VectorXd step = -normal.ldlt().solve(gradient);
    // no further than the linear model can be trusted
    step *= std::min(1.0, 1.5 / std::max(1e-300, step.cwiseAbs().maxCoeff()));
    const auto there = problem.Residuals(x + step);
    const double least =
        there ? std::min(at->squaredNorm(), there->squaredNorm()) : at->squaredNorm();
    job.score = 1 - least / variance / count;
  });
  std::vector<Trace> traces(effects.size());
  for (const Job& job : jobs) {
    Trace& trace = traces[job.effect];
    if (trace.start.size() > 0 && job.score <= trace.score) continue;
    trace = {job.score, job.start};
  }
  return traces;
}

std::vector<double> Difference(const FrameTrack& p, const FrameTrack& q) {
  std::vector<double> difference;
  for (std::size_t i = 0; i < p.size(); ++i) difference.push_back(p[i] - q[i]);
  return difference;
}

// Where, when and in which direction the error is largest.
Unexplained FindUnexplained(const std::vector<SplitRecording>& recordings, const Fit& fit,
                            double floor) {
  Unexplained unexplained;
  unexplained.track = fit.track.held - floor;
  const Recording& recording = *recordings[0].recording;
  const std::vector<Points>& predicted = fit.predicted[0];
  const int points = recording.point_count();
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(points);
  Points mean = Points::Zero(3, points);
  std::vector<double> of_frame(predicted.size(), 0);
  for (std::size_t frame = 1; frame < predicted.size(); ++frame) {
    for (int i = 0; i < points; ++i) {
      const Eigen::Vector3d r = recording.points[frame].col(i) - predicted[frame].col(i);
      if (std::isnan(r[0])) continue;
      sum[i] += r.squaredNorm();
      mean.col(i) += r;
      of_frame[frame] += r.squaredNorm();
    }
  }
  Eigen::Index worst = 0;
  sum.maxCoeff(&worst);
  unexplained.point = static_cast<int>(worst);
  unexplained.position = recording.start.col(worst);
  unexplained.direction = mean.col(worst).normalized();
  // the shortest run of frames that holds half of the squared error
  double total = 0;
  for (double e : of_frame) total += e;
  std::size_t best_length = of_frame.size(), first = 0;
  double window = 0;
  for (std::size_t begin = 0, end = 0; end < of_frame.size(); ++end) {
    window += of_frame[end];
    while (window - of_frame[begin] >= total / 2 && begin < end) window -= of_frame[begin++];
    if (window >= total / 2 && end - begin < best_length) {
      best_length = end - begin;
      first = begin;
    }
  }
  unexplained.first_time = static_cast<double>(first) / recording.fps;
  unexplained.last_time = static_cast<double>(first + best_length) / recording.fps;
  return unexplained;
}

}  // namespace

Diagnosis Diagnose(const Twin& twin, const std::vector<Recording>& recordings,
                   const std::vector<Recording>& held_out, const DiagnosisOptions& options) {
  Diagnosis result;
  std::vector<SplitRecording> splits;
  std::vector<const Recording*> all;
  for (const Recording& recording : recordings) {
    ExpectSameObject(twin, recording);
    splits.push_back(Split(recording, held_out.empty()));
    all.push_back(&recording);
    for (const TrainedOn& trained : twin.trained_on) {
      result.trained_on |= !trained.hash.empty() && trained.hash == recording.hash;
    }
  }
  for (const Recording& recording : held_out) {
    ExpectSameObject(twin, recording);
    splits.push_back({&recording, std::vector<Use>(recording.points.size(), Use::kHeld)});
    splits.back().use[0] = Use::kNone;
    all.push_back(&recording);
  }
  const double noise = MeasurementNoise(all);
  result.noise_floor = TrackNoiseFloor(noise);
  const auto report = [&](double share, const std::string& status) {
    if (options.progress) options.progress(share, status);
  };

  const Engine engine(twin, splits, result.trained_on, options);
  report(0, "refitting the model without any new effect");
  const int own = engine.CommonModel(engine.known()).size();
  std::optional<Fit> base = engine.Refit(engine.known(), Eigen::VectorXd::Zero(own), kLastSteps);
  if (!base) {
    throw Error(fmt::format("recording {}: twin {} diverges, so there is nothing to diagnose",
                            recordings[0].name, twin.name));
  }
  Fit accepted = *base, common = *base;
  if (result.trained_on) engine.RefitSprings(&accepted);
  result.before = accepted.track;
  result.before_track = accepted.held;
  const int block = static_cast<int>(std::ceil(kBlock * recordings[0].fps));

  for (int round = 0; round < options.most_effects; ++round) {
    const double from = 0.2 + 0.8 * round / options.most_effects;
    report(from, "tracing the effects");
    std::vector<const Effect*> effects;
    for (const Effect* effect : AllEffects()) {
      if (effect->name() == "ground_contact" && !recordings[0].ground) continue;
      effects.push_back(effect);
    }
    const auto traces = engine.TraceAll(common, effects);
    std::vector<Candidate> candidates;
    std::vector<std::optional<Fit>> fits(effects.size());
    std::vector<std::size_t> order;
    for (std::size_t i = 0; i < effects.size(); ++i) {
      candidates.push_back({effects[i]->name(), traces[i].score, {}, {}, {}});
      if (traces[i].start.size() > 0) order.push_back(i);
    }
    std::stable_sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) {
      return traces[i].score > traces[j].score;
    });
    order.resize(std::min<std::size_t>(order.size(), kRefitted));
    for (std::size_t n = 0; n < order.size(); ++n) {
      const std::size_t i = order[n];
      report(from + 0.1 + 0.08 * static_cast<double>(n), "refitting with " + effects[i]->name());
      std::vector<EffectValues> start = common.start;
      start.push_back({effects[i]->name(), traces[i].start});
      Eigen::VectorXd x = Eigen::VectorXd::Zero(common.x.size() + traces[i].start.size());
      x.head(common.x.size()) = common.x;
      fits[i] = engine.Refit(start, x, kFirstSteps);
    }
    // the best of them go on
    std::erase_if(order, [&](std::size_t i) { return !fits[i]; });
    std::stable_sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) {
      return fits[i]->track.held < fits[j]->track.held;
    });
    std::vector<Fit> with_springs(effects.size());
    for (std::size_t n = 0; n < order.size(); ++n) {
      const std::size_t i = order[n];
      if (n < kFinalists) {
        if (auto longer = engine.Refit(fits[i]->start, fits[i]->x, kLastSteps)) fits[i] = longer;
        with_springs[i] = *fits[i];
        report(from + 0.6, "refitting springs with " + effects[i]->name());
        if (result.trained_on) engine.RefitSprings(&with_springs[i]);
        candidates[i].gain = BlockBootstrap(Difference(accepted.held, with_springs[i].held), block,
                                            kDraws, options.seed);
        candidates[i].refit = with_springs[i].track;
      } else {
        candidates[i].gain =
            BlockBootstrap(Difference(common.held, fits[i]->held), block, kDraws, options.seed);
        candidates[i].refit = fits[i]->track;
      }
      candidates[i].values = fits[i]->system.effects.back();
    }
    const std::size_t finalists = std::min<std::size_t>(order.size(), kFinalists);
    const auto best =
        std::min_element(order.begin(), order.begin() + static_cast<long>(finalists),
                         [&](std::size_t i, std::size_t j) {
                           return with_springs[i].track.held < with_springs[j].track.held;
                         });
    const double excess = std::max(0.0, accepted.track.held - result.noise_floor);
    const bool accept = finalists > 0 &&
                        candidates[*best].gain.p < options.false_alarm / kRefitted &&
                        candidates[*best].gain.mean > options.least_gain * excess;
    if (accept) {
      accepted = with_springs[*best];
      common = *fits[*best];
    }
    if (round == 0) {
      result.candidates = std::move(candidates);
      std::stable_sort(result.candidates.begin(), result.candidates.end(),
                       [](const Candidate& p, const Candidate& q) {
                         const bool p_fits = p.refit.has_value(), q_fits = q.refit.has_value();
                         if (p_fits != q_fits) return p_fits;
                         return p_fits ? p.refit->held < q.refit->held : p.score > q.score;
                       });
    }
    if (!accept) break;
  }

  result.after = accepted.track;
  result.after_track = accepted.held;
  result.gain = BlockBootstrap(Difference(result.before_track, result.after_track), block, kDraws,
                               options.seed);
  result.effects = accepted.system.effects;
  result.effects.erase(result.effects.begin(),
                       result.effects.begin() + static_cast<long>(engine.known().size()));
  constexpr double kUnexplained = 2;  // times the noise floor
  if (accepted.track.held > kUnexplained * result.noise_floor) {
    result.unexplained = FindUnexplained(splits, accepted, result.noise_floor);
  }
  result.twin = twin;
  result.twin.training_state.clear();
  for (TwinLevel& level : result.twin.levels) {
    level.system.effects.insert(level.system.effects.end(), result.effects.begin(),
                                result.effects.end());
  }
  result.twin.levels[0].system = accepted.system;
  report(1, "done");
  return result;
}

}  // namespace physpring
