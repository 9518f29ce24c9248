#include "hdf5.hpp"

namespace dovetail::hdf5 {
namespace {

// Walked from the innermost function outwards: the first description is the system's or MPI's own word, and
// where MPI is meant, the next one may say more.
herr_t collect(unsigned depth, const H5E_error2_t *entry, void *data) {
  auto &text = *static_cast<std::string *>(data);
  if (depth > 1 || entry->desc == nullptr || *entry->desc == '\0')
    return 0;
  if (depth == 1 && text.find("MPI") == std::string::npos)
    return 0;
  text += (text.empty() ? "" : ", ") + std::string(entry->desc);
  return 0;
}

} // namespace

Quiet::Quiet() {
  H5Eget_auto2(H5E_DEFAULT, &function_, &data_);
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

Quiet::~Quiet() { H5Eset_auto2(H5E_DEFAULT, function_, data_); }

void fail(const std::string &what, const std::string &place) {
  std::string reason;
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, collect, &reason);
  H5Eclear2(H5E_DEFAULT);
  throw Failure(reason.empty() ? what : what + " (HDF5: " + reason + ")", place);
}

Handle::Handle(hid_t id, herr_t (*closer)(hid_t), const std::string &what, const std::string &place)
    : id_(id), close_(closer) {
  if (id < 0)
    fail(what, place);
}

Handle::~Handle() {
  if (id_ >= 0)
    close_(id_);
}

void Handle::close(const std::string &what) {
  if (id_ >= 0)
    check(close_(std::exchange(id_, H5I_INVALID_HID)), what);
}

void check(herr_t status, const std::string &what, const std::string &place) {
  if (status < 0)
    fail(what, place);
}

namespace {

struct Selection {
  Handle memory, file;
};

Selection select(const Column &column, std::int64_t first, std::int64_t count) {
  const std::array<hsize_t, 2> start{static_cast<hsize_t>(first), 0};
  const std::array<hsize_t, 2> size{static_cast<hsize_t>(count), static_cast<hsize_t>(column.width)};
  const int dimensions = column.width == 1 ? 1 : 2;
  Selection selection{
      Handle(H5Screate_simple(dimensions, size.data(), nullptr), H5Sclose, "cannot make a data space"),
      Handle(H5Dget_space(column.dataset.id()), H5Sclose, "cannot read its extent", column.name)};
  check(H5Sselect_hyperslab(selection.file.id(), H5S_SELECT_SET, start.data(), nullptr, size.data(), nullptr),
        "cannot select rows", column.name);
  return selection;
}

} // namespace

void read_rows(const Column &column, hid_t native, std::int64_t first, std::int64_t count, void *data) {
  const Selection selection = select(column, first, count);
  check(H5Dread(column.dataset.id(), native, selection.memory.id(), selection.file.id(), H5P_DEFAULT, data),
        "cannot be read", column.name);
}

Handle unlocked_access() {
  Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, "cannot make a property list");
#if H5_VERSION_GE(1, 10, 7)
  check(H5Pset_file_locking(access.id(), false, true), "cannot set file locking");
#endif
  return access;
}

} // namespace dovetail::hdf5
