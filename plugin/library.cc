// SPDX-License-Identifier: Apache-2.0
// The plugin library: registers its plugins with MuJoCo when it is loaded. Callbacks forward to an
// object a plugin instance and mjData; no exception leaves them.
#include <mujoco/mujoco.h>

#include <algorithm>
#include <exception>

#include "plugin/contact.h"
#include "plugin/force.h"
#include "plugin/host.h"
#include "plugin/instance.h"
#include "plugin/springs.h"

namespace physpring {
namespace {

template <class Plugin>
void Destroy(mjData* data, int instance) {
  delete InstanceOf<Plugin>(data, instance);
  data->plugin_data[instance] = 0;
}

template <class Plugin>
int Init(const mjModel* model, mjData* data, int instance) {
  try {
    data->plugin_data[instance] = reinterpret_cast<uintptr_t>(new Plugin(model, instance));
    return 0;
  } catch (const std::exception& error) {
    mju_warning("%s", error.what());
    return -1;
  }
}

// The data of `to` may be of a model compiled anew.
template <class Plugin>
void Copy(mjData* to, const mjModel*, const mjData* from, int instance) {
  if (to == from) return;
  Destroy<Plugin>(to, instance);
  to->plugin_data[instance] =
      reinterpret_cast<uintptr_t>(new Plugin(*InstanceOf<Plugin>(from, instance)));
}

template <class Plugin>
void Reset(const mjModel* model, mjtNum* state, void* plugin, int instance) {
  static_cast<const Plugin*>(plugin)->Reset(model->plugin_statenum[instance], state);
}

template <class Plugin>
void Compute(const mjModel* model, mjData* data, int instance, int) {
  try {
    InstanceOf<Plugin>(data, instance)->Compute(model, data, instance);
  } catch (const std::exception& error) {
    mju_warning("%s: %s", Plugin::kName, error.what());
  }
}

// What all plugins of the library have.
template <class Plugin>
mjpPlugin Describe(mjtPluginCapabilityBit capability) {
  mjpPlugin plugin;
  mjp_defaultPlugin(&plugin);
  plugin.name = Plugin::kName;
  plugin.capabilityflags = capability;
  plugin.nattribute = static_cast<int>(Plugin::AttributeNames().size());
  plugin.attributes = Plugin::AttributeNames().data();
  plugin.nstate = Plugin::StateSize;
  plugin.init = Init<Plugin>;
  plugin.destroy = Destroy<Plugin>;
  plugin.copy = Copy<Plugin>;
  plugin.reset = Reset<Plugin>;
  plugin.compute = Compute<Plugin>;
  plugin.advance = [](const mjModel* model, mjData* data, int instance) {
    InstanceOf<Plugin>(data, instance)->Advance(model, data, instance);
  };
  return plugin;
}

mjPLUGIN_LIB_INIT(physpring) {
  if (!FindHost()) return;
  mjpPlugin force = Describe<ForceSensor>(mjPLUGIN_SENSOR);
  force.nsensordata = ForceSensor::SensorSize;
  force.needstage = mjSTAGE_ACC;
  const mjpPlugin plugins[] = {Describe<Springs>(mjPLUGIN_PASSIVE),
                               Describe<LevelContact>(mjPLUGIN_PASSIVE), force};
  // all or none, because the sensors read the objects of the others
  for (const mjpPlugin& plugin : plugins) {
    int slot = 0;
    if (!mjp_getPlugin(plugin.name, &slot)) continue;
    mju_warning("physpring: %s is loaded already, from another file, which stays", plugin.name);
    return;
  }
  for (const mjpPlugin& plugin : plugins) mjp_registerPlugin(&plugin);
}

}  // namespace
}  // namespace physpring
