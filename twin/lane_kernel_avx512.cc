// SPDX-License-Identifier: Apache-2.0
// Rollouts side by side with AVX-512: 16 in float, 8 in double. This file is compiled with
// -mavx512f -mavx512dq -mavx512vl.
#include <immintrin.h>

#include "twin/instruction_sets.h"
#include "twin/lane_kernel_vector.h"
#include "twin/lane_squares.h"

namespace physpring {
namespace {

// Roots are taken with a mask of all lanes: of those without a mask g++ 12 believes that they read
// what was never set.
struct SixteenFloats {
  static constexpr const char* kName = "avx512";
  using Real = float;
  using V = __m512;
  using Square = FloatSquare<SixteenFloats>;
  static constexpr int kLanes = 16;
  static constexpr double kTime = 6.5;

  static V Sqrt(V x) { return _mm512_maskz_sqrt_ps(0xFFFF, x); }
  static V Inverse(V length) {
    const V shortest = Set(static_cast<float>(kShortest));
    return _mm512_maskz_div_ps(_mm512_cmp_ps_mask(length, shortest, _CMP_GE_OQ), Set(1), length);
  }
  static V Load(const float* p) { return _mm512_loadu_ps(p); }
  static void Store(V x, float* p) { _mm512_storeu_ps(p, x); }
  static V Set(float value) { return _mm512_set1_ps(value); }
  static unsigned Less(V x, V y) { return _mm512_cmp_ps_mask(x, y, _CMP_LT_OQ); }
};

struct EightDoubles {
  static constexpr const char* kName = "avx512";
  using Real = double;
  using V = __m512d;
  using Square = DoubleSquare<EightDoubles>;
  static constexpr int kLanes = 8;
  static constexpr double kTime = 5;

  static V Sqrt(V x) { return _mm512_maskz_sqrt_pd(0xFF, x); }
  static V Inverse(V length) {
    const __mmask8 has_direction = _mm512_cmp_pd_mask(length, Set(kShortest), _CMP_GE_OQ);
    return _mm512_maskz_div_pd(has_direction, Set(1), length);
  }
  static V Load(const double* p) { return _mm512_loadu_pd(p); }
  static void Store(V x, double* p) { _mm512_storeu_pd(p, x); }
  static V Set(double value) { return _mm512_set1_pd(value); }
  static unsigned Less(V x, V y) { return _mm512_cmp_pd_mask(x, y, _CMP_LT_OQ); }
};

}  // namespace

template <>
const LaneKernel<float>& Avx512LaneKernel() {
  return LaneVectorKernel<SixteenFloats>::kKernel;
}
template <>
const LaneKernel<double>& Avx512LaneKernel() {
  return LaneVectorKernel<EightDoubles>::kKernel;
}

}  // namespace physpring
