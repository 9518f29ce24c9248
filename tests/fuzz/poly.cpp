#include "domain_readers.hpp"

using namespace dovetail;

namespace {

// A file and, behind a line of "=", the .node file beside it.
DomainFile read(const InputFile &file) {
  std::string text(static_cast<std::size_t>(file.bytes()), ' ');
  file.read_at(0, std::as_writable_bytes(std::span(text)));
  const std::size_t cut = text.find("=\n");
  const std::string beside = cut == std::string::npos ? std::string() : text.substr(cut + 2);
  text.resize(std::min(text.size(), cut));
  const InputFile poly(file.path(), std::as_bytes(std::span(text)));
  const InputFile nodes(file.path(), std::as_bytes(std::span(beside)));
  return read_poly(poly, &nodes);
}

} // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t *data, std::size_t size) {
  return fuzz::check_domain(data, size, read);
}

std::vector<std::string> fuzz::seeds() {
  return {
      "3 2 0 0\n0 0 0\n1 1 0\n2 0 1\n3 0\n0 0 1\n1 1 2\n2 2 0\n0\n",
      std::string(
          "# A\n4 2 1 1\n1 0 0 0.5 7\n2 4 0 1 7\n3 4 4 2 7\n4 0 4 3 8\n5 1\n1 1 2 1\n2 2 3 2\n3 3 4 3\n") +
          "4 4 1 4\n5 1 3 9\n1\n1 0.5 3\n1\n1 3 0.5 2.5 0.1\n",
      "0 2 0 0\n3 1\n1 1 2 5\n2 2 3 5\n3 3 1 5\n0\n=\n3 2 0 0\n1 0 0\n2 1e3 0\n3 0 -2.5\n",
      std::string("6 2 0 0\r\n0 0 0\r\n1 2 2\r\n2 0 2\r\n3 2 0\r\n4 1 1\r\n5 0 0\r\n") +
          "3 0\r\n0 0 1\r\n1 2 3\r\n2 0 5\r\n0\r\n",
      "0 2 0 0\n0 0\n0\n",
      "2147483647 2 65536 1\n",
  };
}
