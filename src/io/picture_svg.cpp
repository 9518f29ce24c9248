// The picture as an SVG: every rank writes the text of its own triangles.
#include "picture_font.hpp"
#include "picture_scene.hpp"

#include "dovetail/comm/agreement.hpp"
#include "dovetail/comm/collectives.hpp"
#include "dovetail/io/output_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

namespace dovetail::picture {
namespace {

std::string colour_text(Colour c) { return fmt::format("#{:02x}{:02x}{:02x}", c.red, c.green, c.blue); }

/// A text that all ranks write one after another.
class SvgOutput {
public:
  SvgOutput(const Communicator &comm, OutputFile &file) : comm_(comm), file_(file) {}

  /// Collective: what every rank makes, in the order of the ranks.
  template <class Make> void add(Make &&make) {
    const std::string text = collectively(comm_, make);
    const auto bytes = static_cast<std::int64_t>(text.size());
    const std::int64_t begin = end_ + exclusive_scan(comm_, bytes);
    collectively(comm_, [&] { file_.write_at(begin, std::as_bytes(std::span(text))); });
    end_ += all_reduce_sum(comm_, bytes);
  }
  /// Collective: what the root makes.
  template <class Make> void add_from_root(Make &&make) {
    add([&] { return comm_.is_root() ? std::string(make()) : std::string(); });
  }

private:
  const Communicator &comm_;
  OutputFile &file_;
  std::int64_t end_ = 0;
};

std::string head(const Layout &layout) {
  const Box map = layout.view.map;
  return fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} {1}\">\n"
      "<rect width=\"{0}\" height=\"{1}\" fill=\"{2}\"/>\n"
      "<clipPath id=\"map\"><rect x=\"{3}\" y=\"{4}\" width=\"{5}\" height=\"{6}\"/></clipPath>\n"
      "<g clip-path=\"url(#map)\" stroke-linejoin=\"round\" stroke-linecap=\"round\">\n",
      layout.width, layout.height, colour_text(paper), map.x, map.y, map.width, map.height);
}

std::string polygons(const Scene &scene) {
  std::string text;
  for (const SlabMesh &slab : scene.mesh.slabs)
    for (LocalIndex t = 0; t < slab.triangles.triangle_count(); ++t) {
      const auto p = corners_in_pixels(scene, slab, t);
      const DrawnTriangle drawn = drawn_triangle(scene, slab, t, p);
      // Without an edge of some colour, a seam would show between triangles.
      const bool edged = drawn.edge_half_width > 0;
      fmt::format_to(std::back_inserter(text),
                     "<polygon points=\"{:.2f},{:.2f} {:.2f},{:.2f} {:.2f},{:.2f}\" fill=\"{}\"", p[0].x,
                     p[0].y, p[1].x, p[1].y, p[2].x, p[2].y, colour_text(drawn.colour));
      if (edged)
        fmt::format_to(std::back_inserter(text), " stroke-width=\"{:.2f}\"/>\n", 2 * drawn.edge_half_width);
      else
        fmt::format_to(std::back_inserter(text), " stroke=\"{}\" stroke-opacity=\"1\"/>\n",
                       colour_text(drawn.colour));
    }
  return text;
}

std::string hull_lines(const Scene &scene) {
  std::string text;
  for (const SlabMesh &slab : scene.mesh.slabs)
    for_each_hull_edge(scene, slab, [&](Point a, Point b) {
      fmt::format_to(std::back_inserter(text),
                     "<line x1=\"{:.2f}\" y1=\"{:.2f}\" x2=\"{:.2f}\" y2=\"{:.2f}\"/>\n", a.x, a.y, b.x, b.y);
    });
  return text;
}

std::string path_lines(const Scene &scene) {
  std::string text;
  for (const auto &path : scene.paths) {
    if (path.empty())
      continue;
    text += "<polyline points=\"";
    for (const Point site : path) {
      const Point p = scene.layout.view.to_pixels(site);
      fmt::format_to(std::back_inserter(text), "{:.2f},{:.2f} ", p.x, p.y);
    }
    text.back() = '"';
    text += "/>\n";
  }
  return text;
}

std::string tail(const Layout &layout) {
  std::string text = "</g>\n";
  for (const Swatch &swatch : layout.swatches)
    fmt::format_to(std::back_inserter(text),
                   "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"{}\"/>\n", swatch.box.x,
                   swatch.box.y, swatch.box.width, swatch.box.height, colour_text(swatch.colour));
  for (const Text &line : layout.texts) // digits, letters and harmless signs alone
    fmt::format_to(std::back_inserter(text),
                   "<text x=\"{}\" y=\"{}\" font-family=\"monospace\" font-size=\"{}\" textLength=\"{}\" "
                   "fill=\"{}\">{}</text>\n",
                   line.x, line.y + 7 * layout.dot, 9 * layout.dot,
                   static_cast<int>(line.text.size()) * letter_advance * layout.dot, colour_text(text_colour),
                   line.text);
  return text + "</svg>\n";
}

} // namespace

void write_svg(const Communicator &comm, const Scene &scene, const std::string &path) {
  const Layout &layout = scene.layout;
  const Colouring colouring = scene.options.colouring;
  OutputFile file(comm, path);
  SvgOutput output(comm, file);
  output.add_from_root([&] {
    return head(layout) + fmt::format("<g stroke=\"{}\" stroke-opacity=\"{:.2f}\" stroke-width=\"0.3\">\n",
                                      colour_text(edge_colour(colouring)), edge_weight(colouring) / 255.0);
  });
  output.add([&] { return polygons(scene); });
  const auto add_lines = [&](Colour colour, double half_width, auto &&lines) {
    output.add_from_root([&] {
      return fmt::format("</g>\n<g fill=\"none\" stroke=\"{}\" stroke-width=\"{:.2f}\">\n",
                         colour_text(colour), 2 * half_width);
    });
    output.add([&] { return lines(scene); });
  };
  // In the order of LineLayer.
  add_lines(paper, casing_half_width(layout), path_lines);
  if (scene.options.hull)
    add_lines(hull_colour, hull_half_width(layout), hull_lines);
  add_lines(path_colour, path_half_width(layout), path_lines);
  output.add_from_root([&] { return "</g>\n" + tail(layout); });
  file.commit();
}

} // namespace dovetail::picture
