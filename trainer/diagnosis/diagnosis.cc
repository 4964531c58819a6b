// SPDX-License-Identifier: Apache-2.0
#include "trainer/diagnosis/diagnosis.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "trainer/diagnosis/noise_floor.h"
#include "trainer/fit_model.h"
#include "trainer/levenberg_marquardt.h"
#include "trainer/parallel.h"
#include "trainer/start_system.h"
#include "twin/effects/registry.h"
#include "twin/error.h"
#include "twin/predict.h"
#include "twin/stability.h"
#include "twin/topology.h"

namespace physpring {
namespace {

using Use = SplitRecording::Use;

constexpr double kTrustedScale = 0.05;  // of the own parameters of a twin trained on other data
constexpr int kRefitted = 5;            // candidates after the trace
constexpr int kFinalists = 2;           // of these, with single springs
constexpr double kShort = 0.3;          // part of the fit frames that fits begin with
constexpr int kShortSteps = 8, kFirstSteps = 4, kLastSteps = 12, kSpringSteps = 6;
constexpr double kSoftest = 2, kStiffest = 64;  // start systems tried, in sub-steps a frame
constexpr std::size_t kStarts = 2;              // of an effect that are looked at closely
constexpr int kDraws = 2000;
constexpr double kBlock = 0.2;      // s, of the bootstrap
constexpr double kHeldBlock = 0.3;  // s, of held-out blocks within a recording

// Springs of equal axial stiffness and of their reference lengths, equal dashpots, equal masses.
SpringMassSystem MakeAlike(const SpringMassSystem& system) {
  SpringMassSystem alike = system;
  alike.effects.clear();
  alike.rest_length = SpringLengths(system.springs, system.position, system.order);
  alike.stiffness = alike.rest_length.cwiseInverse();
  alike.dashpot.setOnes();
  alike.mass.setConstant(system.mass.sum() / system.node_count());
  return alike;
}

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

// The first part of the fit frames alone: over a shorter time a motion depends on its parameters
// more evenly.
std::vector<SplitRecording> Shorten(std::vector<SplitRecording> recordings) {
  for (SplitRecording& split : recordings) {
    const int frames = std::max(2, static_cast<int>(kShort * split.last(Use::kFit)));
    for (std::size_t frame = 0; frame < split.use.size(); ++frame) {
      const bool kept = static_cast<int>(frame) < frames && split.use[frame] == Use::kFit;
      if (!kept) split.use[frame] = Use::kNone;
    }
  }
  return recordings;
}

// A model after a refit.
struct Fit {
  std::vector<EffectValues> start;  // of its effects
  Eigen::VectorXd short_x, x;       // common factors and effects, on the first part and on all
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
      : recordings_(std::move(recordings)),
        short_(Shorten(recordings_)),
        trained_on_(trained_on),
        options_(options) {
    const TwinLevel& level = twin.levels[0];
    known_ = level.system.effects;
    base_ = level.system;
    base_.effects.clear();
    has_ground_ = recordings_[0].recording->ground.has_value();
    problem_options_.controller_velocity = twin.controller_velocity;
    problem_options_.difference = has_ground_ ? 1e-3 : 1e-5;
    if (trained_on) SearchBase();
  }

  const std::vector<EffectValues>& known() const { return known_; }

  // Fits common factors and effects from x, first to the first part of the fit frames.
  std::optional<Fit> Refit(const std::vector<EffectValues>& start, const Eigen::VectorXd& x,
                           int short_steps, int steps) const {
    const auto first = Descend(start, x, short_steps, short_);
    if (!first) return {};
    Fit fit;
    fit.start = start;
    fit.short_x = *first;
    return Continue(fit, fit.short_x, steps);
  }

  // Goes on from x on all fit frames.
  std::optional<Fit> Continue(Fit fit, const Eigen::VectorXd& x, int steps) const {
    const auto last = Descend(fit.start, x, steps, recordings_);
    if (!last) return {};
    fit.x = *last;
    EffectProblem problem = MakeProblem(CommonModel(fit.start), recordings_);
    fit.system = problem.model().Apply(fit.x);
    if (!Judge(&problem, fit.x, &fit)) return {};
    return fit;
  }

  // Goes on with single springs.
  void RefitSprings(Fit* fit) const {
    SpringMassSystem base = fit->system;
    base.effects.clear();
    EffectProblem problem = MakeProblem(
        EffectModel(SpringFactors(base, *recordings_[0].recording), 1, fit->system.effects),
        recordings_);
    const GaussNewtonOptions prior = Prior(problem.model());
    GaussNewtonState state;
    state.x = Eigen::VectorXd::Zero(problem.model().size());
    state.damping = 1e-3;
    for (int step = 0; step < kSpringSteps && !state.converged; ++step) {
      state = GaussNewtonStep(&problem, state, prior);
    }
    Fit refitted = *fit;
    refitted.system = problem.model().Apply(state.x);
    if (Judge(&problem, state.x, &refitted)) *fit = refitted;
  }

