/// NPY 1.0, 2.0 and 3.0 (NumPy Enhancement Proposal 1): one array, with a header in Python's notation.
#pragma once

#include "dovetail/io/input_file.hpp"
#include "dovetail/io/points.hpp"

#include <string>
#include <vector>

namespace dovetail {

/// Local. Takes float64 and float32, little endian, N x k with k >= 2, in C or Fortran order; and N records
/// with one number each in fields of these types, integers of up to 32 bits, or bool, of which two are named
/// x and y (in small or capital letters). Errors (input): not NPY, malformed header, another type or shape, a
/// length that is not what the header says.
PointFile read_npy_header(const InputFile &file);

/// The header of an array of float64 in C order, version 1.0 where it is not too long for that and in ASCII;
/// its length is a multiple of 64.
std::string npy_header(GlobalIndex rows, int columns);

/// The same for records of float64 fields with these names.
std::string npy_records_header(GlobalIndex rows, const std::vector<std::string> &names);
/// The same for any type ("<i8") and shape ("(5,)", "(5, 3)"), both in NumPy's notation.
std::string npy_array_header(const std::string &type, const std::string &shape);

} // namespace dovetail
