// SPDX-License-Identifier: Apache-2.0
// Real spherical harmonics up to degree 3, in the order and with the signs of the reference
// implementation of Gaussian splatting: the colour of a splat depends on the direction it is seen
// in.
#ifndef PHYSPRING_SPLATS_HARMONICS_H_
#define PHYSPRING_SPLATS_HARMONICS_H_

#include <Eigen/Core>

#include "splats/splats.h"

namespace physpring {

// The first HarmonicCount(degree) of them in the direction of the unit vector `d`.
template <class Real>
void Harmonics(int degree, const Eigen::Matrix<Real, 3, 1>& d, Real* values) {
  const Real x = d[0], y = d[1], z = d[2];
  values[0] = Real(0.28209479177387814);
  if (degree < 1) return;
  constexpr Real k1 = Real(0.4886025119029199);
  values[1] = -k1 * y;
  values[2] = k1 * z;
  values[3] = -k1 * x;
  if (degree < 2) return;
  const Real xx = x * x, yy = y * y, zz = z * z;
  values[4] = Real(1.0925484305920792) * x * y;
  values[5] = Real(-1.0925484305920792) * y * z;
  values[6] = Real(0.31539156525252005) * (2 * zz - xx - yy);
  values[7] = Real(-1.0925484305920792) * x * z;
  values[8] = Real(0.5462742152960396) * (xx - yy);
  if (degree < 3) return;
  values[9] = Real(-0.5900435899266435) * y * (3 * xx - yy);
  values[10] = Real(2.890611442640554) * x * y * z;
  values[11] = Real(-0.4570457994644658) * y * (4 * zz - xx - yy);
  values[12] = Real(0.3731763325901154) * z * (2 * zz - 3 * xx - 3 * yy);
  values[13] = Real(-0.4570457994644658) * x * (4 * zz - xx - yy);
  values[14] = Real(1.445305721320277) * z * (xx - yy);
  values[15] = Real(-0.5900435899266435) * x * (xx - 3 * yy);
}

}  // namespace physpring

#endif  // PHYSPRING_SPLATS_HARMONICS_H_
