// SPDX-License-Identifier: Apache-2.0
#include "report/diagnosis/mjcf_lines.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <vector>

#include "report/picture/escape.h"
#include "twin/effects/effect_json.h"
#include "twin/effects/registry.h"

namespace physpring {
namespace {

constexpr std::size_t kMostLines = 4;

std::string Vector(const Eigen::Vector3d& v) {
  return fmt::format("{:.6g} {:.6g} {:.6g}", v[0], v[1], v[2]);
}

// Entries that changed, the one that changed most first.
std::vector<Eigen::Index> ChangedMost(const Eigen::VectorXd& before, const Eigen::VectorXd& after) {
  const Eigen::VectorXd change = (after - before).cwiseAbs();
  std::vector<Eigen::Index> order(static_cast<std::size_t>(change.size()));
  std::iota(order.begin(), order.end(), 0);
  std::erase_if(order, [&](Eigen::Index i) { return change[i] == 0; });
  std::stable_sort(order.begin(), order.end(),
                   [&](Eigen::Index a, Eigen::Index b) { return change[a] > change[b]; });
  return order;
}

// What the effect changed of the setting, which an exported model has.
std::vector<std::string> SettingLines(const Setting& before, const Setting& after) {
  std::vector<std::string> lines;
  if (before.gravity != after.gravity) {
    lines.push_back(fmt::format("<option gravity=\"{}\"/>", Vector(after.gravity)));
  }
  const SpringMassSystem &p = before.system, &q = after.system;
  for (const Eigen::Index i : ChangedMost(p.mass, q.mass)) {
    lines.push_back(fmt::format("<inertial mass=\"{:.4g}\" .../>  <!-- node {}, was {:.4g} -->",
                                q.mass[i], i, p.mass[i]));
  }
  for (const Eigen::Index e : ChangedMost(p.rest_length, q.rest_length)) {
    lines.push_back(
        fmt::format("<spatial springlength=\"{:.4g}\" .../>  <!-- spring {}, was {:.4g} -->",
                    q.rest_length[e], e, p.rest_length[e]));
  }
  const ContactPair<double>&was = p.contact.surface, &is = q.contact.surface;
  if (was.friction != is.friction) {
    lines.push_back(fmt::format("<geom friction=\"{:.4g} 0 0\" .../>  <!-- was {:.4g} -->",
                                is.friction, was.friction));
  }
  for (const auto& c : kContactCoefficients<double>) {
    if (was.*c.member == is.*c.member || c.member == &ContactPair<double>::friction) continue;
    lines.push_back(fmt::format("<config key=\"{}\" value=\"{:.4g}\"/>  <!-- was {:.4g} -->",
                                c.name, is.*c.member, was.*c.member));
  }
  return lines;
}

std::vector<std::string> TendonLines(const EffectMjcf& mjcf) {
  std::vector<std::string> lines;
  for (std::size_t e = 0; e < mjcf.tendon.size(); ++e) {
    std::string attributes;
    for (const auto& [name, value] : mjcf.tendon[e]) {
      attributes += fmt::format(" {}=\"{}\"", name, value);
    }
    lines.push_back(fmt::format("<spatial{} ...>  <!-- spring {} -->", attributes, e));
  }
  return lines;
}

std::vector<std::string> AnchorLines(const EffectMjcf& mjcf) {
  std::vector<std::string> lines;
  for (const EffectMjcf::Anchor& anchor : mjcf.anchors) {
    if (lines.empty()) {
      lines.push_back(fmt::format("<site name=\"anchor\" pos=\"{}\"/>", Vector(anchor.place)));
    }
    lines.push_back(
        fmt::format("<spatial springlength=\"0\" stiffness=\"{:.4g}\" damping=\"{:.4g}\">  <!-- "
                    "from node {} to the anchor -->",
                    anchor.stiffness, anchor.damping, anchor.node));
  }
  return lines;
}

std::string Preformatted(const std::vector<std::string>& lines) {
  std::string html = "<pre>";
  for (std::size_t i = 0; i < std::min(kMostLines, lines.size()); ++i) {
    html += Escape(lines[i]) + "\n";
  }
  if (lines.size() > kMostLines) {
    html += Escape(fmt::format("<!-- and {} more -->\n", lines.size() - kMostLines));
  }
  return html + "</pre>\n";
}

}  // namespace

std::string FormatMjcfLines(const EffectValues& effect, const Twin& twin) {
  const Effect& law = GetEffect(effect.name);
  const Setting before{twin.levels[0].system, twin.gravity};
  const EffectMjcf mjcf = law.Mjcf(effect.values, before.system);
  std::string text;
  std::vector<std::string> lines;
  switch (mjcf.carrier) {
    case EffectMjcf::Carrier::kSetting: {
      text = "MuJoCo's own numbers carry it; an export writes them";
      Setting after = before;
      law.Change(effect.values, &after);
      lines = SettingLines(before, after);
      break;
    }
    case EffectMjcf::Carrier::kTendon:
      text = "The tendons of the springs carry it";
      lines = TendonLines(mjcf);
      break;
    case EffectMjcf::Carrier::kAnchor:
      text = "Tendons to a site of the world carry it";
      lines = AnchorLines(mjcf);
      break;
    case EffectMjcf::Carrier::kPlugin:
      text = "Only the plugin carries it";
      lines = {fmt::format("<config key=\"effects\" value='{}'/>", EffectsToJson({effect}))};
      break;
  }
  if (!mjcf.difference.empty()) text += ": " + mjcf.difference;
  return fmt::format("<h3>In MuJoCo</h3>\n<p>{}.</p>\n{}", Escape(text), Preformatted(lines));
}

}  // namespace physpring
