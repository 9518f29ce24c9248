/// dovetail verify for meshes of domains.
#pragma once

#include "report.hpp"

#include "dovetail/base/progress.hpp"
#include "dovetail/distributed/mesh.hpp"
#include "dovetail/mesh/validate_domain.hpp"

#include <string>
#include <vector>

namespace dovetail::cli {

/// What was found wrong with a mesh of a domain, and what was looked at.
struct DomainVerdict {
  DomainReport found;              ///< of the mesh by itself
  GlobalIndex left_triangles = 0;  ///< below the bound, where the mesh says that refinement had to stop
  GlobalIndex chains = 0;          ///< of segments given, followed
  GlobalIndex compared = 0;        ///< vertices and segments compared with the domain file
  std::vector<std::string> faults; ///< all that is wrong, a few of each kind in words
  bool only_the_domain_differs = false;
  bool valid() const { return faults.empty(); }
};

/// Local. `domain_file`: the file that the mesh must be a mesh of, or empty. The layout must be sound.
DomainVerdict verify_domain(const DistributedMesh &mesh, const std::string &domain_file);

void print_verdict(const DistributedMesh &mesh, const DomainVerdict &verdict);
void report_verdict(const DistributedMesh &mesh, const DomainVerdict &verdict, Report &report);

} // namespace dovetail::cli