  // Part of the squared misfit on the first frames that one step of a fit takes away when an effect
  // is added at `start`, beyond what the model's own parameters can.
  struct Trace {
    double score = 0;
    Eigen::VectorXd start;
  };
  std::vector<Trace> TraceAll(const Fit& fit, const std::vector<const Effect*>& effects) const;

  EffectModel CommonModel(const std::vector<EffectValues>& start) const {
    return EffectModel(CommonFactors(base_, *recordings_[0].recording),
                       trained_on_ ? 1 : kTrustedScale, start);
  }

 private:
  // Equal springs, so stiff that they predict the fit frames best.
  void SearchBase() {
    const SpringMassSystem alike = MakeAlike(base_);
    double least = std::numeric_limits<double>::infinity();
    for (double substeps = kSoftest; substeps <= kStiffest; substeps *= 2) {
      SpringMassSystem scaled = alike;
      ScaleToSubsteps(1 / recordings_[0].recording->fps, substeps, kStepSafety, &scaled);
      EffectProblem problem = MakeProblem(
          EffectModel(CommonFactors(scaled, *recordings_[0].recording), 1, known_), short_);
      const Eigen::VectorXd x = Eigen::VectorXd::Zero(problem.model().size());
      if (!problem.FixSubsteps(x)) continue;
      const auto r = problem.Residuals(x);
      if (!r || r->squaredNorm() >= least) continue;
      least = r->squaredNorm();
      base_ = scaled;
    }
  }

  // Levenberg-Marquardt from x; nothing if the model cannot be evaluated there.
  std::optional<Eigen::VectorXd> Descend(const std::vector<EffectValues>& start,
                                         const Eigen::VectorXd& x, int steps,
                                         const std::vector<SplitRecording>& recordings) const {
    EffectProblem problem = MakeProblem(CommonModel(start), recordings);
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
    return state.x;
  }

