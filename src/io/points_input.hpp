/// What is known of point files before any record is read. Private to io.
#pragma once

#include "points_share.hpp"

#include "dovetail/comm/communicator.hpp"

#include <span>
#include <string>

namespace dovetail {

/// Collective. The headers of all files, the attributes that any of them has, and their coordinate systems.
PointInput open_input(const Communicator &comm, std::span<const std::string> paths,
                      const PointReading &reading);

/// Local. All, unless some are chosen. Error (usage): a class that is none.
LasClasses chosen_classes(const PointReading &reading);

} // namespace dovetail
