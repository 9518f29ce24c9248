#include "point_readers.hpp"

#include "support/temporary_folder.hpp"

#include "dovetail/io/npy.hpp"

using namespace dovetail;
using testing::Bytes;

int LLVMFuzzerTestOneInput(const std::uint8_t *data, std::size_t size) {
  return fuzz::check_points(data, size, PointFormat::npy);
}

std::vector<std::string> fuzz::seeds() {
  std::vector<std::string> seeds;
  Bytes doubles;
  for (int i = 0; i < 12; ++i)
    doubles.add(i * 0.1 - 0.3);
  for (const char *const shape : {"(6, 2)", "(4, 3)", "(2, 6)", "(0, 2)"})
    seeds.push_back(npy_array_header("<f8", shape) + (shape[1] == '0' ? "" : doubles.text()));
  seeds.push_back(npy_array_header("<f4", "(8, 3)") + doubles.text());
  std::string fortran = npy_array_header("<f8", "(4, 3)");
  fortran.replace(fortran.find("False"), 5, "True ");
  seeds.push_back(fortran + doubles.text());
  seeds.push_back(npy_records_header(3, {"x", "y", "z", "class of it"}) + doubles.text());
  // NumPy's own spelling of records with small integers and padding, in its versions 2 and 3.
  const std::string dictionary =
      "{'descr': [('flag', '|b1'), ('', '|V3'), ('Y', '<f4'), ('X', '<f8'), ('n', '<i2'), ('m', '<u4'), "
      "('k', '|i1')], 'fortran_order': False, 'shape': (2,), }\n";
  for (const char version : {'\2', '\3'}) {
    Bytes bytes;
    bytes.add_text("\x93NUMPY").add(version).add('\0').add(static_cast<std::uint32_t>(dictionary.size()));
    bytes.add_text(dictionary);
    for (int i = 0; i < 2; ++i)
      bytes.add_zeros(4)
          .add(1.5f * static_cast<float>(i))
          .add(-2.5 * i)
          .add(std::int16_t{-3})
          .add(~0U)
          .add('\4');
    seeds.push_back(bytes.text());
  }
  return seeds;
}
