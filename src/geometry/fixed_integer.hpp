/// Signed integers of a fixed number of 64-bit words, on the stack: what the exact predicates count in.
#pragma once

#include "dovetail/base/sign.hpp"

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>

namespace dovetail {

__extension__ using Int128 = __int128;
__extension__ using UInt128 = unsigned __int128;

/// Two's complement, least significant word first. Sums wrap around, so a caller leaves room for them.
template <std::size_t Words> struct FixedInteger {
  std::array<std::uint64_t, Words> words{};

  bool is_negative() const { return (words[Words - 1] >> 63) != 0; }

  Sign sign() const {
    if (is_negative())
      return Sign::negative;
    std::uint64_t any = 0;
    for (const std::uint64_t word : words)
      any |= word;
    return any != 0 ? Sign::positive : Sign::zero;
  }

  friend FixedInteger operator+(const FixedInteger &a, const FixedInteger &b) {
    FixedInteger sum;
    UInt128 carry = 0;
    for (std::size_t i = 0; i < Words; ++i) {
      carry += static_cast<UInt128>(a.words[i]) + b.words[i];
      sum.words[i] = static_cast<std::uint64_t>(carry);
      carry >>= 64;
    }
    return sum;
  }

  friend FixedInteger operator-(const FixedInteger &a, const FixedInteger &b) {
    FixedInteger difference = a;
    difference.subtract_at(0, b);
    return difference;
  }

  /// Subtracts b * 2^(64 from), modulo the width.
  template <std::size_t Other> void subtract_at(std::size_t from, const FixedInteger<Other> &b) {
    std::uint64_t borrow = 0;
    for (std::size_t i = from; i < Words && i - from < Other; ++i) {
      const UInt128 difference = static_cast<UInt128>(words[i]) - b.words[i - from] - borrow;
      words[i] = static_cast<std::uint64_t>(difference);
      borrow = static_cast<std::uint64_t>(difference >> 64) & 1;
    }
  }
};

/// The full product.
template <std::size_t N, std::size_t M>
FixedInteger<N + M> operator*(const FixedInteger<N> &a, const FixedInteger<M> &b) {
  FixedInteger<N + M> product;
  if constexpr (N == 1 && M == 1) {
    const Int128 value =
        static_cast<Int128>(static_cast<std::int64_t>(a.words[0])) * static_cast<std::int64_t>(b.words[0]);
    product.words = {static_cast<std::uint64_t>(value), static_cast<std::uint64_t>(value >> 64)};
    return product;
  }
  for (std::size_t i = 0; i < N; ++i) {
    if constexpr (N > 2)
      if (a.words[i] == 0) // the gaps between mantissas far apart
        continue;
    std::uint64_t carry = 0;
    for (std::size_t j = 0; j < M; ++j) {
      const UInt128 term = static_cast<UInt128>(a.words[i]) * b.words[j] + product.words[i + j] + carry;
      product.words[i + j] = static_cast<std::uint64_t>(term);
      carry = static_cast<std::uint64_t>(term >> 64);
    }
    product.words[i + M] = carry;
  }
  // So far the words were taken as unsigned: a negative factor counted as itself plus 2^(64 words).
  if (a.is_negative())
    product.subtract_at(N, b);
  if (b.is_negative())
    product.subtract_at(M, a);
  return product;
}

/// A double as mantissa * 2^exponent with an odd mantissa, or with a zero one.
struct Scaled {
  std::int64_t mantissa = 0;
  int exponent = 0;
};

inline Scaled scaled(double value) {
  const auto bits = std::bit_cast<std::uint64_t>(value);
  const int biased = static_cast<int>(bits >> 52 & 0x7ff);
  std::uint64_t mantissa = bits & ((std::uint64_t{1} << 52) - 1);
  if (biased != 0)
    mantissa |= std::uint64_t{1} << 52;
  if (mantissa == 0)
    return {};
  const int zeros = std::countr_zero(mantissa);
  const auto odd = static_cast<std::int64_t>(mantissa >> zeros);
  return {(bits >> 63) != 0 ? -odd : odd, (biased != 0 ? biased : 1) - 1075 + zeros};
}

/// value / 2^unit, which must be an integer that fits.
template <std::size_t Words> FixedInteger<Words> aligned(Scaled value, int unit) {
  FixedInteger<Words> result;
  if (value.mantissa == 0)
    return result;
  const auto shift = static_cast<std::size_t>(value.exponent - unit);
  if constexpr (Words == 1) {
    result.words[0] = static_cast<std::uint64_t>(value.mantissa) << shift;
    return result;
  }
  const auto magnitude = static_cast<std::uint64_t>(value.mantissa < 0 ? -value.mantissa : value.mantissa);
  const UInt128 shifted = static_cast<UInt128>(magnitude) << (shift % 64);
  result.words[shift / 64] = static_cast<std::uint64_t>(shifted);
  if (shift / 64 + 1 < Words)
    result.words[shift / 64 + 1] = static_cast<std::uint64_t>(shifted >> 64);
  return value.mantissa < 0 ? FixedInteger<Words>{} - result : result;
}

/// The powers of two that bound a set of doubles: all are multiples of 2^low and smaller than 2^high.
struct Extent {
  int low = std::numeric_limits<int>::max();
  int high = std::numeric_limits<int>::min();

  void add(Scaled value) {
    if (value.mantissa == 0)
      return;
    const auto magnitude = static_cast<std::uint64_t>(value.mantissa < 0 ? -value.mantissa : value.mantissa);
    low = value.exponent < low ? value.exponent : low;
    const int top = value.exponent + static_cast<int>(std::bit_width(magnitude));
    high = top > high ? top : high;
  }
  int bits() const { return low <= high ? high - low : 0; }
};

} // namespace dovetail
