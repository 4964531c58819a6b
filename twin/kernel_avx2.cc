// SPDX-License-Identifier: Apache-2.0
// The kernel for AVX2: 8 springs (two blocks) at a time in float, 4 (one block) in double. This
// file alone is compiled with -mavx2.
#include <immintrin.h>

#include "twin/instruction_sets.h"
#include "twin/kernel_vector.h"

namespace physpring {
namespace {

struct Float {
  static constexpr const char* kName = "avx2";
  using Real = float;
  using V = __m256;
  using Quad = __m128;
  static constexpr int kBlocks = 2;

  static V Sqrt(V x) { return _mm256_sqrt_ps(x); }
  static V Inverse(V length) {
    const V shortest = _mm256_set1_ps(static_cast<float>(kShortest));
    const V has_direction = _mm256_cmp_ps(length, shortest, _CMP_GE_OQ);
    return _mm256_and_ps(has_direction, _mm256_set1_ps(1) / length);
  }
  static V Load(const float* p) { return _mm256_loadu_ps(p); }
  static void Store(V x, float* p) { _mm256_storeu_ps(p, x); }
  static Quad SetQuad(float value) { return _mm_set1_ps(value); }
  static Quad LoadQuad(const float* p) { return _mm_load_ps(p); }
  static void StoreQuad(Quad x, float* p) { _mm_store_ps(p, x); }

  static V LoadState(const NodeState<float>& node) { return _mm256_load_ps(node.x); }
  static V Join(Quad low, Quad high) { return _mm256_set_m128(high, low); }
  static Quad Low(V x) { return _mm256_castps256_ps128(x); }
  static Quad High(V x) { return _mm256_extractf128_ps(x, 1); }

  // Rows (x y z 0 | x' y' z' 0) to columns (x x x x | x' x' x' x') and so on.
  static void ToColumns(const V (&row)[4], V (&column)[3]) {
    const V low01 = _mm256_unpacklo_ps(row[0], row[1]), low23 = _mm256_unpacklo_ps(row[2], row[3]);
    const V high01 = _mm256_unpackhi_ps(row[0], row[1]);
    const V high23 = _mm256_unpackhi_ps(row[2], row[3]);
    column[0] = _mm256_shuffle_ps(low01, low23, 0x44);
    column[1] = _mm256_shuffle_ps(low01, low23, 0xEE);
    column[2] = _mm256_shuffle_ps(high01, high23, 0x44);
  }
  static void ToRows(const V (&column)[3], V (&row)[4]) {
    const V zero = _mm256_setzero_ps();
    const V xy01 = _mm256_unpacklo_ps(column[0], column[1]);
    const V xy23 = _mm256_unpackhi_ps(column[0], column[1]);
    const V z01 = _mm256_unpacklo_ps(column[2], zero), z23 = _mm256_unpackhi_ps(column[2], zero);
    row[0] = _mm256_shuffle_ps(xy01, z01, 0x44);
    row[1] = _mm256_shuffle_ps(xy01, z01, 0xEE);
    row[2] = _mm256_shuffle_ps(xy23, z23, 0x44);
    row[3] = _mm256_shuffle_ps(xy23, z23, 0xEE);
  }

  // d = x_a - x_b, u = v_a - v_b
  static void Subtract(const NodeState<float>* state, const int* a, const int* b, V* d, V* u) {
    V column[2][3];
    for (int block = 0; block < 2; ++block) {
      const V shared = LoadState(state[a[block]]);
      V row[4];
      for (int s = 0; s < 4; ++s) row[s] = shared - LoadState(state[b[4 * block + s]]);
      ToColumns(row, column[block]);
    }
    for (int j = 0; j < 3; ++j) {
      d[j] = _mm256_permute2f128_ps(column[0][j], column[1][j], 0x20);
      u[j] = _mm256_permute2f128_ps(column[0][j], column[1][j], 0x31);
    }
  }

  // w = f_a - f_b
  static void Subtract(const NodeForce<float>* force, const int* a, const int* b, V* w) {
    const V shared = Join(LoadQuad(force[a[0]].f), LoadQuad(force[a[1]].f));
    V row[4], column[3];
    for (int s = 0; s < 4; ++s) {
      row[s] = shared - Join(LoadQuad(force[b[s]].f), LoadQuad(force[b[4 + s]].f));
    }
    ToColumns(row, column);
    for (int j = 0; j < 3; ++j) w[j] = column[j];
  }

  // f_b += value, f_a -= the sum of a block
  static void AddTo(NodeForce<float>* force, const int* a, const int* b, const V (&value)[3]) {
    V row[4];
    ToRows(value, row);
    const V sum = (row[0] + row[1]) + (row[2] + row[3]);
    for (int s = 0; s < 4; ++s) AddTo(&force[b[s]], Low(row[s]));
    AddTo(&force[a[0]], -Low(sum));
    for (int s = 0; s < 4; ++s) AddTo(&force[b[4 + s]], High(row[s]));
    AddTo(&force[a[1]], -High(sum));
  }
  static void AddTo(NodeForce<float>* force, Quad value) {
    StoreQuad(LoadQuad(force->f) + value, force->f);
  }

