#include "dovetail/comm/node_memory.hpp"

#include "dovetail/comm/collectives.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <limits>
#include <sstream>

namespace dovetail {
namespace {

constexpr std::int64_t unlimited = std::numeric_limits<std::int64_t>::max();

/// The number in a file; "max", a missing file and anything else are no limit.
std::int64_t limit_in(const std::string &path) {
  std::ifstream file(path);
  std::int64_t bytes = 0;
  return file >> bytes && bytes > 0 ? bytes : unlimited;
}

/// The least limit of a group and of those that it is in.
std::int64_t limit_of_group(const std::string &mount, std::string group, const std::string &name) {
  std::int64_t limit = limit_in(mount + "/" + name);
  for (; group.size() > 1; group.erase(group.rfind('/')))
    limit = std::min(limit, limit_in(fmt::format("{}{}/{}", mount, group, name)));
  return limit;
}

/// Lines are "number:controllers:/group"; version 2 has the number 0 and no controllers.
std::int64_t limit_of_groups(const std::string &root) {
  std::ifstream groups(root + "/proc/self/cgroup");
  std::int64_t limit = unlimited;
  for (std::string line; std::getline(groups, line);) {
    const std::size_t first = line.find(':'), second = line.find(':', first + 1);
    if (first == std::string::npos || second == std::string::npos)
      continue;
    std::string controllers = line.substr(first, second - first + 1);
    controllers.front() = controllers.back() = ',';
    const std::string group = line.substr(second + 1);
    if (controllers == ",,")
      limit = std::min(limit, limit_of_group(root + "/sys/fs/cgroup", group, "memory.max"));
    else if (controllers.find(",memory,") != std::string::npos)
      limit = std::min(limit, limit_of_group(root + "/sys/fs/cgroup/memory", group, "memory.limit_in_bytes"));
  }
  return limit;
}

std::int64_t machine_bytes(const std::string &root) {
  std::ifstream file(root + "/proc/meminfo");
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    std::string name;
    std::int64_t kilobytes = 0;
    if (words >> name >> kilobytes && name == "MemTotal:")
      return 1024 * kilobytes;
  }
  return 0;
}

} // namespace

std::int64_t node_memory_bytes(const std::string &root) {
  const std::int64_t machine = machine_bytes(root);
  return machine == 0 ? 0 : std::min(machine, limit_of_groups(root));
}

std::int64_t default_memory_of_rank(const Communicator &comm) {
  MPI_Comm node = MPI_COMM_NULL;
  int ranks = 1;
  MPI_Comm_split_type(comm.raw(), MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &node);
  MPI_Comm_size(node, &ranks);
  MPI_Comm_free(&node);
  return all_reduce_min(comm, node_memory_bytes() / 10 * 7 / ranks);
}

} // namespace dovetail
