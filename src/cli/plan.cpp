#include "plan.hpp"

#include "text.hpp"

#include "dovetail/base/error.hpp"
#include "dovetail/base/scratch_file.hpp"
#include "dovetail/comm/agreement.hpp"
#include "dovetail/comm/collectives.hpp"
#include "dovetail/comm/exchange.hpp"
#include "dovetail/comm/node_memory.hpp"
#include "dovetail/comm/phases.hpp"
#include "dovetail/io/output_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <stdexcept>
#include <utility>

namespace dovetail::cli {
namespace {

constexpr std::size_t sample_records = std::size_t{1} << 14;

std::string folder_of(const std::string &output) {
  const std::filesystem::path folder = std::filesystem::path(output_target(output)).parent_path();
  return output == "none" || folder.empty() ? "." : folder.string();
}

/// Even paths through every point, and all at once, would do no harm.
bool fits_anyway(const Undertaking &of) {
  const int slabs = of.slabs > 0 ? of.slabs : default_slab_count(of.points, of.ranks);
  constexpr std::int64_t bytes_at_worst = 500; // a point and path
  return of.points * bytes_at_worst < of.memory_bytes / (slabs + 1);
}

} // namespace

Plan plan_run(const Communicator &comm, const PointFiles &files, const SlabOptions &slabs, const Room &room,
              const std::string &output, bool streams, bool always) {
  Plan plan;
  plan.points = files.estimated_points();
  plan.scratch = room.scratch.empty() ? folder_of(output) : room.scratch;
  const std::int64_t told = default_memory_of_rank(comm);
  plan.memory_bytes = room.memory_bytes > 0 ? room.memory_bytes
                      : told > 0            ? told
                                            : std::numeric_limits<std::int64_t>::max() / 4;
  // The program itself has some already; allocators and the system want a little more than is asked of them.
  const std::int64_t present = all_reduce_max(comm, current_rss_bytes());
  plan.usable_bytes = std::max(plan.memory_bytes / 2, (plan.memory_bytes - present) / 10 * 9);

  Undertaking of;
  of.points = plan.points;
  of.attributes = static_cast<int>(files.attribute_names().size());
  of.ranks = comm.size();
  of.slabs = slabs.slabs;
  of.memory_bytes = plan.usable_bytes;
  of.axis = slabs.axis;
  of.on_disk = room.on_disk;
  of.keeps_mesh = !streams;
  std::vector<Point> sample;
  if (always || !fits_anyway(of)) {
    sample = collectively(
        comm, [&] { return comm.is_root() ? files.sample(sample_records) : std::vector<Point>(); });
    broadcast_bulk(comm, sample);
  }
  plan.forecast = collectively(comm, [&] { return forecast(of, std::move(sample)); });
  return plan;
}

void require_room(const Communicator &comm, const Plan &plan, const std::string &output, bool streams) {
  const Forecast &forecast = plan.forecast;
  if (!forecast.fits) {
    const double more = static_cast<double>(forecast.memory_bytes) / static_cast<double>(plan.usable_bytes);
    const auto enough = static_cast<std::int64_t>(more * 1.02 * static_cast<double>(plan.memory_bytes));
    const std::string other = streams ? "" : ", or name a .vtkhdf as output, which is written slab by slab";
    throw Error({ErrorKind::resource, "--memory", "",
                 fmt::format("{} a rank are too few: about {} are needed, with paths of {} sites through {}",
                             size_text(plan.memory_bytes), size_text(enough),
                             with_separators(forecast.path_sites), counted(forecast.slabs, "slab", "slabs")),
                 fmt::format("give --memory {}MiB{}{}", enough / (1 << 20) + 1,
                             forecast.slabs > comm.size() ? ", or fewer --slabs" : "", other)});
  }
  collectively(comm, [&] {
    if (!comm.is_root())
      return;
    const auto require = [](const std::string &folder, std::int64_t bytes, const char *what,
                            const char *remedy) {
      const std::int64_t room = free_bytes_in(folder);
      if (room >= 0 && room < bytes)
        throw Error({ErrorKind::resource, folder, "",
                     fmt::format("{} of about {} needs room, and the disk has {}", what, size_text(bytes),
                                 size_text(room)),
                     remedy});
    };
    const std::int64_t mesh = output == "none" ? 0 : forecast.mesh_bytes;
    const std::string folder = folder_of(output);
    require(folder, mesh, "a mesh", "make room, or name a file on another disk");
    std::error_code ignored;
    const bool same = std::filesystem::equivalent(folder, plan.scratch, ignored);
    if (forecast.on_disk)
      require(plan.scratch, forecast.scratch_bytes + (same ? mesh : 0),
              same ? "scratch with the mesh" : "scratch",
              "make room, let --scratch name a folder on another disk, or give more --memory");
  });
}

void print_plan(const Plan &plan, int ranks, bool writes) {
  const Forecast &forecast = plan.forecast;
  print_row("points", fmt::format("about {}", with_separators(plan.points)));
  print_row("slabs", fmt::format("{} cut along {}", with_separators(forecast.slabs),
                                 forecast.axis == Axis::x ? "x" : "y"));
  print_row("paths", fmt::format("about {} each", counted(forecast.path_sites, "site", "sites")));
  print_row("memory", fmt::format("at least {} of {} on each of {}; sites {}",
                                  size_text(forecast.memory_bytes + plan.memory_bytes - plan.usable_bytes),
                                  size_text(plan.memory_bytes), counted(ranks, "rank", "ranks"),
                                  forecast.on_disk ? "wait on disk" : "stay in memory"));
  print_row("scratch", forecast.on_disk
                           ? fmt::format("about {} in {}", size_text(forecast.scratch_bytes), plan.scratch)
                           : "none");
  if (writes)
    print_row("output", fmt::format("about {}", size_text(forecast.mesh_bytes)));
  print_row("time", fmt::format("about {}", rough_duration_text(forecast.seconds)));
}

std::int64_t bytes_from_text(const std::string &text) {
  std::size_t end = 0;
  double number = 0;
  try {
    number = std::stod(text, &end);
  } catch (const std::exception &) {
    throw std::invalid_argument("'" + text + "' is not a size such as 4GiB");
  }
  std::string unit;
  for (const char c : text.substr(end))
    if (c != ' ')
      unit.push_back(c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c);
  constexpr std::string_view letters = "KMGT";
  double factor = 1;
  if (const std::size_t power = unit.empty() ? letters.npos : letters.find(unit.front());
      power != letters.npos) {
    factor = std::pow(1024.0, static_cast<double>(power + 1));
    unit.erase(0, 1);
  }
  const double bytes = number * factor;
  if ((!unit.empty() && unit != "B" && unit != "IB") || !(bytes >= 1) || !(bytes < 0x1p62))
    throw std::invalid_argument("'" + text + "' is not a size such as 4GiB");
  return static_cast<std::int64_t>(bytes);
}

} // namespace dovetail::cli
