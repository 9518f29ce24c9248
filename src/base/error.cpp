#include "dovetail/base/error.hpp"

#include <utility>

namespace dovetail {
namespace {

std::string sentence(const Problem &problem) {
  std::string text = problem.subject;
  if (!problem.place.empty())
    text += (text.empty() ? "" : ", ") + problem.place;
  text += (text.empty() ? "" : ": ") + problem.what;
  if (!problem.remedy.empty())
    text += "; " + problem.remedy;
  return text;
}

} // namespace

Error::Error(Problem problem) : std::runtime_error(sentence(problem)), problem_(std::move(problem)) {}

} // namespace dovetail
