// SPDX-License-Identifier: Apache-2.0
// The attributes of the plugins' instances: lines of NAME=VALUE, as MuJoCo would hand them over
// from <config>. The model is compiled once; each input replaces what it holds of attributes.
#include <mujoco/mujoco.h>

#include <map>
#include <stdexcept>

#include "plugin/contact.h"
#include "plugin/force.h"
#include "plugin/host.h"
#include "plugin/springs.h"
#include "tests/fuzz/fuzz_target.h"

namespace physpring {
namespace {

constexpr const char* kScene = R"(
<mujoco>
  <option timestep="0.001"/>
  <extension>
    <plugin plugin="physpring.springs">
      <instance name="s">
        <config key="springs" value="0 1 1 2 2 3"/>
        <config key="stiffness" value="100"/>
        <config key="rest_length" value="0.1"/>
        <config key="dashpot" value="0.1"/>
      </instance>
    </plugin>
    <plugin plugin="physpring.contact"><instance name="c"/></plugin>
    <plugin plugin="physpring.force">
      <instance name="f"><config key="nodes" value="3"/></instance>
    </plugin>
  </extension>
  <worldbody>
    <body name="parent"><plugin instance="s"/>
      <body pos="0.1 0 0">
        <joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 1 0"/>
        <joint type="slide" axis="0 0 1"/><geom size="0.01" mass="0.1"/>
      </body>
      <body pos="0.2 0 0">
        <joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 1 0"/>
        <joint type="slide" axis="0 0 1"/><geom size="0.01" mass="0.1"/>
      </body>
      <body pos="0.3 0.02 0">
        <joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 1 0"/>
        <joint type="slide" axis="0 0 1"/><geom size="0.01" mass="0.1"/>
      </body>
    </body>
    <body mocap="true"><plugin instance="s"/></body>
    <body><plugin instance="c"/>
      <body pos="0.1 1 0">
        <joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 1 0"/>
        <joint type="slide" axis="0 0 1"/><geom size="0.01" mass="0.1"/>
      </body>
    </body>
  </worldbody>
  <sensor><plugin instance="f" objtype="body" objname="parent"/></sensor>
</mujoco>)";

const mjModel& Model() {
  static const mjModel* const model = [] {
    char error[1000] = "";
    mjSpec* const spec = mj_parseXMLString(kScene, nullptr, error, sizeof error);
    mjModel* const compiled = spec ? mj_compile(spec, nullptr) : nullptr;
    if (!compiled) throw std::logic_error(spec ? mjs_getError(spec) : error);
    mj_deleteSpec(spec);
    return compiled;
  }();
  return *model;
}

std::map<std::string, std::string> Lines(std::string_view text) {
  std::map<std::string, std::string> lines;
  while (!text.empty()) {
    const std::string_view line = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(line.size() + 1, text.size()));
    const std::size_t equals = std::min(line.find('='), line.size());
    std::string value(line.substr(std::min(equals + 1, line.size())));
    value.resize(value.find('\0') == std::string::npos ? value.size() : value.find('\0'));
    lines.emplace(line.substr(0, equals), value);
  }
  return lines;
}

template <class Plugin>
void Make(const std::map<std::string, std::string>& lines, int instance, const char* where) {
  std::string attributes;  // each ends with a zero
  for (const char* name : Plugin::AttributeNames()) {
    const auto line = lines.find(name);
    attributes.append(line == lines.end() ? "" : line->second).push_back('\0');
  }
  mjModel model = Model();  // its arrays are shared, but those that are set here
  std::vector<int> addresses(3, 0), sizes(3, 0);
  model.plugin_attr = attributes.data();
  model.npluginattr = static_cast<mjtSize>(attributes.size());
  model.plugin_attradr = addresses.data();
  model.plugin_statenum = sizes.data();
  sizes[static_cast<std::size_t>(instance)] = Plugin::StateSize(&model, instance);
  MayRefuse(where, [&] { Plugin(&model, instance); });
}

}  // namespace

bool FindHost() { return true; }  // this program is linked with MuJoCo

}  // namespace physpring

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace physpring;
  const std::map<std::string, std::string> lines = Lines(TextOf(data, size));
  Make<Springs>(lines, 0, "physpring.springs 's': ");
  Make<LevelContact>(lines, 1, "physpring.contact 'c': ");
  Make<ForceSensor>(lines, 2, "physpring.force 'f': ");
  return 0;
}

std::vector<std::string> physpring::FuzzSeeds() {
  const std::string springs =
      "nodes=3\ncontrollers=1\nsprings=0 1 1 2 2 3\nstiffness=100 90 80\nrest_length=0.1\n"
      "dashpot=0.1\ndrag=1\nsubstep=0.0001\ncontroller_velocity=1\ncollision_distance=0.01\n";
  return {springs + "order=0 0.1 0.2 0.3\neffects=[{\"name\":\"bending\",\"parameters\":{}}]\n",
          springs +
              "order=0 0.1 0.2 0.3\nrod=0 1 1 2 1 3\neffects=[{\"name\":\"bending\",\"parameters\":"
              "{\"flexural_rigidity_n_m2\":0.01}}]\n",
          springs + "effects=[{\"name\":\"tension_only\",\"parameters\":{\"slack_share\":0.3}}]\n",
          springs +
              "friction=0.5\nrestitution=0.1\nobject_friction=1\nobject_restitution=0.2\n"
              "contact_radius=0.01\ncone=pyramidal\n"};
}
