/// The answer of a predicate.
#pragma once

#include <cstdint>

namespace dovetail {

enum class Sign : std::int8_t { negative = -1, zero = 0, positive = 1 };

constexpr Sign operator-(Sign s) { return static_cast<Sign>(-static_cast<int>(s)); }
constexpr Sign operator*(Sign a, Sign b) {
  return static_cast<Sign>(static_cast<int>(a) * static_cast<int>(b));
}

template <class Number> constexpr Sign sign_of(Number value) {
  return value > Number{0} ? Sign::positive : value < Number{0} ? Sign::negative : Sign::zero;
}

} // namespace dovetail
