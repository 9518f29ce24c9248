// The reader of mesh files. An input is a list of edits to a valid file: raw bytes would break HDF5's own
// metadata, which has checksums, and test HDF5 instead of what is read with it.
//
// Byte 0 chooses the file. Then every 12 bytes are an edit: what (2 bytes), where (2), and a value (8).
// Numbers in datasets are changed in place; attributes, and datasets as a whole, through HDF5.
#include "target.hpp"

#include "dovetail/comm/communicator.hpp"
#include "dovetail/distributed/triangulate.hpp"
#include "dovetail/distributed/validate.hpp"
#include "dovetail/io/mesh.hpp"
#include "dovetail/mesh/checksum.hpp"
#include "dovetail/mesh/divide_and_conquer.hpp"

#include <boost/mpi/communicator.hpp>
#include <boost/mpi/environment.hpp>
#include <fcntl.h>
#include <hdf5.h>
#include <unistd.h>

#include <array>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>

using namespace dovetail;

namespace {

struct Dataset {
  std::string name;
  std::size_t offset, bytes; // in the file
  std::size_t width;         // of a number
};
struct MeshFile {
  std::string bytes;
  std::vector<Dataset> datasets;
  std::vector<std::pair<std::string, std::string>> attributes; // object, name
};

// Where the datasets are: those with numbers in them.
herr_t note_dataset(hid_t file, const char *name, const H5O_info_t *info, void *into) {
  MeshFile &mesh = *static_cast<MeshFile *>(into);
  const hid_t object = H5Oopen(file, name, H5P_DEFAULT);
  const auto note = [](hid_t, const char *attribute, const H5A_info_t *, void *attributes) -> herr_t {
    static_cast<std::vector<std::string> *>(attributes)->push_back(attribute);
    return 0;
  };
  std::vector<std::string> attributes;
  H5Aiterate2(object, H5_INDEX_NAME, H5_ITER_INC, nullptr, note, &attributes);
  for (const std::string &attribute : attributes)
    mesh.attributes.emplace_back(name, attribute);
  if (info->type == H5O_TYPE_DATASET) {
    const hid_t type = H5Dget_type(object);
    const std::size_t width = H5Tget_class(type) == H5T_STRING ? 1 : H5Tget_size(type);
    mesh.datasets.push_back({name, H5Dget_offset(object), H5Dget_storage_size(object), width});
    H5Tclose(type);
  }
  H5Oclose(object);
  return 0;
}

class Meshes {
public:
  Meshes() : comm_(Communicator::duplicate(boost::mpi::communicator())) {
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
    path_ =
        std::filesystem::temp_directory_path() / ("dovetail-fuzz-" + std::to_string(::getpid()) + ".vtkhdf");
    std::mt19937 random(1);
    add(
        1,
        [](int) {
          return Point{0.5, 0.25};
        },
        3, AxisChoice::x);
    add(
        40,
        [&](int) {
          return Point{static_cast<double>(random() % 997), static_cast<double>(random() % 997)};
        },
        3, AxisChoice::x);
    add(
        30,
        [](int i) {
          const int row = i % 25 / 5;
          return Point{static_cast<double>(i % 5), static_cast<double>(row)};
        },
        2, AxisChoice::y);
    add(
        6,
        [](int i) {
          return Point{static_cast<double>(i), 2.0 * i};
        },
        1, AxisChoice::x);
  }
  ~Meshes() { std::filesystem::remove(path_); }

