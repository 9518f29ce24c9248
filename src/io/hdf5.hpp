/// HDF5's C interface with owners and errors. Private to io; Local unless said otherwise.
#pragma once

#include "dovetail/base/error.hpp"
#include "dovetail/base/types.hpp"

#include <hdf5.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace dovetail::hdf5 {

/// A call of HDF5 failed; what() says what was being done and the innermost reason on HDF5's error stack.
/// `place` names the object inside the file. Whoever knows the file makes an Error of it.
class Failure : public std::runtime_error {
public:
  Failure(const std::string &what, std::string place) : std::runtime_error(what), place_(std::move(place)) {}
  const std::string &place() const noexcept { return place_; }

private:
  std::string place_;
};

/// Keeps HDF5 from printing its error stack while it lives.
class Quiet {
public:
  Quiet();
  ~Quiet();
  Quiet(const Quiet &) = delete;
  Quiet &operator=(const Quiet &) = delete;

private:
  H5E_auto2_t function_ = nullptr;
  void *data_ = nullptr;
};

/// Throws Failure with the reason HDF5 has recorded.
[[noreturn]] void fail(const std::string &what, const std::string &place);

/// An identifier and the function that closes it.
class Handle {
public:
  Handle() = default;
  /// Takes what a call returned; a negative identifier becomes a Failure.
  Handle(hid_t id, herr_t (*closer)(hid_t), const std::string &what, const std::string &place = {});
  Handle(Handle &&other) noexcept : id_(std::exchange(other.id_, H5I_INVALID_HID)), close_(other.close_) {}
  Handle &operator=(Handle &&other) noexcept {
    std::swap(id_, other.id_);
    std::swap(close_, other.close_);
    return *this;
  }
  ~Handle();

  hid_t id() const { return id_; }
  /// Closes now, with an error where the destructor would be silent.
  void close(const std::string &what);

private:
  hid_t id_ = H5I_INVALID_HID;
  herr_t (*close_)(hid_t) = nullptr;
};

/// Throws Failure unless `status` is a success.
void check(herr_t status, const std::string &what, const std::string &place = {});

/// Numbers as they are in memory and as they are in a file, whatever the machine.
template <class T> struct NumberType;
#define DOVETAIL_HDF5_NUMBER(Type, Native, Stored)                                                           \
  template <> struct NumberType<Type> {                                                                      \
    static hid_t native() { return Native; }                                                                 \
    static hid_t stored() { return Stored; }                                                                 \
  };
DOVETAIL_HDF5_NUMBER(double, H5T_NATIVE_DOUBLE, H5T_IEEE_F64LE)
DOVETAIL_HDF5_NUMBER(std::int64_t, H5T_NATIVE_INT64, H5T_STD_I64LE)
DOVETAIL_HDF5_NUMBER(std::uint64_t, H5T_NATIVE_UINT64, H5T_STD_U64LE)
DOVETAIL_HDF5_NUMBER(std::int32_t, H5T_NATIVE_INT32, H5T_STD_I32LE)
DOVETAIL_HDF5_NUMBER(std::uint16_t, H5T_NATIVE_UINT16, H5T_STD_U16LE)
DOVETAIL_HDF5_NUMBER(std::uint8_t, H5T_NATIVE_UINT8, H5T_STD_U8LE)
#undef DOVETAIL_HDF5_NUMBER

/// An open dataset of `rows` x `width` numbers; of one dimension if width is 1.
struct Column {
  Handle dataset;
  std::string name;
  std::int64_t rows = 0;
  int width = 1;
};

/// Reads rows first .. first + count - 1.
void read_rows(const Column &column, hid_t native, std::int64_t first, std::int64_t count, void *data);

/// Rows of a column that fit into so many bytes; at least one.
template <class T> std::int64_t rows_within(std::int64_t bytes, int width) {
  return std::max<std::int64_t>(1, bytes / (static_cast<std::int64_t>(sizeof(T)) * width));
}

/// Reads `count` rows from row `first` on, piece by piece: take(begin, end, in) is given rows begin .. end -
/// 1, counted from `first`.
template <class T, class Take>
void read_in_pieces(const Column &column, std::int64_t first, std::int64_t count, std::int64_t buffer_bytes,
                    Take &&take) {
  const std::int64_t step = std::min(count, rows_within<T>(buffer_bytes, column.width));
  std::vector<T> buffer(static_cast<std::size_t>(step * column.width));
  for (std::int64_t begin = 0; begin < count; begin += step) {
    const std::int64_t end = std::min(count, begin + step);
    read_rows(column, NumberType<T>::native(), first + begin, end - begin, buffer.data());
    take(begin, end, static_cast<const T *>(buffer.data()));
  }
}

/// A file access property list without HDF5's file locks, which shared file systems often lack: a mesh is
/// written aside and renamed, so that nobody ever reads what somebody writes.
Handle unlocked_access();

} // namespace dovetail::hdf5
