/// What sorting in memory and on disk have in common once all sites are in order. Private to distributed.
#pragma once

#include "dovetail/comm/communicator.hpp"
#include "dovetail/distributed/slabs.hpp"

#include <string>
#include <vector>

namespace dovetail {

/// How the sites of all ranks are to be shared out.
struct Division {
  std::vector<GlobalIndex> slab_begins; ///< and the end
  std::vector<GlobalIndex> rank_begins; ///< and the end
};

/// Collective. `slabs` of them; 0: default_slab_count.
Division division_of(const Communicator &comm, GlobalIndex sites, int slabs);

/// Local. Fills site_offsets and the rank's range of slabs; an Error, on all ranks alike, if slabs are too
/// large for local indices.
void take_division(const Communicator &comm, Division &&division, const std::string &subject, Slabs &slabs);

/// Collective. The lines of all borders, once the sites are where they belong.
std::vector<double> lines_of(const Communicator &comm, const Slabs &slabs);

/// Collective. Under DuplicateRule::error, the first site in the total order that has equal points is the
/// fault.
void refuse_duplicates(const Communicator &comm, const Slabs &slabs, const std::string &subject);

/// Local. The rows of consecutive own sites.
PointTable table_of_sites(const Slabs &slabs, GlobalIndex first, GlobalIndex count);

} // namespace dovetail
