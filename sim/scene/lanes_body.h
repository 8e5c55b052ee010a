/// Operations on sixteen numbers at a time, and the same operations on one number. They use as many
/// registers as the instruction set of the including source requires, and are internal to it. Every
/// operation is exact or rounded according to IEEE 754, so all instruction sets give identical
/// bits. Arguments of min() and max() must not be NaN.
#pragma once

#include <cstdint>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace skycap::sim {
namespace {

constexpr int lane_count = 16;
#if defined(__AVX512F__)
constexpr int part_lanes = 16;
#elif defined(__AVX2__)
constexpr int part_lanes = 8;
#else
constexpr int part_lanes = 4;
#endif
constexpr int part_count = lane_count / part_lanes;

// One register, and the result of a comparison: one bit per lane, or all bits of each lane.
using Part [[gnu::vector_size(4 * part_lanes), gnu::may_alias]] = float;
#if defined(__AVX512F__)
using PartMask = __mmask16;
#else
using PartMask [[gnu::vector_size(4 * part_lanes), gnu::may_alias]] = std::int32_t;
#endif

#if defined(__AVX512F__)

inline Part every_lane(float value) { return _mm512_set1_ps(value); }
inline Part min(Part a, Part b) { return _mm512_min_ps(a, b); }
inline Part max(Part a, Part b) { return _mm512_max_ps(a, b); }
inline PartMask is_less(Part a, Part b) { return _mm512_cmp_ps_mask(a, b, _CMP_LT_OQ); }
inline PartMask is_at_most(Part a, Part b) { return _mm512_cmp_ps_mask(a, b, _CMP_LE_OQ); }
inline PartMask is_equal(Part a, Part b) { return _mm512_cmp_ps_mask(a, b, _CMP_EQ_OQ); }
inline PartMask inverse(PartMask mask) { return static_cast<PartMask>(~mask); }
inline Part chosen(PartMask mask, Part a, Part b) { return _mm512_mask_blend_ps(mask, b, a); }
inline std::uint32_t bits(PartMask mask) { return mask; }
inline PartMask part_mask(std::uint32_t bits) { return static_cast<PartMask>(bits); }

#else

inline PartMask is_less(Part a, Part b) { return a < b; }
inline PartMask is_at_most(Part a, Part b) { return a <= b; }
inline PartMask is_equal(Part a, Part b) { return a == b; }
inline PartMask inverse(PartMask mask) { return ~mask; }
inline PartMask part_mask(std::uint32_t bits) {
  PartMask lane_bits;
  for (int lane = 0; lane < part_lanes; ++lane) lane_bits[lane] = 1 << lane;
  return (static_cast<std::int32_t>(bits) & lane_bits) == lane_bits;
}

#if defined(__AVX2__)
inline Part every_lane(float value) { return _mm256_set1_ps(value); }
inline Part min(Part a, Part b) { return _mm256_min_ps(a, b); }
inline Part max(Part a, Part b) { return _mm256_max_ps(a, b); }
inline Part chosen(PartMask mask, Part a, Part b) { return _mm256_blendv_ps(b, a, (Part)mask); }
inline std::uint32_t bits(PartMask mask) {
  return static_cast<std::uint32_t>(_mm256_movemask_ps((Part)mask));
}
#else
inline Part every_lane(float value) { return Part{value, value, value, value}; }
inline Part chosen(PartMask mask, Part a, Part b) {
  return (Part)(((PartMask)a & mask) | ((PartMask)b & ~mask));
}
#if defined(__SSE2__)
inline Part min(Part a, Part b) { return _mm_min_ps(a, b); }
inline Part max(Part a, Part b) { return _mm_max_ps(a, b); }
inline std::uint32_t bits(PartMask mask) {
  return static_cast<std::uint32_t>(_mm_movemask_ps((Part)mask));
}
#else
inline Part min(Part a, Part b) { return chosen(a < b, a, b); }
inline Part max(Part a, Part b) { return chosen(a > b, a, b); }
inline std::uint32_t bits(PartMask mask) {
  const PartMask bit = mask & PartMask{1, 2, 4, 8};
  return static_cast<std::uint32_t>(bit[0] | bit[1] | bit[2] | bit[3]);
}
#endif
#endif
#endif

struct Floats {
  Part part[part_count];
};
struct Mask {
  PartMask part[part_count];
};

template <typename Lanes, typename Operation>
[[gnu::always_inline]] inline Lanes each_part(Operation&& operation) {
  Lanes result;
#pragma GCC unroll 4
  for (int i = 0; i < part_count; ++i) result.part[i] = operation(i);
  return result;
}

inline Floats operator+(const Floats& a, const Floats& b) {
  return each_part<Floats>([&](int i) { return a.part[i] + b.part[i]; });
}
inline Floats operator-(const Floats& a, const Floats& b) {
  return each_part<Floats>([&](int i) { return a.part[i] - b.part[i]; });
}
inline Floats operator*(const Floats& a, const Floats& b) {
  return each_part<Floats>([&](int i) { return a.part[i] * b.part[i]; });
}
inline Floats operator/(const Floats& a, const Floats& b) {
  return each_part<Floats>([&](int i) { return a.part[i] / b.part[i]; });
}
inline Floats operator-(const Floats& a) {
  return each_part<Floats>([&](int i) { return -a.part[i]; });
}
inline Floats min(const Floats& a, const Floats& b) {
  return each_part<Floats>([&](int i) { return min(a.part[i], b.part[i]); });
}
inline Floats max(const Floats& a, const Floats& b) {
  return each_part<Floats>([&](int i) { return max(a.part[i], b.part[i]); });
}
inline Floats magnitude(const Floats& a) { return max(a, -a); }

inline Mask is_less(const Floats& a, const Floats& b) {
  return each_part<Mask>([&](int i) { return is_less(a.part[i], b.part[i]); });
}
inline Mask is_at_most(const Floats& a, const Floats& b) {
  return each_part<Mask>([&](int i) { return is_at_most(a.part[i], b.part[i]); });
}
inline Mask is_equal(const Floats& a, const Floats& b) {
  return each_part<Mask>([&](int i) { return is_equal(a.part[i], b.part[i]); });
}
inline Mask operator&(const Mask& a, const Mask& b) {
  return each_part<Mask>([&](int i) { return static_cast<PartMask>(a.part[i] & b.part[i]); });
}
inline Mask operator|(const Mask& a, const Mask& b) {
  return each_part<Mask>([&](int i) { return static_cast<PartMask>(a.part[i] | b.part[i]); });
}
inline Mask operator!(const Mask& a) {
  return each_part<Mask>([&](int i) { return inverse(a.part[i]); });
}
inline Floats chosen(const Mask& mask, const Floats& a, const Floats& b) {
  return each_part<Floats>([&](int i) { return chosen(mask.part[i], a.part[i], b.part[i]); });
}

// Converts a mask to one bit per lane, or vice versa.
inline std::uint32_t bits(const Mask& mask) {
  std::uint32_t all = 0;
#pragma GCC unroll 4
  for (int i = 0; i < part_count; ++i) all |= bits(mask.part[i]) << (i * part_lanes);
  return all;
}
inline Mask make_mask(std::uint32_t bits) {
  return each_part<Mask>([&](int i) { return part_mask(bits >> (i * part_lanes)); });
}
inline bool any(const Mask& mask) {
  PartMask all = mask.part[0];
#pragma GCC unroll 4
  for (int i = 1; i < part_count; ++i) all |= mask.part[i];
  return bits(all) != 0;
}

// Loads from or stores to memory that is aligned to 64 bytes.
inline Floats load(const float* lanes) {
  return each_part<Floats>([&](int i) { return reinterpret_cast<const Part*>(lanes)[i]; });
}
inline void store(const Floats& values, float* lanes) {
#pragma GCC unroll 4
  for (int i = 0; i < part_count; ++i) reinterpret_cast<Part*>(lanes)[i] = values.part[i];
}

inline float horizontal_min(const Floats& values) {
  Part part_min = values.part[0];
#pragma GCC unroll 4
  for (int i = 1; i < part_count; ++i) part_min = min(part_min, values.part[i]);
#if defined(__AVX512F__)
  return _mm512_reduce_min_ps(part_min);
#else
  float result = part_min[0];
  for (int i = 1; i < part_lanes; ++i) {
    result = part_min[i] < result ? part_min[i] : result;
  }
  return result;
#endif
}
inline float horizontal_max(const Floats& values) { return -horizontal_min(-values); }

// Scalar mask and operations, for templates that accept vectors or scalars.
struct Truth {
  bool holds;
};
inline Truth operator&(Truth a, Truth b) { return {a.holds && b.holds}; }
inline Truth operator|(Truth a, Truth b) { return {a.holds || b.holds}; }
inline Truth operator!(Truth a) { return {!a.holds}; }
inline bool any(Truth truth) { return truth.holds; }
inline Truth is_less(float a, float b) { return {a < b}; }
inline Truth is_at_most(float a, float b) { return {a <= b}; }
inline Truth is_equal(float a, float b) { return {a == b}; }
inline float min(float a, float b) { return a < b ? a : b; }
inline float max(float a, float b) { return a > b ? a : b; }
inline float magnitude(float a) { return a < 0.0F ? -a : a; }
inline float chosen(Truth truth, float a, float b) { return truth.holds ? a : b; }
inline float horizontal_min(float value) { return value; }
inline float horizontal_max(float value) { return value; }

// Returns a vector with `value` in all lanes.
template <typename Lanes>
Lanes every(float value);
template <>
inline Floats every<Floats>(float value) {
  return each_part<Floats>([&](int) { return every_lane(value); });
}
template <>
inline float every<float>(float value) {
  return value;
}

template <typename Lanes>
using LaneMask = decltype(is_less(Lanes{}, Lanes{}));

}  // namespace
}  // namespace skycap::sim
