/// Room for a file, asked for before anybody starts to fill it. Local; private to io.
#pragma once

#include <cstdint>
#include <string>

namespace dovetail {

/// Throws Error (resource) about `path` if neither the disk that holds `aside` nor this process's file size
/// limit leaves room for so many bytes, as far as the system tells. Better said before an hour of writing
/// than after it.
void check_disk_space(const std::string &path, const std::string &aside, std::int64_t bytes);

/// Makes the disk set aside the first `bytes` bytes of the file `aside`; throws Error (output) about `path`.
/// Where the file system cannot promise space nothing is done, and a full disk shows when writing.
void reserve_disk_space(const std::string &path, const std::string &aside, std::int64_t bytes);

} // namespace dovetail
