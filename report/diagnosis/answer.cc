// SPDX-License-Identifier: Apache-2.0
#include "report/diagnosis/answer.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <vector>

#include "report/diagnosis/effect_words.h"
#include "report/diagnosis_text.h"
#include "report/picture/quantity.h"

namespace physpring {
namespace {

// "a", "a and b", "a, b and c".
std::string List(std::vector<std::string> words) {
  const std::string last = words.back();
  words.pop_back();
  return words.empty() ? last : fmt::format("{} and {}", fmt::join(words, ", "), last);
}

std::string AnswerWithoutEffects(const Diagnosis& diagnosis) {
  const std::string error =
      fmt::format("on held-back frames the twin is {} mm off, and noise alone makes {} mm",
                  InMm(diagnosis.after.held), InMm(diagnosis.noise_floor));
  if (diagnosis.unexplained) return "Nothing on the list explains what is left: " + error + ".";
  if (diagnosis.after.held <= kExplained * diagnosis.noise_floor) {
    return "Nothing is missing: " + error + ".";
  }
  return "Nothing is missing that could be told: " + error + ", which is too little to trace.";
}

std::vector<std::string> EdgesReached(const Diagnosis& diagnosis) {
  std::vector<std::string> edges;
  for (std::size_t n = 0; n < diagnosis.effects.size(); ++n) {
    for (const ValueRange& range : RangesOf(diagnosis, n)) {
      if (!range.at_bound) continue;
      edges.push_back(fmt::format("{} of {} ({})", range.label,
                                  SpacedName(diagnosis.effects[n].name),
                                  FormatQuantity(range.value, range.unit)));
    }
  }
  return edges;
}

std::vector<std::string> SpacedNames(const std::vector<std::string>& names) {
  std::vector<std::string> spaced;
  for (const std::string& name : names) spaced.push_back(SpacedName(name));
  return spaced;
}

std::string DescribeLeft(const Diagnosis& diagnosis) {
  const Unexplained& left = *diagnosis.unexplained;
  std::string text = fmt::format("{} mm above the noise stay unexplained", InMm(left.track));
  if (!left.converged) {
    return text +
           ". The search for the force that is missing did not converge: look at units, "
           "gravity, ground and times first.";
  }
  if (!left.located) return text + ". No force on what was fitted would explain them.";
  const std::string place = DescribePlace(diagnosis.twin.levels[0].system, left.position);
  return text + fmt::format(
                    ": from {:.2f} to {:.2f} s a force is missing{}. It is largest on particle {}.",
                    left.first_time, left.last_time, place.empty() ? "" : " " + place,
                    left.particle);
}

// How much there is of an effect, where other parameters could do the same.
std::vector<std::string> AmountsHardlyTold(const Diagnosis& diagnosis) {
  std::vector<std::string> amounts;
  for (std::size_t n = 0; n < diagnosis.effects.size(); ++n) {
    const int amount = PictureOf(diagnosis, diagnosis.effects[n]).amount;
    if (amount < 0) continue;
    const ValueRange range = RangesOf(diagnosis, n)[static_cast<std::size_t>(amount)];
    if (!range.certainty) continue;
    if (!range.certainty->IsHardlyTold() && !range.certainty->IsUntold()) continue;
    amounts.push_back(
        fmt::format("the {} of {}", range.label, SpacedName(diagnosis.effects[n].name)));
  }
  return amounts;
}

// Values that other parameters could stand for, and those that the recordings do not tell.
std::string FormatUntold(const Diagnosis& diagnosis) {
  std::string items;
  for (std::size_t n = 0; n < diagnosis.effects.size(); ++n) {
    const std::string name = SpacedName(diagnosis.effects[n].name);
    for (const ValueRange& range : RangesOf(diagnosis, n)) {
      if (!range.certainty) continue;
      if (range.certainty->IsUntold()) {
        items += fmt::format(
            "<li><b>{}</b> of {}: the recordings do not tell it. It changes the motion too "
            "little.</li>",
            range.label, name);
      } else if (range.certainty->IsHardlyTold()) {
        items += fmt::format(
            "<li><b>{}</b> of {}: other parameters together can do {:.0f} % of what it does to "
            "the motion.</li>",
            range.label, name, 100 * range.certainty->shared);
      }
    }
  }
  return items;
}

std::string FormatAlike(const Diagnosis& diagnosis) {
  std::string items;
  for (const EffectCandidate* candidate : ConfoundedCandidates(diagnosis)) {
    items += fmt::format(
        "<li><b>{}</b> instead of {}: {}. Its error on held-back frames is {} mm, within one "
        "standard error of the best.</li>",
        SpacedName(candidate->name), SpacedName(diagnosis.effects[0].name),
        PictureOf(diagnosis, candidate->values).lacks, InMm(candidate->refit->held));
  }
  return items;
}

}  // namespace

std::string FormatAnswer(const Diagnosis& diagnosis) {
  if (diagnosis.effects.empty()) return AnswerWithoutEffects(diagnosis);
  std::vector<std::string> found;
  for (std::size_t n = 0; n < diagnosis.effects.size(); ++n) {
    found.push_back(DescribeEffect(diagnosis, n));
  }
  return fmt::format(
      "The twin lacks {}; with {} the error on held-back frames falls from {} to {} mm (noise "
      "alone makes {} mm).",
      List(found), found.size() == 1 ? "it" : "them", InMm(diagnosis.before.held),
      InMm(diagnosis.after.held), InMm(diagnosis.noise_floor));
}

std::string FormatDoubts(const Diagnosis& diagnosis) {
  std::string html;
  const auto add = [&](const std::string& text) { html += "<li>" + text + "</li>\n"; };
  const std::vector<std::string> names = Confounded(diagnosis);
  if (!names.empty()) {
    add(fmt::format("{} would explain these recordings as well.", List(SpacedNames(names))));
  }
  const std::vector<std::string> edges = EdgesReached(diagnosis);
  if (!edges.empty()) {
    add(fmt::format("At the edge of what was searched: {}. The truth may lie beyond.",
                    List(edges)));
  }
  const std::vector<std::string> amounts = AmountsHardlyTold(diagnosis);
  if (!amounts.empty()) {
    add(fmt::format("Other parameters could stand for {} in part; see below.", List(amounts)));
  }
  if (diagnosis.unexplained) {
    add(DescribeLeft(diagnosis));
    if (!diagnosis.effects.empty()) {
      add("So the model lacks more than what was found, and the intervals are too narrow.");
    }
  }
  return html.empty() ? "" : "<ul class=\"doubts\">\n" + html + "</ul>\n";
}

std::string FormatConfounding(const Diagnosis& diagnosis) {
  if (diagnosis.effects.empty()) return "";
  const std::string items = FormatAlike(diagnosis) + FormatUntold(diagnosis);
  std::string html = "<h2>What these recordings cannot tell apart</h2>\n";
  if (items.empty()) {
    return html +
           "<p>No other effect on the list predicts the held-back frames as well, and each "
           "value does something to the motion that no other can.</p>\n";
  }
  return html + "<ul>" + items +
         "</ul>\n<p class=\"note\">Two causes are confounded where both move the measured points "
         "alike in all recordings that were given. A recording in which they differ tells them "
         "apart: another grasp, another speed, a body that hangs instead of lying.</p>\n";
}

}  // namespace physpring
