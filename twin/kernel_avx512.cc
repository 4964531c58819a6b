// SPDX-License-Identifier: Apache-2.0
// The kernel for AVX-512: 16 springs (four blocks) at a time in float, 8 (two blocks) in double.
// This file is compiled with -mavx512f -mavx512dq -mavx512vl.
#include <immintrin.h>

#include "twin/instruction_sets.h"
#include "twin/kernel_vector.h"

namespace physpring {
namespace {

// Masked operations with all lanes: of those without a mask g++ 12 believes that they read what was
// never set.
struct Float {
  static constexpr const char* kName = "avx512";
  using Real = float;
  using V = __m512;
  using Quad = __m128;
  using Node = __m256;
  static constexpr int kBlocks = 4;

  static V Sqrt(V x) { return _mm512_maskz_sqrt_ps(0xFFFF, x); }
  static V Inverse(V length) {
    const V shortest = _mm512_set1_ps(static_cast<float>(kShortest));
    return _mm512_maskz_div_ps(_mm512_cmp_ps_mask(length, shortest, _CMP_GE_OQ), _mm512_set1_ps(1),
                               length);
  }
  static V Load(const float* p) { return _mm512_loadu_ps(p); }
  static void Store(V x, float* p) { _mm512_storeu_ps(p, x); }
  static Quad SetQuad(float value) { return _mm_set1_ps(value); }
  static Quad LoadQuad(const float* p) { return _mm_load_ps(p); }
  static void StoreQuad(Quad x, float* p) { _mm_store_ps(p, x); }

  // Two records of nodes.
  static V Pair(const NodeState<float>& low, const NodeState<float>& high) {
    const V first = _mm512_castps256_ps512(_mm256_load_ps(low.x));
    return _mm512_insertf32x8(first, _mm256_load_ps(high.x), 1);
  }
  // Four forces.
  static V Four(const NodeForce<float>& f0, const NodeForce<float>& f1, const NodeForce<float>& f2,
                const NodeForce<float>& f3) {
    const Node low = _mm256_set_m128(LoadQuad(f1.f), LoadQuad(f0.f));
    const Node high = _mm256_set_m128(LoadQuad(f3.f), LoadQuad(f2.f));
    return _mm512_insertf32x8(_mm512_castps256_ps512(low), high, 1);
  }
  template <int kChoice>
  static V Shuffle(V x, V y) {
    return _mm512_maskz_shuffle_ps(0xFFFF, x, y, kChoice);
  }
  template <int kChoice>
  static V ShuffleQuarters(V x, V y) {
    return _mm512_maskz_shuffle_f32x4(0xFFFF, x, y, kChoice);
  }
  static V Low(V x, V y) { return _mm512_maskz_unpacklo_ps(0xFFFF, x, y); }
  static V High(V x, V y) { return _mm512_maskz_unpackhi_ps(0xFFFF, x, y); }

  // In each quarter, rows (x y z 0) to columns (x x x x) and so on.
  static void ToColumns(const V (&row)[4], V (&column)[3]) {
    const V low01 = Low(row[0], row[1]), low23 = Low(row[2], row[3]);
    const V high01 = High(row[0], row[1]), high23 = High(row[2], row[3]);
    column[0] = Shuffle<0x44>(low01, low23);
    column[1] = Shuffle<0xEE>(low01, low23);
    column[2] = Shuffle<0x44>(high01, high23);
  }
  static void ToRows(const V (&column)[3], V (&row)[4]) {
    const V zero = _mm512_setzero_ps();
    const V xy01 = Low(column[0], column[1]), xy23 = High(column[0], column[1]);
    const V z01 = Low(column[2], zero), z23 = High(column[2], zero);
    row[0] = Shuffle<0x44>(xy01, z01);
    row[1] = Shuffle<0xEE>(xy01, z01);
    row[2] = Shuffle<0x44>(xy23, z23);
    row[3] = Shuffle<0xEE>(xy23, z23);
  }

  static void Subtract(const NodeState<float>* state, const int* a, const int* b, V* d, V* u) {
    V column[2][3];  // x of a block, v of it, x of the next one, its v
    for (int pair = 0; pair < 2; ++pair) {
      const V shared = Pair(state[a[2 * pair]], state[a[2 * pair + 1]]);
      V row[4];
      for (int s = 0; s < 4; ++s) {
        row[s] = shared - Pair(state[b[8 * pair + s]], state[b[8 * pair + 4 + s]]);
      }
      ToColumns(row, column[pair]);
    }
    for (int j = 0; j < 3; ++j) {
      d[j] = ShuffleQuarters<0x88>(column[0][j], column[1][j]);
      u[j] = ShuffleQuarters<0xDD>(column[0][j], column[1][j]);
    }
  }

