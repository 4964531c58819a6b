// SPDX-License-Identifier: Apache-2.0
// The objects of this library that MuJoCo keeps for the instances of its plugins.
#ifndef PHYSPRING_PLUGIN_INSTANCE_H_
#define PHYSPRING_PLUGIN_INSTANCE_H_

#include <mujoco/mujoco.h>

#include <string_view>

namespace physpring {

// Whether an instance is one of this plugin. All plugins of the library are registered, or none, so
// that what bears its name is of this library.
template <class Plugin>
bool IsOf(const mjModel* model, int instance) {
  return mjp_getPluginAtSlot(model->plugin[instance])->name == std::string_view(Plugin::kName);
}

// Null where the instance was not made yet, or could not be. It must be one of this plugin.
template <class Plugin>
Plugin* InstanceOf(const mjData* data, int instance) {
  // MuJoCo keeps a plugin's data as an integer. NOLINTNEXTLINE(performance-no-int-to-ptr)
  return reinterpret_cast<Plugin*>(data->plugin_data[instance]);
}

}  // namespace physpring

#endif  // PHYSPRING_PLUGIN_INSTANCE_H_
