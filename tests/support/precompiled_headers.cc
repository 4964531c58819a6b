// SPDX-License-Identifier: Apache-2.0
// Nothing: the headers that the tests have in common are compiled with it, once (CMakeLists.txt).
