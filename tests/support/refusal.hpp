// Errors as a user meets them: of the right kind, about the right file, with a remedy, alike on all ranks.
#pragma once

#include "dovetail/base/error.hpp"
#include "dovetail/comm/collectives.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <unistd.h>
#include <vector>

namespace dovetail::testing {

// Collective. The work must fail on every rank with this kind, name the file, and say all the parts.
inline void expect_refused(const Communicator &comm, ErrorKind kind, const std::string &path,
                           const std::vector<std::string> &parts, const std::function<void()> &work) {
  Problem problem{kind, "nothing was thrown", "", "", ""};
  std::string text = "nothing was thrown";
  try {
    work();
  } catch (const Error &error) {
    problem = error.problem();
    text = error.what();
  }
  EXPECT_EQ(problem.kind, kind) << text;
  EXPECT_EQ(problem.subject, path) << text;
  EXPECT_FALSE(problem.remedy.empty()) << text;
  for (const std::string &part : parts)
    EXPECT_NE(text.find(part), std::string::npos) << "'" << part << "' is not in: " << text;
  std::string text_of_root = text;
  broadcast(comm, text_of_root);
  EXPECT_EQ(text, text_of_root);
}

// While it lives, all ranks are a user without privileges (if they were root before).
class Unprivileged {
public:
  Unprivileged() {
    constexpr uid_t nobody = 65534;
    EXPECT_EQ(was_root_ ? ::seteuid(nobody) : 0, 0);
  }
  ~Unprivileged() { EXPECT_EQ(was_root_ ? ::seteuid(0) : 0, 0); }

private:
  bool was_root_ = ::geteuid() == 0;
};

} // namespace dovetail::testing
