// SPDX-License-Identifier: Apache-2.0
// The MuJoCo of the program that has loaded the plugin library. The library is not linked with one:
// a wheel of MuJoCo has its version in the file name of libmujoco, so such a library would load in
// one version only, and make `import mujoco` fail in the others. So the functions that the plugin
// calls are looked up here.
#ifndef PHYSPRING_PLUGIN_HOST_H_
#define PHYSPRING_PLUGIN_HOST_H_

namespace physpring {

// Finds MuJoCo's functions. To be called before any of them. False, after one line that says why,
// if no MuJoCo is loaded, or one whose version differs in more than the last number: patches keep
// mjModel and mjData as they are.
bool FindHost();

}  // namespace physpring

#endif  // PHYSPRING_PLUGIN_HOST_H_