  static void AddTo(NodeState<float>* state, const int* a, const int* b, const V (&x)[3],
                    const V (&v)[3]) {
    for (int block = 0; block < 2; ++block) {
      V column[3], row[4];
      for (int j = 0; j < 3; ++j) {
        column[j] = block == 0 ? _mm256_permute2f128_ps(x[j], v[j], 0x20)
                               : _mm256_permute2f128_ps(x[j], v[j], 0x31);
      }
      ToRows(column, row);
      for (int s = 0; s < 4; ++s) AddTo(&state[b[4 * block + s]], row[s]);
      AddTo(&state[a[block]], -((row[0] + row[1]) + (row[2] + row[3])));
    }
  }
  static void AddTo(NodeState<float>* state, V value) {
    _mm256_store_ps(state->x, LoadState(*state) + value);
  }
};

struct Double {
  static constexpr const char* kName = "avx2";
  using Real = double;
  using V = __m256d;
  using Quad = __m256d;
  static constexpr int kBlocks = 1;

  static V Sqrt(V x) { return _mm256_sqrt_pd(x); }
  static V Inverse(V length) {
    const V has_direction = _mm256_cmp_pd(length, _mm256_set1_pd(kShortest), _CMP_GE_OQ);
    return _mm256_and_pd(has_direction, _mm256_set1_pd(1) / length);
  }
  static V Load(const double* p) { return _mm256_loadu_pd(p); }
  static void Store(V x, double* p) { _mm256_storeu_pd(p, x); }
  static Quad SetQuad(double value) { return _mm256_set1_pd(value); }
  static Quad LoadQuad(const double* p) { return _mm256_load_pd(p); }
  static void StoreQuad(Quad x, double* p) { _mm256_store_pd(p, x); }

  // Rows (x y z 0) to columns (x x x x) and so on.
  static void ToColumns(const V (&row)[4], V* column) {
    const V xz01 = _mm256_unpacklo_pd(row[0], row[1]), xz23 = _mm256_unpacklo_pd(row[2], row[3]);
    const V y01 = _mm256_unpackhi_pd(row[0], row[1]), y23 = _mm256_unpackhi_pd(row[2], row[3]);
    column[0] = _mm256_permute2f128_pd(xz01, xz23, 0x20);
    column[1] = _mm256_permute2f128_pd(y01, y23, 0x20);
    column[2] = _mm256_permute2f128_pd(xz01, xz23, 0x31);
  }
  static void ToRows(const V (&column)[3], V (&row)[4]) {
    const V zero = _mm256_setzero_pd();
    const V xy02 = _mm256_unpacklo_pd(column[0], column[1]);
    const V xy13 = _mm256_unpackhi_pd(column[0], column[1]);
    const V z02 = _mm256_unpacklo_pd(column[2], zero), z13 = _mm256_unpackhi_pd(column[2], zero);
    row[0] = _mm256_permute2f128_pd(xy02, z02, 0x20);
    row[1] = _mm256_permute2f128_pd(xy13, z13, 0x20);
    row[2] = _mm256_permute2f128_pd(xy02, z02, 0x31);
    row[3] = _mm256_permute2f128_pd(xy13, z13, 0x31);
  }

  static void Subtract(const NodeState<double>* state, const int* a, const int* b, V* d, V* u) {
    const V x = LoadQuad(state[*a].x), v = LoadQuad(state[*a].v);
    V row[4];
    for (int s = 0; s < 4; ++s) row[s] = x - LoadQuad(state[b[s]].x);
    ToColumns(row, d);
    for (int s = 0; s < 4; ++s) row[s] = v - LoadQuad(state[b[s]].v);
    ToColumns(row, u);
  }
  static void Subtract(const NodeForce<double>* force, const int* a, const int* b, V* w) {
    const V f = LoadQuad(force[*a].f);
    V row[4];
    for (int s = 0; s < 4; ++s) row[s] = f - LoadQuad(force[b[s]].f);
    ToColumns(row, w);
  }

  static void AddTo(NodeForce<double>* force, const int* a, const int* b, const V (&value)[3]) {
    V row[4];
    ToRows(value, row);
    for (int s = 0; s < 4; ++s) AddTo(force[b[s]].f, row[s]);
    AddTo(force[*a].f, -((row[0] + row[1]) + (row[2] + row[3])));
  }
  static void AddTo(NodeState<double>* state, const int* a, const int* b, const V (&x)[3],
                    const V (&v)[3]) {
    V row[4];
    ToRows(x, row);
    for (int s = 0; s < 4; ++s) AddTo(state[b[s]].x, row[s]);
    AddTo(state[*a].x, -((row[0] + row[1]) + (row[2] + row[3])));
    ToRows(v, row);
    for (int s = 0; s < 4; ++s) AddTo(state[b[s]].v, row[s]);
    AddTo(state[*a].v, -((row[0] + row[1]) + (row[2] + row[3])));
  }
  static void AddTo(double* p, Quad value) { StoreQuad(LoadQuad(p) + value, p); }
};

}  // namespace

template <>
const Kernel<float>& Avx2Kernel() {
  return VectorKernel<Float>::kKernel;
}
template <>
const Kernel<double>& Avx2Kernel() {
  return VectorKernel<Double>::kKernel;
}

}  // namespace physpring
