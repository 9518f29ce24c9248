#include "dovetail/base/error.hpp"

#include "dovetail/base/excerpt.hpp"

#include <algorithm>
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
  if (text.size() <= longest)
    return printable(std::string(text));
  std::size_t end = longest;
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xc0) == 0x80) // within a character of UTF-8
    --end;
  return printable(std::string(text.substr(0, end))) + "...";
}

Error::Error(Problem problem) : std::runtime_error(sentence(problem)), problem_(std::move(problem)) {}

} // namespace dovetail
