// The picture as a PNG: every rank draws, every rank adds up some rows, the root compresses.
#include "picture_scene.hpp"
#include "png_file.hpp"

#include "dovetail/comm/agreement.hpp"
#include "dovetail/comm/exchange.hpp"
#include "dovetail/io/output_file.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace dovetail::picture {
namespace {

template <class T> std::size_t at(T index) { return static_cast<std::size_t>(index); }

/// A pixel on its way to the rank that adds up its row.
struct PlacedPixel {
  int row, column;
  PixelSum sum;
};

struct Rows {
  int begin, end;
};

/// The rows of a band that a rank adds up.
Rows share_of(Rows band, int rank, int ranks) {
  const auto cut = [&](int r) {
    return band.begin + static_cast<int>(std::int64_t{band.end - band.begin} * r / ranks);
  };
  return {cut(rank), cut(rank + 1)};
}

/// The columns that a rank's slabs and lines can touch, within the map.
Box columns_of(const Scene &scene) {
  const Box map = scene.layout.view.map;
  double first = map.x + map.width;
  double last = map.x;
  const auto include = [&](Point site) {
    const double x = scene.layout.view.to_pixels(site).x;
    first = std::min(first, x);
    last = std::max(last, x);
  };
  for (const SlabMesh &slab : scene.mesh.slabs)
    for (const Point site : slab.vertices.points)
      include(site);
  for (const auto &path : scene.paths)
    for (const Point site : path)
      include(site);
  const double reach = 4 + 4 * scene.layout.dot; // of the widest line
  const auto clamped = [&](double x) {
    return static_cast<int>(
        std::clamp(x, static_cast<double>(map.x), static_cast<double>(map.x + map.width)));
  };
  const int begin = clamped(std::floor(first - reach));
  return {begin, map.y, std::max(0, clamped(std::ceil(last + reach)) - begin), map.height};
}

void draw_triangles(const Scene &scene, PixelBand &band) {
  for (const SlabMesh &slab : scene.mesh.slabs)
    for (LocalIndex t = 0; t < slab.triangles.triangle_count(); ++t) {
      const auto corners = corners_in_pixels(scene, slab, t);
      const auto [low, high] = std::minmax({corners[0].y, corners[1].y, corners[2].y});
      if (!(high >= band.first_row - 1.0) || !(low <= band.first_row + band.rows + 1.0))
        continue;
      const auto [left, right] = std::minmax({corners[0].x, corners[1].x, corners[2].x});
      if (!(right >= band.first_column - 1.0) || !(left <= band.first_column + band.columns + 1.0))
        continue;
      const DrawnTriangle drawn = drawn_triangle(scene, slab, t, corners);
      fill_triangle(band, corners, drawn.colour);
      if (drawn.edge_half_width > 0)
        for (std::size_t i = 0; i < 3; ++i)
          draw_segment(band, corners[i], corners[(i + 1) % 3], drawn.edge_half_width, LineLayer::edges);
    }
}

PixelBand draw_band(const Scene &scene, Rows rows, Box columns) {
  PixelBand band(rows.begin, rows.end - rows.begin, columns.x, columns.width);
  draw_triangles(scene, band);
  const Layout &layout = scene.layout;
  if (scene.options.hull)
    for (const SlabMesh &slab : scene.mesh.slabs)
      for_each_hull_edge(scene, slab, [&](Point from, Point to) {
        draw_segment(band, from, to, hull_half_width(layout), LineLayer::hull);
      });
  for (const auto &path : scene.paths)
    for (std::size_t i = 1; i < path.size(); ++i) {
      const Point from = layout.view.to_pixels(path[i - 1]);
      const Point to = layout.view.to_pixels(path[i]);
      draw_segment(band, from, to, casing_half_width(layout), LineLayer::casing);
      draw_segment(band, from, to, path_half_width(layout), LineLayer::paths);
    }
  return band;
}

/// What goes to whom.
struct Parcels {
  std::vector<PlacedPixel> pixels;
  std::vector<std::int64_t> counts;
};

Parcels pack(PixelBand &band, Rows rows, int ranks) {
  Parcels parcels;
  for (int rank = 0; rank < ranks; ++rank) {
    const Rows share = share_of(rows, rank, ranks);
    const std::size_t before = parcels.pixels.size();
    for (int row = share.begin; row < share.end; ++row)
      for (int column = 0; column < band.columns; ++column)
        if (const PixelSum &sum = band.row(row)[column]; !sum.is_empty())
          parcels.pixels.push_back({row, band.first_column + column, sum});
    parcels.counts.push_back(static_cast<std::int64_t>(parcels.pixels.size() - before));
  }
  return parcels;
}

/// The colours of some rows of the map, from what all ranks drew there.
std::vector<Colour> add_up(const Scene &scene, Rows share, std::span<const PlacedPixel> arrived) {
  const Box map = scene.layout.view.map;
  PixelBand band(share.begin, share.end - share.begin, map.x, map.width);
  for (const PlacedPixel &pixel : arrived)
    band.row(pixel.row)[pixel.column - map.x].add(pixel.sum);
  const Colouring colouring = scene.options.colouring;
  const std::array<Ink, line_layers> inks{{{edge_colour(colouring), edge_weight(colouring)},
                                           {paper, 255},
                                           {hull_colour, 255},
                                           {path_colour, 255}}};
  std::vector<Colour> colours;
  colours.reserve(band.pixels.size());
  for (const PixelSum &pixel : band.pixels)
    colours.push_back(resolve(pixel, paper, inks));
  return colours;
}

/// Collective: the rows of the map on the root.
std::vector<Colour> rows_of_map(const Communicator &comm, const Scene &scene, Rows rows, Box columns) {
  const Parcels parcels = collectively(
      comm, [] { return "its pixels"; },
      [&] {
        PixelBand band = draw_band(scene, rows, columns);
        return pack(band, rows, comm.size());
      });
  const auto arrived = exchange<PlacedPixel>(comm, parcels.pixels, parcels.counts);
  const std::vector<Colour> own = collectively(
      comm, [] { return "its rows of the picture"; },
      [&] { return add_up(scene, share_of(rows, comm.rank(), comm.size()), arrived.data); });
  return gather_bulk<Colour>(comm, own).data;
}

/// The root's: encodes rows and writes what comes of them.
class PngOutput {
public:
  PngOutput(OutputFile &file, const Layout &layout)
      : file_(file), layout_(layout), encoder_(layout.width, layout.height) {}

