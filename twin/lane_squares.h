// SPDX-License-Identifier: Apache-2.0
// Squares of numbers whose rows become columns: how numbers of single rollouts come to stand side
// by side, and back. With AVX, which is enough where AVX-512 counts, too. `Tag` is a type of an
// anonymous namespace (spring_law.h says why).
#ifndef PHYSPRING_TWIN_LANE_SQUARES_H_
#define PHYSPRING_TWIN_LANE_SQUARES_H_

#include <immintrin.h>

namespace physpring {

template <class Tag>
struct FloatSquare {
  static constexpr int kSize = 8;
  __m256 row[kSize];

  void Load(const float* from, int i) { row[i] = _mm256_loadu_ps(from); }
  void Store(float* to, int i) const { _mm256_storeu_ps(to, row[i]); }
  void Transpose() {
    __m256 pair[8], four[8];
    for (int i = 0; i < 8; i += 2) {
      pair[i] = _mm256_unpacklo_ps(row[i], row[i + 1]);
      pair[i + 1] = _mm256_unpackhi_ps(row[i], row[i + 1]);
    }
    for (int i = 0; i < 8; i += 4) {
      for (int k = 0; k < 2; ++k) {
        four[i + 2 * k] = _mm256_shuffle_ps(pair[i + k], pair[i + k + 2], 0x44);
        four[i + 2 * k + 1] = _mm256_shuffle_ps(pair[i + k], pair[i + k + 2], 0xEE);
      }
    }
    for (int i = 0; i < 4; ++i) {
      row[i] = _mm256_permute2f128_ps(four[i], four[i + 4], 0x20);
      row[i + 4] = _mm256_permute2f128_ps(four[i], four[i + 4], 0x31);
    }
  }
};

template <class Tag>
struct DoubleSquare {
  static constexpr int kSize = 4;
  __m256d row[kSize];

  void Load(const double* from, int i) { row[i] = _mm256_loadu_pd(from); }
  void Store(double* to, int i) const { _mm256_storeu_pd(to, row[i]); }
  void Transpose() {
    const __m256d low01 = _mm256_unpacklo_pd(row[0], row[1]);
    const __m256d low23 = _mm256_unpacklo_pd(row[2], row[3]);
    const __m256d high01 = _mm256_unpackhi_pd(row[0], row[1]);
    const __m256d high23 = _mm256_unpackhi_pd(row[2], row[3]);
    row[0] = _mm256_permute2f128_pd(low01, low23, 0x20);
    row[1] = _mm256_permute2f128_pd(high01, high23, 0x20);
    row[2] = _mm256_permute2f128_pd(low01, low23, 0x31);
    row[3] = _mm256_permute2f128_pd(high01, high23, 0x31);
  }
};

}  // namespace physpring

#endif  // PHYSPRING_TWIN_LANE_SQUARES_H_
