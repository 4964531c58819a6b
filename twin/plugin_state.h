// SPDX-License-Identifier: Apache-2.0
// What mjData.plugin_state holds of a level that the plugin physpring.springs moves. That of
// physpring.contact is `poses` alone.
#ifndef PHYSPRING_TWIN_PLUGIN_STATE_H_
#define PHYSPRING_TWIN_PLUGIN_STATE_H_

namespace physpring {

// Its parts, in this order. After a reset all are 0 but those that release.
struct PluginState {
  double* released;       // (controllers) set by the user: 0 = it holds
  double* were_released;  // (controllers) in the step before
  double* lag;            // (nodes, 3) m/s, see plugin/springs.h
  double* controllers;    // (controllers, 3) where they were in the step before, m
  double* known;          // (1) 0: there was no step before
  // Where mocap bodies that have geoms were in the step before: 1 or, if there was none, 0, then a
  // place, m, and a quaternion for each (plugin/mocap_motion.h). No numbers without such bodies.
  double* poses;
  // The effects' internal variables, then the shift of the rest length of each spring of a
  // controller, m, in the order of the springs (twin/grasp_springs.h). Both are filled up to
  // eights.
  double* internal;

  // `pose_count`: how many numbers `poses` has. Needed for what stands behind them alone.
  PluginState(double* state, int nodes, int controller_count, int pose_count = 0)
      : released(state),
        were_released(released + controller_count),
        lag(were_released + controller_count),
        controllers(lag + 3 * nodes),
        known(controllers + 3 * controller_count),
        poses(known + 1),
        internal(poses + pose_count) {}

  // How many numbers stand before the last two parts.
  static constexpr int PlainSize(int nodes, int controller_count) {
    return 3 * nodes + 5 * controller_count + 1;
  }
};

}  // namespace physpring

#endif  // PHYSPRING_TWIN_PLUGIN_STATE_H_
