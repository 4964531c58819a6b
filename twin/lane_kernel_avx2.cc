// SPDX-License-Identifier: Apache-2.0
// Rollouts side by side with AVX2: 8 in float, 4 in double. This file is compiled with -mavx2.
#include <immintrin.h>

#include "twin/instruction_sets.h"
#include "twin/lane_kernel_vector.h"
#include "twin/lane_squares.h"

namespace physpring {
namespace {

struct EightFloats {
  static constexpr const char* kName = "avx2";
  using Real = float;
  using V = __m256;
  using Square = FloatSquare<EightFloats>;
  static constexpr int kLanes = 8;
  static constexpr double kTime = 4.5;

  static V Sqrt(V x) { return _mm256_sqrt_ps(x); }
  static V Inverse(V length) {
    const V shortest = Set(static_cast<float>(kShortest));
    return _mm256_and_ps(_mm256_cmp_ps(length, shortest, _CMP_GE_OQ), Set(1) / length);
  }
  static V Load(const float* p) { return _mm256_loadu_ps(p); }
  static void Store(V x, float* p) { _mm256_storeu_ps(p, x); }
  static V Set(float value) { return _mm256_set1_ps(value); }
  static unsigned Less(V x, V y) {
    return static_cast<unsigned>(_mm256_movemask_ps(_mm256_cmp_ps(x, y, _CMP_LT_OQ)));
  }
};

struct FourDoubles {
  static constexpr const char* kName = "avx2";
  using Real = double;
  using V = __m256d;
  using Square = DoubleSquare<FourDoubles>;
  static constexpr int kLanes = 4;
  static constexpr double kTime = 3;

  static V Sqrt(V x) { return _mm256_sqrt_pd(x); }
  static V Inverse(V length) {
    return _mm256_and_pd(_mm256_cmp_pd(length, Set(kShortest), _CMP_GE_OQ), Set(1) / length);
  }
  static V Load(const double* p) { return _mm256_loadu_pd(p); }
  static void Store(V x, double* p) { _mm256_storeu_pd(p, x); }
  static V Set(double value) { return _mm256_set1_pd(value); }
  static unsigned Less(V x, V y) {
    return static_cast<unsigned>(_mm256_movemask_pd(_mm256_cmp_pd(x, y, _CMP_LT_OQ)));
  }
};

}  // namespace

template <>
const LaneKernel<float>& Avx2LaneKernel() {
  return LaneVectorKernel<EightFloats>::kKernel;
}
template <>
const LaneKernel<double>& Avx2LaneKernel() {
  return LaneVectorKernel<FourDoubles>::kKernel;
}

}  // namespace physpring