  const Communicator &comm() const { return comm_; }
  const std::string &path() const { return path_; }
  const MeshFile &file(std::size_t number) const { return files_[number % files_.size()]; }
  void put(const std::string &bytes) const {
    const int descriptor = ::open(path_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
    fuzz::expect(descriptor >= 0 &&
                     ::write(descriptor, bytes.data(), bytes.size()) == static_cast<ssize_t>(bytes.size()),
                 "room for a small file");
    ::close(descriptor);
  }

private:
  template <class PointOf> void add(int count, PointOf &&point_of, int slabs, AxisChoice axis) {
    PointTable table;
    table.attributes = {{"z", {}}, {"marker", {}}};
    for (int i = 0; i < count; ++i) {
      table.points.push_back(point_of(i));
      table.input_index.push_back(i);
      table.attributes[0].values.push_back(0.25 * i);
      table.attributes[1].values.push_back(i % 3);
    }
    TriangulateOptions options;
    options.slabs.slabs = slabs;
    options.slabs.axis = axis;
    DistributedMesh mesh = triangulate(comm_, std::move(table), options);
    mesh.coordinate_system.push_back({"LASF_Projection", 2112, "WKT", {'P', 'R', 'O', 'J'}});
    write_mesh(comm_, mesh, path_);
    std::ifstream written(path_, std::ios::binary);
    MeshFile file{{std::istreambuf_iterator<char>(written), {}}, {}, {}};
    const hid_t id = H5Fopen(path_.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
    H5Ovisit(id, H5_INDEX_NAME, H5_ITER_INC, note_dataset, &file);
    H5Fclose(id);
    fuzz::expect(file.datasets.size() > 15 && file.attributes.size() > 5, "a mesh file as it should be");
    files_.push_back(std::move(file));
  }

  boost::mpi::environment environment_;
  Communicator comm_;
  std::string path_;
  std::vector<MeshFile> files_;
};

const Meshes &meshes() {
  static const Meshes all;
  return all;
}

struct Edit {
  std::uint16_t what, where;
  std::int64_t value;
};
constexpr std::size_t edit_bytes = 12;
constexpr std::size_t most_edits = 8;

std::vector<Edit> edits_of(const std::uint8_t *data, std::size_t size) {
  std::vector<Edit> edits;
  for (; size >= edit_bytes && edits.size() < most_edits; data += edit_bytes, size -= edit_bytes) {
    Edit edit{};
    std::memcpy(&edit.what, data, 2);
    std::memcpy(&edit.where, data + 2, 2);
    std::memcpy(&edit.value, data + 4, 8);
    edits.push_back(edit);
  }
  return edits;
}

// What an edit is about: first the numbers, then the attributes, then datasets as a whole.
struct Target {
  enum Kind { number, attribute, dataset } kind;
  std::size_t index;
};
Target target_of(const MeshFile &file, std::uint16_t what) {
  const std::size_t numbers = file.datasets.size(), attributes = file.attributes.size();
  const std::size_t index = what % (3 * numbers + attributes); // numbers twice as often
  if (index < 2 * numbers)
    return {Target::number, index % numbers};
  if (index < 2 * numbers + attributes)
    return {Target::attribute, index - 2 * numbers};
  return {Target::dataset, index - 2 * numbers - attributes};
}

void change_number(std::string &bytes, const Dataset &dataset, const Edit &edit) {
  if (dataset.bytes < dataset.width || dataset.width > sizeof edit.value)
    return;
  const std::size_t at = dataset.offset + edit.where % (dataset.bytes / dataset.width) * dataset.width;
  if (at + dataset.width <= bytes.size())
    std::memcpy(bytes.data() + at, &edit.value, dataset.width);
}

void change_attribute(hid_t file, const std::string &object, const std::string &name, const Edit &edit) {
  if (edit.where % 4 == 0) {
    H5Adelete_by_name(file, object.c_str(), name.c_str(), H5P_DEFAULT);
    return;
  }
  const hid_t attribute = H5Aopen_by_name(file, object.c_str(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT);
  if (attribute < 0)
    return;
  const hid_t type = H5Aget_type(attribute);
  std::string value(std::max<std::size_t>(H5Tget_size(type), sizeof edit.value), '\0');
  std::memcpy(value.data(), &edit.value, sizeof edit.value);
  H5Awrite(attribute, type, value.data());
  H5Tclose(type);
  H5Aclose(attribute);
}

// Another dataset, or a group, or none, under the same name.
void replace_dataset(hid_t file, const std::string &name, const Edit &edit) {
  const std::array types{H5T_STD_I64LE, H5T_IEEE_F64LE, H5T_STD_I32LE, H5T_STD_U8LE, H5T_STD_I64BE, H5T_C_S1};
  H5Ldelete(file, name.c_str(), H5P_DEFAULT);
  if (edit.where % 8 == 0)
    return;
  if (edit.where % 8 == 1) {
    const hid_t group = H5Gcreate2(file, name.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    H5Gclose(group);
    return;
  }
  const auto size = [&](int byte) { return static_cast<hsize_t>(edit.value >> 8 * byte & 0xff); };
  const std::array<hsize_t, 2> extent{size(0), edit.where % 8 < 4 ? 3 : size(1)};
  // 0 to 2 dimensions, contiguous or in chunks.
  const hid_t space = H5Screate_simple(static_cast<int>(size(2) % 3), extent.data(), nullptr);
  const hid_t properties = H5Pcreate(H5P_DATASET_CREATE);
  if (size(3) % 8 == 0 && extent[0] > 0 && extent[1] > 0)
    H5Pset_chunk(properties, static_cast<int>(size(2) % 3), extent.data());
  if (size(3) % 2 == 0)
    H5Pset_alloc_time(properties, H5D_ALLOC_TIME_EARLY);
  const hid_t dataset = H5Dcreate2(file, name.c_str(), types[size(4) % types.size()], space, H5P_DEFAULT,
                                   properties, H5P_DEFAULT);
  if (dataset >= 0)
    H5Dclose(dataset);
  H5Pclose(properties);
  H5Sclose(space);
}

void put_edited(const MeshFile &file, const std::vector<Edit> &edits) {
  std::string bytes = file.bytes;
  bool through_hdf5 = false;
  for (const Edit &edit : edits) {
    const Target target = target_of(file, edit.what);
    if (target.kind == Target::number)
      change_number(bytes, file.datasets[target.index], edit);
    else
      through_hdf5 = true;
  }
  meshes().put(bytes);
  if (!through_hdf5)
    return;
  const hid_t id = H5Fopen(meshes().path().c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  for (const Edit &edit : edits) {
    const Target target = target_of(file, edit.what);
    if (target.kind == Target::attribute)
      change_attribute(id, file.attributes[target.index].first, file.attributes[target.index].second, edit);
    if (target.kind == Target::dataset)
      replace_dataset(id, file.datasets[target.index].name, edit);
  }
  H5Fclose(id);
}

// `validate` has said that it is right: then it is what the kernel makes of the sites, which knows nothing of
// slabs, paths and ghosts.
void expect_canonical(const DistributedMesh &mesh) {
  std::vector<Point> sites;
  for (const SlabMesh &slab : mesh.slabs)
    sites.insert(sites.end(), slab.vertices.points.begin(), slab.vertices.points.begin() + slab.own_count);
  const Triangulation triangles = delaunay(sites);
  fuzz::expect(triangles.triangle_count() == mesh.triangle_count(), "as many triangles as the sites have");
  fuzz::expect(checksum_of_sites(sites) + checksum_of_triangles(sites, triangles.corners) == mesh.checksum,
               "a valid mesh is the one that its sites have");
}

bool is_sound(const DistributedMesh &mesh) {
  try {
    require_sound_layout(meshes().comm(), mesh, meshes().path());
    return true;
  } catch (const Error &error) {
    fuzz::expect_helpful(error, meshes().path());
    return false;
  }
}

} // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t *data, std::size_t size) {
  if (size == 0)
    return 0;
  const MeshFile &file = meshes().file(data[0]);
  put_edited(file, edits_of(data + 1, size - 1));
  try {
    describe_mesh(meshes().comm(), meshes().path());
  } catch (const Error &error) {
    fuzz::expect_helpful(error, meshes().path());
  }
  try {
    const DistributedMesh mesh = read_mesh(meshes().comm(), meshes().path());
    const bool sound = is_sound(mesh);
    const ValidationReport report = validate(meshes().comm(), mesh);
    fuzz::expect(sound || !report.valid, "what cannot be walked over is not valid");
    for (const Violation &violation : report.first_violations)
      fuzz::expect_printable(violation.text);
    if (report.valid)
      expect_canonical(mesh);
    fuzz::expect(report.valid || size > edit_bytes, "a file without edits is valid");
  } catch (const Error &error) {
    fuzz::expect_helpful(error, meshes().path());
    fuzz::expect(size > edit_bytes, "a file without edits is read");
  }
  return 0;
}

std::vector<std::string> fuzz::seeds() {
  std::vector<std::string> seeds;
  for (int number = 0; number < 4; ++number) {
    const std::string file(1, static_cast<char>(number));
    seeds.push_back(file);
    const MeshFile &mesh = meshes().file(static_cast<std::size_t>(number));
    const std::size_t targets = 3 * mesh.datasets.size() + mesh.attributes.size();
    for (std::size_t what = mesh.datasets.size(); what < targets; ++what)
      for (const std::int64_t value : {std::int64_t{-1}, std::int64_t{1}, std::int64_t{1} << 62}) {
        const Edit edit{static_cast<std::uint16_t>(what), static_cast<std::uint16_t>(what + 5), value};
        std::string bytes(edit_bytes, '\0');
        std::memcpy(bytes.data(), &edit.what, 2);
        std::memcpy(bytes.data() + 2, &edit.where, 2);
        std::memcpy(bytes.data() + 4, &edit.value, 8);
        seeds.push_back(file + bytes);
      }
  }
  return seeds;
}
