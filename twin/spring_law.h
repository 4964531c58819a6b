// SPDX-License-Identifier: Apache-2.0
// The force of a spring and dashpot e = (a, b), and its adjoint, on one spring or on several at
// once (one in each lane of a vector register):
//   d = x_a - x_b,  l = |d|,  n = d / l,  u = v_a - v_b
//   F = k (l - L) + c (u . n),   force on b: F n,   force on a: -F n
//
// `Lanes` says what a V is (a number, or a vector of numbers) and gives Sqrt and Inverse. It must
// be a type of an anonymous namespace: then what is compiled from this header for one instruction
// set never stands in for what is compiled for another.
#ifndef PHYSPRING_TWIN_SPRING_LAW_H_
#define PHYSPRING_TWIN_SPRING_LAW_H_

namespace physpring {

// Shorter than this a spring has no direction, no force, and no derivatives [m]: Lanes::Inverse(l)
// is 1 / l from here on and 0 below.
inline constexpr double kShortest = 1e-9;

template <class Lanes>
struct SpringLaw {
  using V = typename Lanes::V;
  V k, L, c;
  V d[3], u[3];

  // Set by Evaluate.
  V inverse;  // 1 / l, or 0 if l < kShortest
  V rate;     // u . n, of change of the length
  V stretch;  // l - L
  V scale;    // F / l: the force on b is scale d

  static V Dot(const V* p, const V* q) { return p[0] * q[0] + p[1] * q[1] + p[2] * q[2]; }

  void Evaluate() {
    const V length = Lanes::Sqrt(Dot(d, d));
    inverse = Lanes::Inverse(length);
    rate = Dot(d, u) * inverse;
    stretch = length - L;
    scale = (k * stretch + c * rate) * inverse;
  }

  // Adjoint of the force, after Evaluate: with w = force_bar_a - force_bar_b the loss is
  // -scale d . w. Adds to k_bar, L_bar, c_bar; x_bar and v_bar are the derivatives with respect to
  // the state of b; those with respect to the state of a are opposite.
  void Differentiate(const V* w, V* k_bar, V* L_bar, V* c_bar, V* x_bar, V* v_bar) const {
    // loss = -F (n . w):  F_bar = -pull
    const V pull = Dot(d, w) * inverse;
    // forward: F = k stretch + c rate
    *k_bar -= pull * stretch;
    *L_bar += pull * k;
    *c_bar -= pull * rate;
    // n (k F_bar) + (I - n n^T) (F w + c F_bar u) / l, in terms of d = l n
    const V damping = pull * c * inverse;
    const V along = (pull * (k - scale) - damping * rate) * inverse;
    for (int j = 0; j < 3; ++j) {
      x_bar[j] = along * d[j] + scale * w[j] + damping * u[j];
      v_bar[j] = damping * d[j];
    }
  }
};

}  // namespace physpring

#endif  // PHYSPRING_TWIN_SPRING_LAW_H_
