// SPDX-License-Identifier: Apache-2.0
// The force of a spring and dashpot e = (a, b), and its adjoint, on one spring or on several at
// once (one in each lane of a vector register):
//   d = x_a - x_b,  l = |d|,  n = d / l,  u = v_a - v_b
//   F = k (l - L) + c (u . n) + T,   force on b: F n,   force on a: -F n
// T is what effects add; it depends on l and u . n.
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
  V T = -V{};                  // -0: x + -0 is x, bit for bit
  V length_bar{}, rate_bar{};  // d loss / d l and rate through T

  // Set by Evaluate.
  V length;
  V inverse;  // 1 / l, or 0 if l < kShortest
  V rate;     // u . n, of change of the length
  V stretch;  // l - L
  V scale;    // F / l: the force on b is scale d

  // Set by Differentiate: the derivatives with respect to the state of b are
  //   x_bar = along d + scale w + damping u,   v_bar = damping d
  // and those with respect to the state of a are opposite.
  V along, damping;

  static V Dot(const V* p, const V* q) { return p[0] * q[0] + p[1] * q[1] + p[2] * q[2]; }

  // From d . d and d . u.
  void Evaluate(V d_d, V d_u) {
    const V l = Lanes::Sqrt(d_d);
    Evaluate(l, Lanes::Inverse(l), d_u);
  }
  // The same from l, 1 / l (or 0) and d . u.
  void Evaluate(V l, V inverse_of_l, V d_u) {
    length = l;
    inverse = inverse_of_l;
    rate = d_u * inverse;
    stretch = length - L;
    scale = (k * stretch + c * rate + T) * inverse;
  }

  // d loss / d F, after Evaluate: with w = force_bar_a - force_bar_b the loss is -F (n . w).
  V TensionBar(V d_w) const { return -(d_w * inverse); }

  // Adjoint of the force, after Evaluate: with w = force_bar_a - force_bar_b the loss is
  // -scale d . w. Adds to the derivatives with respect to the parameters.
  void Differentiate(V d_w, V* k_bar, V* L_bar, V* c_bar) {
    // loss = -F (n . w):  F_bar = -pull
    const V pull = d_w * inverse;
    // forward: F = k stretch + c rate + T
    *k_bar -= pull * stretch;
    *L_bar += pull * k;
    *c_bar -= pull * rate;
    // x_bar = n (k pull - length_bar) + (I - n n^T) (F w + (c pull - rate_bar) u) / l,  d = l n
    damping = (pull * c - rate_bar) * inverse;
    along = (pull * (k - scale) - length_bar - damping * rate) * inverse;
  }
};

}  // namespace physpring

#endif  // PHYSPRING_TWIN_SPRING_LAW_H_