  EffectProblem MakeProblem(EffectModel model,
                            const std::vector<SplitRecording>& recordings) const {
    EffectProblem::Options options = problem_options_;
    options.threads = static_cast<int>(recordings_.size()) > 1 ? options_.threads : 1;
    return EffectProblem(std::move(model), recordings, options);
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

  // The trainer's, and for the effects the one of Levenberg-Marquardt.
  static GaussNewtonOptions Prior(const EffectModel& model) {
    GaussNewtonOptions options = SpringPrior(model.own());
    options.conjugate_gradient_steps = 15;
    const auto append = [&](double value, Eigen::VectorXd* values) {
      const Eigen::Index own = values->size();
      values->conservativeResize(model.size());
      values->tail(model.size() - own).setConstant(value);
    };
    append(0.25, &options.precision);
    append(30, &options.scale);
    return options;
  }

  std::vector<SplitRecording> recordings_, short_;
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
  const SpringMassSystem system = CommonModel(fit.start).Apply(fit.short_x);
  std::vector<Job> jobs;
  for (std::size_t i = 0; i < effects.size(); ++i) {
    for (Eigen::VectorXd& start : effects[i]->Starts(system)) jobs.push_back({i, std::move(start)});
  }
  // the model's own columns: J0, with its prior
  constexpr double kDifference = 1e-3, kPrecision = 0.25;
  EffectProblem own = MakeProblem(CommonModel(fit.start), short_);
  if (!own.FixSubsteps(fit.short_x)) return std::vector<Trace>(effects.size());
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
  const auto r = own.Residuals(fit.short_x);
  if (!r) return std::vector<Trace>(effects.size());
  const int size = static_cast<int>(fit.short_x.size());
  const Eigen::MatrixXd j0 = columns(&own, fit.short_x, *r, 0, size, options_.threads);
  const auto add = [&](const Job& job) {
    std::vector<EffectValues> start = fit.start;
    start.push_back({effects[job.effect]->name(), job.start});
    return MakeProblem(CommonModel(start), short_);
  };
  const auto extend = [&](const Job& job) {
    Eigen::VectorXd x = Eigen::VectorXd::Zero(size + job.start.size());
    x.head(size) = fit.short_x;
    return x;
  };
  // of many starts, those whose whole response fits the residuals best
  const Eigen::LDLT<Eigen::MatrixXd> normal0(Eigen::MatrixXd(
      j0.transpose() * j0 + 1e-9 * j0.squaredNorm() * Eigen::MatrixXd::Identity(size, size)));
  ParallelFor(static_cast<int>(jobs.size()), options_.threads, [&](int n) {
    Job& job = jobs[static_cast<std::size_t>(n)];
    EffectProblem problem = add(job);
    const Eigen::VectorXd x = extend(job);
    if (!problem.FixSubsteps(x)) return;
    const auto at = problem.Residuals(x);
    if (!at) return;
    Eigen::VectorXd response = *at - *r;
    response -= j0 * normal0.solve(j0.transpose() * response);
    const double along = -response.dot(*r);
    if (along > 0) job.score = along * along / std::max(1e-300, response.squaredNorm());
  });
  std::stable_sort(jobs.begin(), jobs.end(), [](const Job& p, const Job& q) {
    return p.effect != q.effect ? p.effect < q.effect : p.score > q.score;
  });
  std::vector<std::size_t> kept(effects.size(), 0);
  std::erase_if(jobs, [&](const Job& job) { return kept[job.effect]++ >= kStarts; });
  // the least squared misfit after a damped step of Gauss-Newton
  const auto best_step = [&](EffectProblem* problem, const Eigen::VectorXd& x,
                             const Eigen::VectorXd& at, const Eigen::MatrixXd& j) {
    const double variance = r->squaredNorm() / static_cast<double>(r->size());
    Eigen::MatrixXd normal = j.transpose() * j / variance;
    normal.diagonal().array() += kPrecision;
    const Eigen::VectorXd gradient = j.transpose() * at / variance + kPrecision * x;
    double least = at.squaredNorm();
    for (double damping : {1e-3, 3e-2, 1.0, 30.0}) {
      Eigen::MatrixXd damped = normal;
      damped.diagonal() += damping * normal.diagonal();
      Eigen::VectorXd step = -damped.ldlt().solve(gradient);
      step *= std::min(1.0, 1.5 / std::max(1e-300, step.cwiseAbs().maxCoeff()));
      const auto there = problem->Residuals(x + step);
      if (there) least = std::min(least, there->squaredNorm());
    }
    return least;
  };
  const double least = best_step(&own, fit.short_x, *r, j0);

  ParallelFor(static_cast<int>(jobs.size()), options_.threads, [&](int n) {
    Job& job = jobs[static_cast<std::size_t>(n)];
    job.score = 0;
    EffectProblem problem = add(job);
    const int added = static_cast<int>(job.start.size());
    const Eigen::VectorXd x = extend(job);
    if (!problem.FixSubsteps(x)) return;
    const auto at = problem.Residuals(x);
    if (!at) return;
    Eigen::MatrixXd j(r->size(), size + added);
    j << j0, columns(&problem, x, *at, size, added, 1);
    job.score = 1 - best_step(&problem, x, *at, j) / least;
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
  std::optional<Fit> base =
      engine.Refit(engine.known(), Eigen::VectorXd::Zero(own), 2 * kShortSteps, kLastSteps);
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
    const auto report_round = [&](double share, const std::string& status) {
      report(0.2 + 0.8 * (round + share) / options.most_effects, status);
    };
    report_round(0, "tracing the effects");
    std::vector<const Effect*> effects;
    for (const Effect* effect : AllEffects()) {
      if (effect->name() == "ground_contact" && !recordings[0].ground) continue;
      effects.push_back(effect);
    }
    const auto traces = engine.TraceAll(common, effects);
    std::vector<EffectCandidate> candidates;
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
      report_round(0.1 + 0.1 * static_cast<double>(n), "refitting with " + effects[i]->name());
      std::vector<EffectValues> start = common.start;
      start.push_back({effects[i]->name(), traces[i].start});
      Eigen::VectorXd x = Eigen::VectorXd::Zero(common.x.size() + traces[i].start.size());
      x.head(common.x.size()) = common.short_x;
      fits[i] = engine.Refit(start, x, kShortSteps, kFirstSteps);
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
        if (auto longer = engine.Continue(*fits[i], fits[i]->x, kLastSteps)) fits[i] = longer;
        with_springs[i] = *fits[i];
        report_round(0.6 + 0.2 * static_cast<double>(n),
                     "refitting springs with " + effects[i]->name());
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
                       [](const EffectCandidate& p, const EffectCandidate& q) {
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
  for (const Recording& recording : recordings) {
    const auto& known = twin.trained_on;
    if (std::any_of(known.begin(), known.end(),
                    [&](const TrainedOn& trained) { return trained.hash == recording.hash; })) {
      continue;
    }
    result.twin.trained_on.push_back({recording.name, recording.hash, recording.train_frames});
  }
  report(1, "done");
  return result;
}

}  // namespace physpring
