#include "target.hpp"

#include <algorithm>
#include <cstdio>
#include <cstdlib>

namespace dovetail::fuzz {

void fail(const std::string &what) {
  std::fprintf(stderr, "\nexpected: %s\n", what.c_str());
  std::abort();
}

void expect_printable(const std::string &text) {
  expect(std::none_of(text.begin(), text.end(),
                      [](char c) { return static_cast<unsigned char>(c) < ' ' || c == '\x7f'; }),
         "text for people without control characters");
}

void expect_helpful(const Error &error, const std::string &path) {
  const Problem &problem = error.problem();
  expect(problem.kind == ErrorKind::input, "a broken file is a fault of the input");
  expect(problem.subject == path, "the message names the file");
  expect(!problem.what.empty() && !problem.remedy.empty(), "the message says what is wrong and what to do");
  expect(problem.what.size() < 1000, "the message is short");
  expect_printable(error.what());
}

} // namespace dovetail::fuzz
