// What a fuzz target is made of: a function of bytes that stops the process when something is wrong with what
// it tries, and bytes to begin with. libFuzzer (DOVETAIL_FUZZ) drives it, or replay.cpp, with any compiler.
#pragma once

#include "dovetail/base/error.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace dovetail::fuzz {

// Valid and broken inputs, made by code; also what once was found.
std::vector<std::string> seeds();

// Says what is wrong, and stops the process.
[[noreturn]] void fail(const std::string &what);
inline void expect(bool holds, const char *what) {
  if (!holds)
    fail(what);
}

// An Error must be about the file, say something, and be printable: no control characters out of the file.
void expect_helpful(const Error &error, const std::string &path);
void expect_printable(const std::string &text);

} // namespace dovetail::fuzz

// Named by libFuzzer.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t *data, std::size_t size);
