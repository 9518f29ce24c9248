// LAS files written field by field from the tables of the ASPRS specification, without looking at the
// reader: every field that is of no interest has bits that would show if it were taken for another.
#pragma once

#include "support/temporary_folder.hpp"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace dovetail::testing {

struct LasPoint {
  std::int32_t x = 0, y = 0, z = 0;
  int classification = 0;
  bool withheld = false;
};

struct LasRecord {
  std::string user_id;
  std::uint16_t id = 0;
  std::string description;
  std::string data;
};

enum class LasCounts { both, only_64_bits, only_32_bits };

struct LasFile {
  int minor = 2;
  int format = 0;
  std::array<double, 3> scale{0.01, 0.01, 0.01}, offset{0, 0, 0};
  std::vector<LasPoint> points;
  std::vector<LasRecord> records, extended_records;
  std::size_t header_extra = 0; // bytes between the header's fields and the first record
  std::size_t gap = 0;          // bytes between the records and the points
  std::size_t extra_bytes = 0;  // in every point
  LasCounts counts = LasCounts::only_32_bits;
  bool uncounted_signature = false; // LAS 1.0: DD CC at the offset to points
};

inline void add_las_point(Bytes &bytes, const LasFile &file, const LasPoint &p) {
  const bool gps = file.format == 1 || file.format >= 3;
  const bool colour = file.format == 2 || file.format == 3 || file.format == 5 || file.format == 7 ||
                      file.format == 8 || file.format == 10;
  const bool infrared = file.format == 8 || file.format == 10;
  const bool wave = file.format == 4 || file.format == 5 || file.format == 9 || file.format == 10;
  bytes.add(p.x).add(p.y).add(p.z).add(std::uint16_t{0xffff}); // intensity
  bytes.add(std::uint8_t{0xff});                               // returns, or returns and edge
  if (file.format <= 5) {
    // Class in bits 0 to 4; synthetic and key point (bits 5 and 6) set; withheld is bit 7.
    bytes.add(static_cast<std::uint8_t>(p.classification | 0x60 | (p.withheld ? 0x80 : 0)));
    bytes.add(std::int8_t{-1}).add(std::uint8_t{0xff}).add(std::uint16_t{0xffff}); // angle, user, source
  } else {
    // All other flags, scanner channel, direction and edge set; withheld is bit 2.
    bytes.add(static_cast<std::uint8_t>(0xfb | (p.withheld ? 0x04 : 0)));
    bytes.add(static_cast<std::uint8_t>(p.classification));
    bytes.add(std::uint8_t{0xff}).add(std::int16_t{-1}).add(std::uint16_t{0xffff}); // user, angle, source
  }
  if (gps)
    bytes.add(1.0e300);
  if (colour)
    bytes.add(std::uint16_t{0xffff}).add(std::uint16_t{0xffff}).add(std::uint16_t{0xffff});
  if (infrared)
    bytes.add(std::uint16_t{0xffff});
  if (wave)
    bytes.add(std::uint8_t{0xff})
        .add(std::uint64_t(-1))
        .add(std::uint32_t(-1))
        .add(-1.0f)
        .add(-1.0f)
        .add(-1.0f)
        .add(-1.0f);
  for (std::size_t i = 0; i < file.extra_bytes; ++i)
    bytes.add(std::uint8_t{0xee});
}

inline std::string las_bytes(const LasFile &file) {
  Bytes records, points, extended;
  for (const LasRecord &record : file.records) {
    records.add(std::uint16_t{0xaabb}).add_text(record.user_id, 16).add(record.id);
    records.add(static_cast<std::uint16_t>(record.data.size())).add_text(record.description, 32);
    records.add_text(record.data);
  }
  for (const LasRecord &record : file.extended_records) {
    extended.add(std::uint16_t{0}).add_text(record.user_id, 16).add(record.id);
    extended.add(static_cast<std::uint64_t>(record.data.size())).add_text(record.description, 32);
    extended.add_text(record.data);
  }
  for (const LasPoint &point : file.points)
    add_las_point(points, file, point);
  Bytes one_point;
  add_las_point(one_point, file, {});

  const std::size_t header_bytes = (file.minor <= 2 ? 227 : file.minor == 3 ? 235 : 375) + file.header_extra;
  const std::size_t first_point = header_bytes + records.size() + file.gap;
  const std::size_t signature_bytes = file.uncounted_signature ? 2 : 0;
  const auto count = file.points.size();
  const auto legacy_count =
      static_cast<std::uint32_t>(file.minor == 4 && file.counts == LasCounts::only_64_bits ? 0 : count);

  Bytes bytes;
  bytes.add_text("LASF").add(std::uint16_t{7}).add(std::uint16_t{0}); // source, global encoding
  bytes.add_zeros(16).add(std::uint8_t{1}).add(static_cast<std::uint8_t>(file.minor));
  bytes.add_text("SYSTEM", 32)
      .add_text("dovetail's tests", 32)
      .add(std::uint16_t{33})
      .add(std::uint16_t{2024});
  bytes.add(static_cast<std::uint16_t>(header_bytes)).add(static_cast<std::uint32_t>(first_point));
  bytes.add(static_cast<std::uint32_t>(file.records.size())).add(static_cast<std::uint8_t>(file.format));
  bytes.add(static_cast<std::uint16_t>(one_point.size())).add(legacy_count);
  bytes.add_zeros(5 * 4); // by return
  for (const auto &triple : {file.scale, file.offset})
    for (const double value : triple)
      bytes.add(value);
  for (const double bound : {11.0, 10.0, 21.0, 20.0, 31.0, 30.0}) // max x, min x, max y, ...
    bytes.add(bound);
  if (file.minor >= 3)
    bytes.add(std::uint64_t{0}); // waveform data
  if (file.minor == 4) {
    bytes.add(static_cast<std::uint64_t>(file.extended_records.empty() ? 0 : first_point + points.size()));
    bytes.add(static_cast<std::uint32_t>(file.extended_records.size()));
    bytes.add(static_cast<std::uint64_t>(file.counts == LasCounts::only_32_bits ? 0 : count))
        .add_zeros(15 * 8);
  }
  for (std::size_t i = 0; i < file.header_extra; ++i)
    bytes.add(std::uint8_t{0xee});
  bytes.add_text(records.text());
  for (std::size_t i = 0; i < file.gap; ++i)
    bytes.add(std::uint8_t{0xee});
  if (signature_bytes != 0)
    bytes.add(std::uint8_t{0xdd}).add(std::uint8_t{0xcc});
  return bytes.text() + points.text() + extended.text();
}

} // namespace dovetail::testing
