#pragma once
/// Vectors of the compiler (GCC, Clang) for code that is compiled once per instruction set. Everything here has
/// internal linkage and nothing of the standard library is used, so that no function of one set is linked into another.
#if defined(__AVX512F__) || defined(__AVX2__) || defined(__SSE2__)
#include <immintrin.h>
#endif

namespace sunder::mpm {
namespace {

#if defined(__AVX512DQ__)
constexpr int width = 8;
#else
constexpr int width = 4;
#endif

/// One number of `width` points.
using Lanes = double __attribute__((vector_size(8 * width), may_alias));
using Mask = long long __attribute__((vector_size(8 * width), may_alias));
using IntLanes = int __attribute__((vector_size(4 * width), may_alias));
using CountLanes = unsigned __attribute__((vector_size(4 * width), may_alias));
/// Three components of a vector and one number more, of one point or node.
using Quad = double __attribute__((vector_size(32), may_alias));

inline Lanes load(const double* at) { return *reinterpret_cast<const Lanes*>(at); }
inline void store(double* at, Lanes x) { *reinterpret_cast<Lanes*>(at) = x; }
inline Quad load_quad(const double* at) { return *reinterpret_cast<const Quad*>(at); }
inline void store_quad(double* at, Quad x) { *reinterpret_cast<Quad*>(at) = x; }
inline Lanes all(double x) { return x - Lanes{}; }

inline unsigned bits(Mask mask) {
#if defined(__AVX512DQ__)
  return _mm512_movepi64_mask(reinterpret_cast<__m512i>(mask));
#elif defined(__AVX2__)
  return static_cast<unsigned>(_mm256_movemask_pd(reinterpret_cast<__m256d>(mask)));
#else
  unsigned result = 0;
  for (int n = 0; n < width; ++n) result |= static_cast<unsigned>(mask[n] != 0) << n;
  return result;
#endif
}
inline bool any(Mask mask) { return bits(mask) != 0; }

inline Lanes sqrt(Lanes x) {
#if defined(__AVX512DQ__)
  return reinterpret_cast<Lanes>(_mm512_maskz_sqrt_pd(0xff, reinterpret_cast<__m512d>(x)));
#elif defined(__AVX2__)
  return reinterpret_cast<Lanes>(_mm256_sqrt_pd(reinterpret_cast<__m256d>(x)));
#else
  for (int n = 0; n < width; ++n) x[n] = __builtin_sqrt(x[n]);
  return x;
#endif
}

inline Lanes max(Lanes a, Lanes b) { return a > b ? a : b; }
inline Lanes min(Lanes a, Lanes b) { return a < b ? a : b; }

inline double sum(Lanes x) {
  double total = 0;
  for (int n = 0; n < width; ++n) total += x[n];
  return total;
}

/// Rows and columns of four quads change places.
inline void transpose(Quad q[4]) {
  const Quad a = __builtin_shufflevector(q[0], q[1], 0, 4, 2, 6), b = __builtin_shufflevector(q[0], q[1], 1, 5, 3, 7);
  const Quad c = __builtin_shufflevector(q[2], q[3], 0, 4, 2, 6), d = __builtin_shufflevector(q[2], q[3], 1, 5, 3, 7);
  q[0] = __builtin_shufflevector(a, c, 0, 1, 4, 5);
  q[1] = __builtin_shufflevector(b, d, 0, 1, 4, 5);
  q[2] = __builtin_shufflevector(a, c, 2, 3, 6, 7);
  q[3] = __builtin_shufflevector(b, d, 2, 3, 6, 7);
}

/// Four numbers of `width` points -> a quad per point.
inline void to_quads(Lanes a, Lanes b, Lanes c, Lanes d, Quad* out) {
#if defined(__AVX512DQ__)
  Quad low[4] = {__builtin_shufflevector(a, a, 0, 1, 2, 3), __builtin_shufflevector(b, b, 0, 1, 2, 3),
                 __builtin_shufflevector(c, c, 0, 1, 2, 3), __builtin_shufflevector(d, d, 0, 1, 2, 3)};
  Quad high[4] = {__builtin_shufflevector(a, a, 4, 5, 6, 7), __builtin_shufflevector(b, b, 4, 5, 6, 7),
                  __builtin_shufflevector(c, c, 4, 5, 6, 7), __builtin_shufflevector(d, d, 4, 5, 6, 7)};
  transpose(low);
  transpose(high);
  for (int n = 0; n < 4; ++n) {
    out[n] = low[n];
    out[4 + n] = high[n];
  }
#else
  Quad q[4] = {a, b, c, d};
  transpose(q);
  for (int n = 0; n < 4; ++n) out[n] = q[n];
#endif
}

/// A quad per point -> their first three numbers.
inline void from_quads(const Quad* in, Lanes& a, Lanes& b, Lanes& c) {
  Quad low[4] = {in[0], in[1], in[2], in[3]};
  transpose(low);
#if defined(__AVX512DQ__)
  Quad high[4] = {in[4], in[5], in[6], in[7]};
  transpose(high);
  a = __builtin_shufflevector(low[0], high[0], 0, 1, 2, 3, 4, 5, 6, 7);
  b = __builtin_shufflevector(low[1], high[1], 0, 1, 2, 3, 4, 5, 6, 7);
  c = __builtin_shufflevector(low[2], high[2], 0, 1, 2, 3, 4, 5, 6, 7);
#else
  a = low[0];
  b = low[1];
  c = low[2];
#endif
}

}  // namespace
}  // namespace sunder::mpm