  /// The next rows of the picture; `map` are the map's pixels of these rows, or nothing.
  void add(Rows rows, std::span<const Colour> map) {
    std::vector<Colour> pixels(at(rows.end - rows.begin) * at(layout_.width), paper);
    const Box box = layout_.view.map;
    for (std::size_t row = 0; row * at(box.width) < map.size(); ++row)
      std::copy_n(map.begin() + static_cast<std::ptrdiff_t>(row * at(box.width)), box.width,
                  pixels.begin() + static_cast<std::ptrdiff_t>(row * at(layout_.width) + at(box.x)));
    draw_around(layout_, rows.begin, rows.end - rows.begin, pixels);
    encoder_.add_rows(pixels);
    write();
  }
  void finish() {
    encoder_.finish();
    write();
  }

private:
  void write() {
    const std::vector<std::byte> bytes = encoder_.take();
    file_.write_at(offset_, bytes);
    offset_ += static_cast<std::int64_t>(bytes.size());
  }

  OutputFile &file_;
  const Layout &layout_;
  PngEncoder encoder_;
  std::int64_t offset_ = 0;
};

} // namespace

void write_png(const Communicator &comm, const Scene &scene, const std::string &path) {
  const Layout &layout = scene.layout;
  const Box map = layout.view.map;
  const std::int64_t row_bytes = static_cast<std::int64_t>(sizeof(PlacedPixel)) * map.width;
  const auto band_rows =
      static_cast<int>(std::clamp<std::int64_t>(scene.options.band_bytes / row_bytes, 1, map.height));
  const Box columns = columns_of(scene);
  OutputFile file(comm, path);
  std::optional<PngOutput> output;
  // Nothing but the root's work; what goes wrong with it is everybody's.
  const auto at_root = [&](auto &&work) {
    collectively(comm, [&] {
      if (comm.is_root())
        work();
    });
  };
  at_root([&] {
    output.emplace(file, layout);
    output->add({0, map.y}, {});
  });
  for (int begin = map.y; begin < map.y + map.height; begin += band_rows) {
    const Rows rows{begin, std::min(begin + band_rows, map.y + map.height)};
    const std::vector<Colour> pixels = rows_of_map(comm, scene, rows, columns);
    at_root([&] {
      output->add(rows, pixels);
      report_progress(scene.options.progress, "draw", static_cast<double>(rows.end - map.y) / map.height);
    });
  }
  at_root([&] {
    output->add({map.y + map.height, layout.height}, {});
    output->finish();
  });
  file.commit();
}

} // namespace dovetail::picture
