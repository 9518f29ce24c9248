/// Synthetic point sets. Point i is a function of (distribution, n, seed, i) and of nothing else, so any
/// number of ranks makes the same set, each its own part.
///
/// The same bits on every CPU: integer arithmetic, + - * / and sqrt (which IEEE 754 rounds correctly), and
/// our own logarithm; no libm, no fused multiply-add. Local; thread-safe; no state.
///
/// Random words: a counter-based generator in the manner of splitmix64 (Steele, Lea, Flood 2014; Salmon et
/// al. 2011 for the idea). absorb(h, w) = mix((h xor w) + g) with mix and g of splitmix64; the stream of
/// point i starts at h = absorb(absorb(absorb(0, seed), stream), i) and its k-th word is mix(h + k g),
/// k = 1, 2, ...; a real in [0, 1) is the upper 53 bits of a word.
#pragma once

#include "dovetail/base/types.hpp"

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

namespace dovetail {

enum class Distribution : std::uint8_t {
  uniform,  ///< the unit square
  normal,   ///< both coordinates standard normal
  kuzmin,   ///< centred and heavy-tailed: radius with the distribution 1 - 1 / sqrt(1 + r^2)
  line,     ///< hugs x = 0.001 ... 1: x = b / (u - b u + b) with b = 0.001, y uniform
  lattice,  ///< integers, ceil(sqrt n) columns, last row partial, in random order
  circle,   ///< the unit circle, rounded to doubles
  lidar,    ///< a square kilometre rounded to 0.01, so with duplicates, and with a height
  clusters, ///< floor(sqrt n) normal clusters of width 0.001 in the unit square
};

inline constexpr Distribution all_distributions[] = {
    Distribution::uniform, Distribution::normal, Distribution::kuzmin, Distribution::line,
    Distribution::lattice, Distribution::circle, Distribution::lidar,  Distribution::clusters};

std::string_view distribution_name(Distribution distribution);
/// Nothing if there is no distribution of this name.
std::optional<Distribution> distribution_named(std::string_view name);
/// True for the distributions whose points have a height (z).
constexpr bool has_height(Distribution distribution) { return distribution == Distribution::lidar; }

/// One synthetic point set of n points.
struct SyntheticSet {
  Distribution distribution = Distribution::uniform;
  GlobalIndex n = 0;
  std::uint64_t seed = 0;
};

/// Points first, first + 1, ... of the set, as many as `points` has room for; 0 <= first and
/// first + points.size() <= n.
void generate_points(const SyntheticSet &set, GlobalIndex first, std::span<Point> points);
/// Their heights; only for distributions that have one.
void generate_heights(const SyntheticSet &set, GlobalIndex first, std::span<double> heights);

/// What the distributions are made of, for tests and other generators.
namespace synthetic {

constexpr std::uint64_t golden_gamma = 0x9e3779b97f4a7c15;

/// The finaliser of splitmix64: a bijection of 64-bit words.
constexpr std::uint64_t mix(std::uint64_t v) {
  v = (v ^ (v >> 30)) * 0xbf58476d1ce4e5b9;
  v = (v ^ (v >> 27)) * 0x94d049bb133111eb;
  return v ^ (v >> 31);
}
constexpr std::uint64_t absorb(std::uint64_t hash, std::uint64_t word) {
  return mix((hash ^ word) + golden_gamma);
}

/// The words of one point of one stream.
class Draws {
public:
  constexpr Draws(std::uint64_t stream_key, std::uint64_t index) : state_(absorb(stream_key, index)) {}
  constexpr std::uint64_t word() { return mix(state_ += golden_gamma); }
  /// In [0, 1), a multiple of 2^-53.
  constexpr double unit() { return static_cast<double>(word() >> 11) * 0x1p-53; }
  /// In [0, bound), bound <= 2^32.
  constexpr std::uint64_t below(std::uint64_t bound) { return ((word() >> 32) * bound) >> 32; }

private:
  std::uint64_t state_;
};

constexpr std::uint64_t stream_key(std::uint64_t seed, std::uint64_t stream) {
  return absorb(absorb(0, seed), stream);
}

/// Natural logarithm of a positive normal double, within 2 units in the last place.
double logarithm(double value);

/// The smallest c with c * c >= n, for 0 <= n < 2^62.
std::uint64_t ceil_sqrt(std::uint64_t n);

} // namespace synthetic
} // namespace dovetail