  static void Subtract(const NodeForce<float>* force, const int* a, const int* b, V* w) {
    const V shared = Four(force[a[0]], force[a[1]], force[a[2]], force[a[3]]);
    V row[4], column[3];
    for (int s = 0; s < 4; ++s) {
      row[s] = shared - Four(force[b[s]], force[b[4 + s]], force[b[8 + s]], force[b[12 + s]]);
    }
    ToColumns(row, column);
    for (int j = 0; j < 3; ++j) w[j] = column[j];
  }

  // Quarters go by way of memory: one unit alone moves numbers within registers.
  static void AddTo(NodeForce<float>* force, const int* a, const int* b, const V (&value)[3]) {
    V row[4];
    ToRows(value, row);
    alignas(64) float rows[5][16];
    for (int s = 0; s < 4; ++s) _mm512_store_ps(rows[s], row[s]);
    _mm512_store_ps(rows[4], (row[0] + row[1]) + (row[2] + row[3]));
    for (int block = 0; block < 4; ++block) {
      for (int s = 0; s < 4; ++s) {
        float* f = force[b[4 * block + s]].f;
        StoreQuad(LoadQuad(f) + LoadQuad(rows[s] + 4 * block), f);
      }
      float* f = force[a[block]].f;
      StoreQuad(LoadQuad(f) - LoadQuad(rows[4] + 4 * block), f);
    }
  }

  static void AddTo(NodeState<float>* state, const int* a, const int* b, const V (&x)[3],
                    const V (&v)[3]) {
    const __m512i order[2] = {
        _mm512_setr_epi32(0, 1, 2, 3, 16, 17, 18, 19, 4, 5, 6, 7, 20, 21, 22, 23),
        _mm512_setr_epi32(8, 9, 10, 11, 24, 25, 26, 27, 12, 13, 14, 15, 28, 29, 30, 31)};
    for (int pair = 0; pair < 2; ++pair) {
      V column[3], row[4];
      for (int j = 0; j < 3; ++j) column[j] = _mm512_permutex2var_ps(x[j], order[pair], v[j]);
      ToRows(column, row);
      const V sum = -((row[0] + row[1]) + (row[2] + row[3]));
      for (int s = 0; s < 4; ++s) {
        AddTo(&state[b[8 * pair + s]], _mm512_castps512_ps256(row[s]));
      }
      AddTo(&state[a[2 * pair]], _mm512_castps512_ps256(sum));
      for (int s = 0; s < 4; ++s) AddTo(&state[b[8 * pair + 4 + s]], UpperHalf(row[s]));
      AddTo(&state[a[2 * pair + 1]], UpperHalf(sum));
    }
  }
  static Node UpperHalf(V x) { return _mm512_maskz_extractf32x8_ps(0xFF, x, 1); }
  static void AddTo(NodeState<float>* state, Node value) {
    _mm256_store_ps(state->x, _mm256_load_ps(state->x) + value);
  }
};

struct Double {
  static constexpr const char* kName = "avx512";
  using Real = double;
  using V = __m512d;
  using Quad = __m256d;
  static constexpr int kBlocks = 2;

  static V Sqrt(V x) { return _mm512_maskz_sqrt_pd(0xFF, x); }
  static V Inverse(V length) {
    const __mmask8 has_direction =
        _mm512_cmp_pd_mask(length, _mm512_set1_pd(kShortest), _CMP_GE_OQ);
    return _mm512_maskz_div_pd(has_direction, _mm512_set1_pd(1), length);
  }
  static V Load(const double* p) { return _mm512_loadu_pd(p); }
  static void Store(V x, double* p) { _mm512_storeu_pd(p, x); }
  static Quad SetQuad(double value) { return _mm256_set1_pd(value); }
  static Quad LoadQuad(const double* p) { return _mm256_load_pd(p); }
  static void StoreQuad(Quad x, double* p) { _mm256_store_pd(p, x); }

  static V LoadState(const NodeState<double>& node) { return _mm512_load_pd(node.x); }
  static V Pair(const NodeForce<double>& low, const NodeForce<double>& high) {
    return _mm512_insertf64x4(_mm512_castpd256_pd512(LoadQuad(low.f)), LoadQuad(high.f), 1);
  }
  template <int kChoice>
  static V ShuffleQuarters(V x, V y) {
    return _mm512_maskz_shuffle_f64x2(0xFF, x, y, kChoice);
  }
  static V Low(V x, V y) { return _mm512_maskz_unpacklo_pd(0xFF, x, y); }
  static V High(V x, V y) { return _mm512_maskz_unpackhi_pd(0xFF, x, y); }
  // The even quarters of two halves, and the odd ones.
  static V Even(V x, V y) {
    return _mm512_permutex2var_pd(x, _mm512_setr_epi64(0, 1, 8, 9, 4, 5, 12, 13), y);
  }
  static V Odd(V x, V y) {
    return _mm512_permutex2var_pd(x, _mm512_setr_epi64(2, 3, 10, 11, 6, 7, 14, 15), y);
  }

