// A folder that all ranks of a test share and that is gone afterwards, and files made of bytes.
#pragma once

#include "dovetail/comm/collectives.hpp"
#include "dovetail/comm/communicator.hpp"
#include "dovetail/comm/serialization.hpp"
#include "dovetail/io/little_endian.hpp"

#include <cstddef>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>

namespace dovetail::testing {

// The bytes of a file, built field by field, little endian.
class Bytes {
public:
  template <class Number> Bytes &add(Number number) {
    char raw[sizeof(Number)];
    store_little(number, reinterpret_cast<std::byte *>(raw));
    text_.append(raw, sizeof raw);
    return *this;
  }
  // Text, filled with NUL up to `width`.
  Bytes &add_text(std::string_view text, std::size_t width) {
    text_ += text.substr(0, width);
    return add_zeros(width - std::min(width, text.size()));
  }
  Bytes &add_text(std::string_view text) { return add_text(text, text.size()); }
  Bytes &add_zeros(std::size_t count) {
    text_.append(count, '\0');
    return *this;
  }
  template <class Number> Bytes &set(std::size_t offset, Number number) {
    store_little(number, reinterpret_cast<std::byte *>(text_.data() + offset));
    return *this;
  }
  std::size_t size() const { return text_.size(); }
  const std::string &text() const { return text_; }

private:
  std::string text_;
};

// Collective: made and removed by the root.
class TemporaryFolder {
public:
  explicit TemporaryFolder(const Communicator &comm) : comm_(comm) {
    if (comm.is_root()) {
      path_ = (std::filesystem::temp_directory_path() / "dovetail-XXXXXX").string();
      if (::mkdtemp(path_.data()) == nullptr)
        std::abort();
    }
    broadcast(comm, path_);
  }
  TemporaryFolder(const TemporaryFolder &) = delete;
  TemporaryFolder &operator=(const TemporaryFolder &) = delete;
  ~TemporaryFolder() {
    MPI_Barrier(comm_.raw());
    if (comm_.is_root())
      std::filesystem::remove_all(path_);
  }

  std::string file(const std::string &name) const { return path_ + "/" + name; }

  // Collective: the path of a file with these bytes.
  std::string make(const std::string &name, const std::string &bytes) const {
    if (comm_.is_root())
      std::ofstream(file(name), std::ios::binary) << bytes;
    MPI_Barrier(comm_.raw());
    return file(name);
  }

private:
  const Communicator &comm_;
  std::string path_;
};

inline std::string content_of(const std::string &path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

} // namespace dovetail::testing
