#include "dovetail/base/error.hpp"

#include "dovetail/base/excerpt.hpp"

#include <algorithm>
#include <cstdint>
#include <utility>

namespace dovetail {
namespace {

std::string printable(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c < ' ' || c == 0x7f; }, '?');
  return text;
}

std::string sentence(const Problem &problem) {
  std::string text = problem.subject;
  if (!problem.place.empty())
    text += (text.empty() ? "" : ", ") + problem.place;
  text += (text.empty() ? "" : ": ") + problem.what;
  if (!problem.remedy.empty())
    text += "; " + problem.remedy;
  return printable(std::move(text));
}

} // namespace

std::string excerpt(std::string_view text) {
  constexpr std::size_t longest = 60;
  std::size_t end = std::min(text.size(), longest);
  if (end < text.size())
    while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xc0) == 0x80) // within a character of UTF-8
      --end;
  std::string result = printable(std::string(text.substr(0, end)));
  if (!is_printable(result))
    std::ranges::replace_if(
        result, [](unsigned char c) { return c >= 0x80; }, '?');
  return end < text.size() ? result + "..." : result;
}

bool is_printable(std::string_view text) {
  const auto byte = [text](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  for (std::size_t i = 0; i < text.size();) {
    const unsigned first = byte(i);
    if (first < 0x80) {
      if (first < ' ' || first == 0x7f)
        return false;
      ++i;
      continue;
    }
    // The lead byte says how many follow with six bits each; codes must not be longer than they need.
    const std::size_t following = first < 0xe0 ? 1 : first < 0xf0 ? 2 : 3;
    if (first < 0xc2 || first > 0xf4 || text.size() - i <= following)
      return false;
    std::uint32_t code = first & (0x3fU >> following);
    for (std::size_t k = 1; k <= following; ++k) {
      if ((byte(i + k) & 0xc0U) != 0x80)
        return false;
      code = code << 6 | (byte(i + k) & 0x3fU);
    }
    const bool surrogate = code >= 0xd800 && code < 0xe000, control = code < 0xa0;
    if (surrogate || control || code > 0x10ffff || (following == 2 && code < 0x800) ||
        (following == 3 && code < 0x10000))
      return false;
    i += following + 1;
  }
  return true;
}

Error::Error(Problem problem) : std::runtime_error(sentence(problem)), problem_(std::move(problem)) {}

} // namespace dovetail