  // Rows (x y z 0 vx vy vz 0) to columns of eight.
  static void Subtract(const NodeState<double>* state, const int* a, const int* b, V* d, V* u) {
    V low[4], high[4];  // of two rows: (x x z z vx vx vz vz), (y y 0 0 vy vy 0 0)
    for (int pair = 0; pair < 4; ++pair) {
      const V shared = LoadState(state[a[pair / 2]]);
      const V row = shared - LoadState(state[b[2 * pair]]);
      const V next = shared - LoadState(state[b[2 * pair + 1]]);
      low[pair] = Low(row, next);
      high[pair] = High(row, next);
    }
    const V xv01 = ShuffleQuarters<0x88>(low[0], low[1]);
    const V xv23 = ShuffleQuarters<0x88>(low[2], low[3]);
    const V z01 = ShuffleQuarters<0xDD>(low[0], low[1]),
            z23 = ShuffleQuarters<0xDD>(low[2], low[3]);
    const V y01 = ShuffleQuarters<0x88>(high[0], high[1]);
    const V y23 = ShuffleQuarters<0x88>(high[2], high[3]);
    d[0] = ShuffleQuarters<0x88>(xv01, xv23);
    d[1] = ShuffleQuarters<0x88>(y01, y23);
    d[2] = ShuffleQuarters<0x88>(z01, z23);
    u[0] = ShuffleQuarters<0xDD>(xv01, xv23);
    u[1] = ShuffleQuarters<0xDD>(y01, y23);
    u[2] = ShuffleQuarters<0xDD>(z01, z23);
  }

  static void Subtract(const NodeForce<double>* force, const int* a, const int* b, V* w) {
    const V shared = Pair(force[a[0]], force[a[1]]);
    V row[4];
    for (int s = 0; s < 4; ++s) row[s] = shared - Pair(force[b[s]], force[b[4 + s]]);
    const V low01 = Low(row[0], row[1]), low23 = Low(row[2], row[3]);
    w[0] = Even(low01, low23);
    w[1] = Even(High(row[0], row[1]), High(row[2], row[3]));
    w[2] = Odd(low01, low23);
  }

  static void AddTo(NodeForce<double>* force, const int* a, const int* b, const V (&value)[3]) {
    const V zero = _mm512_setzero_pd();
    const V xy02 = Low(value[0], value[1]), xy13 = High(value[0], value[1]);
    const V z02 = Low(value[2], zero), z13 = High(value[2], zero);
    // of the first block, then of the second one
    const V row[4] = {Even(xy02, z02), Even(xy13, z13), Odd(xy02, z02), Odd(xy13, z13)};
    const V sum = -((row[0] + row[1]) + (row[2] + row[3]));
    for (int s = 0; s < 4; ++s) AddTo(force[b[s]].f, _mm512_castpd512_pd256(row[s]));
    AddTo(force[a[0]].f, _mm512_castpd512_pd256(sum));
    for (int s = 0; s < 4; ++s) AddTo(force[b[4 + s]].f, UpperHalf(row[s]));
    AddTo(force[a[1]].f, UpperHalf(sum));
  }
  static Quad UpperHalf(V x) { return _mm512_maskz_extractf64x4_pd(0xF, x, 1); }
  static void AddTo(double* p, Quad value) { StoreQuad(LoadQuad(p) + value, p); }

  static void AddTo(NodeState<double>* state, const int* a, const int* b, const V (&x)[3],
                    const V (&v)[3]) {
    const V zero = _mm512_setzero_pd();
    V row[8];
    for (int odd = 0; odd < 2; ++odd) {
      const auto pick = [odd](V p, V q) { return odd == 0 ? Low(p, q) : High(p, q); };
      const V xy = pick(x[0], x[1]), z = pick(x[2], zero);
      const V v_xy = pick(v[0], v[1]), v_z = pick(v[2], zero);
      const V x01 = ShuffleQuarters<0x44>(xy, z), x23 = ShuffleQuarters<0xEE>(xy, z);
      const V v01 = ShuffleQuarters<0x44>(v_xy, v_z), v23 = ShuffleQuarters<0xEE>(v_xy, v_z);
      row[odd] = ShuffleQuarters<0x88>(x01, v01);
      row[2 + odd] = ShuffleQuarters<0xDD>(x01, v01);
      row[4 + odd] = ShuffleQuarters<0x88>(x23, v23);
      row[6 + odd] = ShuffleQuarters<0xDD>(x23, v23);
    }
    for (int block = 0; block < 2; ++block) {
      const V* of_block = row + 4 * block;
      for (int s = 0; s < 4; ++s) AddTo(&state[b[4 * block + s]], of_block[s]);
      AddTo(&state[a[block]], -((of_block[0] + of_block[1]) + (of_block[2] + of_block[3])));
    }
  }
  static void AddTo(NodeState<double>* state, V value) {
    _mm512_store_pd(state->x, LoadState(*state) + value);
  }
};

}  // namespace

template <>
const Kernel<float>& Avx512Kernel() {
  return VectorKernel<Float>::kKernel;
}
template <>
const Kernel<double>& Avx512Kernel() {
  return VectorKernel<Double>::kKernel;
}

}  // namespace physpring
