/// Options that several subcommands share.
#pragma once

#include "command.hpp"
#include "progress.hpp"
#include "text.hpp"

#include "dovetail/base/progress.hpp"

#include <CLI/CLI.hpp>

#include <map>
#include <string>
#include <vector>

namespace dovetail::cli {

/// What the help texts say of mesh outputs; io/mesh.hpp has the details.
inline constexpr const char *mesh_outputs =
    R"(  .vtkhdf          all there is to know, for ParaView, VTK, h5py and dovetail itself
  .vtu             the whole mesh for VTK
  .pvtu            a part for each slab with its ghosts, NAME.0.vtu, NAME.1.vtu, ..., and their summary
  .ply             sites and triangles, binary, up to 2,147,483,647 of each
  .msh             Gmsh 4.1, binary, a partition for each slab
  .node .ele       Triangle's NAME.node, NAME.ele and NAME.neigh: nodes are the points of the input, all of
                   them in their order, from 0
  .npy             NAME.points.npy, NAME.triangles.npy, NAME.neighbours.npy, NAME.index.npy)";

/// How much a run tells, and to whom.
struct Telling {
  std::string report; ///< file; empty for none
  bool quiet = false;
  bool progress = false;
};
void add_telling_options(CLI::App &parser, Telling &telling);

/// For CLI11's check(): what is wrong with the name of an input that is empty, say from an unset variable of
/// a shell, or that means standard input.
std::string fault_of_name(const std::string &name);

/// Adds `--class 2,9`.
void add_class_option(CLI::App &parser, std::vector<int> &classes);

/// "auto, x, y", say.
template <class Value> std::string names_in(const std::map<std::string, Value> &words) {
  std::vector<std::string> names;
  names.reserve(words.size());
  for (const auto &[name, value] : words)
    names.push_back(name);
  return joined(names, ", ");
}

/// Adds an option whose value is one of `words`.
template <class Value>
CLI::Option *add_word_option(CLI::App &parser, const std::string &name, Value &value,
                             const std::map<std::string, Value> &words, const std::string &description) {
  return parser.add_option_function<std::string>(
      name,
      [&value, words, name](const std::string &word) {
        const auto found = words.find(word);
        if (found == words.end())
          throw CLI::ValidationError(name, "'" + word + "' is none of " + names_in(words));
        value = found->second;
      },
      description);
}

/// How progress is shown: only rank 0 is ever not silent.
ProgressStyle progress_style(bool is_root, const Telling &telling);

/// What the library calls while it works, to move the meter. It must not outlive the meter.
dovetail::Progress progress_into(ProgressMeter &meter);

} // namespace dovetail::cli
