/// Numbers in files are little endian, whatever the machine. Local.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstring>
#include <type_traits>

namespace dovetail {

/// The number whose bytes begin at `bytes`, which needs no alignment.
template <class Number> Number load_little(const std::byte *bytes) {
  static_assert(std::is_arithmetic_v<Number>);
  std::array<std::byte, sizeof(Number)> raw;
  std::memcpy(raw.data(), bytes, sizeof(Number));
  if constexpr (std::endian::native == std::endian::big)
    std::reverse(raw.begin(), raw.end());
  return std::bit_cast<Number>(raw);
}

template <class Number> void store_little(Number number, std::byte *bytes) {
  static_assert(std::is_arithmetic_v<Number>);
  auto raw = std::bit_cast<std::array<std::byte, sizeof(Number)>>(number);
  if constexpr (std::endian::native == std::endian::big)
    std::reverse(raw.begin(), raw.end());
  std::memcpy(bytes, raw.data(), sizeof(Number));
}

static_assert(std::endian::native == std::endian::little || std::endian::native == std::endian::big);

} // namespace dovetail
