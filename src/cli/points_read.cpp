#include "points_read.hpp"

#include "options.hpp"
#include "text.hpp"

#include <fmt/format.h>

#include <map>

namespace dovetail::cli {

void add_duplicates_option(CLI::App &parser, DuplicateRule &rule, const std::string &description) {
  static const std::map<std::string, DuplicateRule> rules{{"first", DuplicateRule::first},
                                                          {"lowest", DuplicateRule::lowest},
                                                          {"highest", DuplicateRule::highest},
                                                          {"error", DuplicateRule::error}};
  add_word_option(parser, "--duplicates", rule, rules, description)
      ->option_text("first|lowest|highest|error [first]");
}

const char *value_of_absent(const std::string &name) { return name == "z" ? "z = 0" : "NaN"; }

void print_points_read(const PointInput &input) {
  const auto files = static_cast<GlobalIndex>(input.files.size());
  print_row("read",
            fmt::format("{} from {}", counted(input.read, "point", "points"),
                        files == 1 ? input.files.front().file.path : counted(files, "file", "files")));
  if (input.withheld > 0)
    print_row("skipped", fmt::format("{} marked as withheld", counted(input.withheld, "point", "points")));
  if (input.other_class > 0)
    print_row("skipped", fmt::format("{} of other classes", counted(input.other_class, "point", "points")));
  for (const AbsentAttribute &absent : input.absent)
    print_row("notice", fmt::format("{} without {} got {}, because other files have it",
                                    counted(absent.points, "point", "points"), absent.name,
                                    value_of_absent(absent.name)));
  if (input.mixed_coordinate_systems)
    print_row("notice", "the files name different coordinate systems; coordinates are taken as they are");
}

} // namespace dovetail::cli
