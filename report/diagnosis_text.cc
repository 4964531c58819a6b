// SPDX-License-Identifier: Apache-2.0
#include "report/diagnosis_text.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "report/diagnosis/effect_words.h"

namespace physpring {
namespace {

constexpr double kSteady = 0.7;  // a direction that turns by a third of a circle has 0.83

// "a, b", or `none`.
std::string Join(const std::vector<std::string>& names, const char* none) {
  return names.empty() ? none : fmt::format("{}", fmt::join(names, ", "));
}

}  // namespace

std::vector<const EffectCandidate*> ConfoundedCandidates(const Diagnosis& diagnosis) {
  std::vector<const EffectCandidate*> candidates;
  for (const EffectCandidate& candidate : diagnosis.rankings.at(0)) {
    if (diagnosis.effects.empty() || candidate.name == diagnosis.effects[0].name) continue;
    if (candidate.alike) candidates.push_back(&candidate);
  }
  return candidates;
}

std::vector<std::string> Confounded(const Diagnosis& diagnosis) {
  std::vector<std::string> names;
  for (const EffectCandidate* one : ConfoundedCandidates(diagnosis)) names.push_back(one->name);
  return names;
}

std::string InMillimetres(double metres) {
  return std::isfinite(metres) ? fmt::format("{:.2f} mm", 1e3 * metres) : "no data";
}

std::string DescribeGain(const BootstrapResult& gain) {
  return fmt::format("gain {:.2f} mm, 95 % interval {:.2f} to {:.2f}", 1e3 * gain.mean,
                     1e3 * gain.low, 1e3 * gain.high);
}

std::string DescribeParameters(const Diagnosis& diagnosis, std::size_t effect) {
  std::string text, key;
  for (const ValueRange& range : RangesOf(diagnosis, effect)) {
    if (range.key != key) text += (text.empty() ? "" : ", ") + range.key;
    key = range.key;
    text += fmt::format(" {:.3g}", range.value);
    if (!range.certainty) continue;
    text += fmt::format(" ± {:.2g}", range.certainty->HalfInterval());
    if (range.certainty->IsUntold()) {
      text += " (not told by the recordings)";
    } else if (range.certainty->IsHardlyTold()) {
      text += " (other parameters move the body nearly alike)";
    }
  }
  return text;
}

std::string DescribeCertainty(const Diagnosis& diagnosis) {
  return fmt::format(
      "behind ±: half a 95 % interval, from the misfit's curvature and how alike neighbouring "
      "residuals are{}",
      diagnosis.unexplained ? "; too narrow, since the model lacks more than what was found" : "");
}

std::string DescribeConfounded(const Diagnosis& diagnosis) {
  const std::vector<std::string> names = Confounded(diagnosis);
  return names.empty() ? "" : "as good on these recordings: " + Join(names, "");
}

std::string DescribeVerdict(const Diagnosis& diagnosis) {
  if (diagnosis.effects.empty() && !diagnosis.unexplained) {
    if (diagnosis.after.held <= kExplained * diagnosis.noise_floor) return "nothing is missing";
    return fmt::format(
        "nothing is missing that could be told: {} above the noise are left, too little to trace",
        InMillimetres(diagnosis.after.held - diagnosis.noise_floor));
  }
  std::string verdict = diagnosis.effects.empty() ? "no effect was found" : "";
  for (const EffectValues& effect : diagnosis.effects) {
    verdict += (verdict.empty() ? "the model lacks " : ", ") + effect.name;
    const EffectPicture picture = PictureOf(diagnosis, effect);
    if (picture.formula) verdict += fmt::format(" ({})", picture.lacks);
  }
  if (!diagnosis.unexplained) return verdict;
  const Unexplained& left = *diagnosis.unexplained;
  verdict += fmt::format("; {} above the noise are unexplained", InMillimetres(left.track));
  if (!left.converged) return verdict + ", and the search for the force that is missing failed";
  if (!left.located) return verdict + ", and no force on what was fitted would explain them";
  return verdict + fmt::format(
                       ": a force, largest on particle {}, mostly from {:.2f} to {:.2f} s, then "
                       "towards ({:.2f}, {:.2f}, {:.2f}), which {}",
                       left.particle, left.first_time, left.last_time, left.direction[0],
                       left.direction[1], left.direction[2],
                       left.steadiness > kSteady ? "stays" : "turns");
}

std::string DescribeResidual(const Diagnosis& diagnosis) {
  const auto force = [](const ResidualPattern& pattern, const char* when) {
    if (!pattern.converged) {
      return fmt::format("not found{} (the search did not converge, {} are left)", when,
                         InMillimetres(pattern.left));
    }
    return pattern.root_mean_square > 0
               ? fmt::format("{:.3g} mN{} (noise makes {:.2g})", 1e3 * pattern.root_mean_square,
                             when, 1e3 * pattern.noise)
               : fmt::format("none{}", when);
  };
  const ResidualPattern& before = diagnosis.residual_before;
  const bool changed = !diagnosis.effects.empty();
  std::string text = "missing force on a node: " + force(before, changed ? " before" : "");
  if (changed) text += ", " + force(diagnosis.residual_after, " after");
  if (before.root_mean_square == 0 || !before.converged) return text;
  return text +
         fmt::format(
             "; {}{:.0f} % of its square is one acceleration of all nodes, and its cosine is "
             "{:.2f} with the velocity, {:.2f} with the stretch",
             changed ? "before " : "", 100 * before.constant, before.with_velocity,
             before.with_stretch);
}

std::string DescribeRecordings(const Diagnosis& diagnosis) {
  std::string text = fmt::format("fitted to {}; judged by {}", Join(diagnosis.fitted, "nothing"),
                                 Join(diagnosis.judged, "frames that were not fitted"));
  if (!diagnosis.before_change.empty()) {
    text +=
        fmt::format("; fitted, too, as before the change: {}", Join(diagnosis.before_change, ""));
  }
  if (diagnosis.resting_frames > 0) {
    text += fmt::format("; without the last {} frames, in which nothing moves any more",
                        diagnosis.resting_frames);
  }
  return text;
}

std::string FormatDiagnosisText(const Diagnosis& diagnosis) {
  std::string text = DescribeRecordings(diagnosis) + "\n";
  text += fmt::format("noise floor: {}; held out, a body that does not move: {}\n",
                      InMillimetres(diagnosis.noise_floor), InMillimetres(diagnosis.motionless));
  text += fmt::format("before, refitted without new effects: fit {}, held out {}\n",
                      InMillimetres(diagnosis.before.fit), InMillimetres(diagnosis.before.held));
  const std::size_t listed =
      diagnosis.effects.size() - static_cast<std::size_t>(diagnosis.law_terms);
  for (std::size_t i = 0; i < diagnosis.rankings.size(); ++i) {
    for (const EffectCandidate& candidate : diagnosis.rankings[i]) {
      if (!candidate.refit) continue;
      text += fmt::format(
          "  {:<18} linearised {:5.1f} % of the misfit; held out {} instead of {} ({}; "
          "p {:.2g})\n",
          candidate.name, 100 * candidate.score, InMillimetres(candidate.refit->held),
          InMillimetres(candidate.without), DescribeGain(candidate.gain), candidate.gain.p);
    }
    if (i < listed) {
      text += fmt::format("added: {} ({})\n", diagnosis.effects[i].name,
                          DescribeParameters(diagnosis, i));
    } else if (!diagnosis.rankings[i].empty()) {
      text += diagnosis.refusal.empty()
                  ? "added: none, since none helps on the held-out frames\n"
                  : fmt::format("added: none; the best is {}\n", diagnosis.refusal);
    }
  }
  for (std::size_t i = listed; i < diagnosis.effects.size(); ++i) {
    text += fmt::format("added: a term of a law that is no effect of the list: {}\n",
                        DescribeEffect(diagnosis, i));
  }
  if (!diagnosis.effects.empty()) text += DescribeCertainty(diagnosis) + "\n";
  const std::string confounded = DescribeConfounded(diagnosis);
  if (!confounded.empty()) text += confounded + "\n";
  text += fmt::format("after: fit {}, held out {}\n", InMillimetres(diagnosis.after.fit),
                      InMillimetres(diagnosis.after.held));
  if (diagnosis.all_frames) {
    text += fmt::format("twin: fitted to the held-out frames, too, all {}\n",
                        InMillimetres(*diagnosis.all_frames));
  }
  return text + DescribeResidual(diagnosis) + "\n" + DescribeVerdict(diagnosis) + "\n";
}

}  // namespace physpring
