#include "geometry/io/las/las_writer.h"

#include <algorithm>
#include <limits>

#include "geometry/io/las/chunk_encoder.h"
#include "geometry/io/las/compression.h"

namespace skycap::geometry::las {

WrittenRecord wkt_record(std::string_view wkt) {
  return {record::projection, record::wkt, "OGC coordinate system WKT", std::string(wkt) + '\0'};
}

WrittenRecord compression_record(int point_format, std::size_t point_size,
                                 std::uint32_t chunk_size) {
  return {compression_user, compression_id, "LASzip compression",
          write_compression({3, chunk_size == 0 ? various_chunk_sizes : chunk_size}, point_format,
                            point_size)};
}

// All other bytes stay zero: the legacy counts, which are unused for point formats 6 and above, and
// the missing waveforms and extended records.
std::vector<std::uint8_t> make_header(const WrittenFile& file) {
  constexpr std::uint16_t adjusted_time = 1, is_wkt = 1 << 4;
  std::size_t size = header::end;
  for (const WrittenRecord& record : file.records) size += record::end + record.content.size();
  std::vector<std::uint8_t> bytes(size);
  const auto put = [&](std::size_t offset, auto value) { put_value(bytes.data(), offset, value); };
  const auto put_text = [&](std::size_t offset, std::string_view text, std::size_t max) {
    std::ranges::copy(text.substr(0, max), bytes.begin() + static_cast<std::ptrdiff_t>(offset));
  };
  const bool has_wkt =
      std::ranges::find(file.records, record::wkt, &WrittenRecord::id) != file.records.end();
  put_text(header::signature, "LASF", 4);
  put(header::encoding, static_cast<std::uint16_t>((file.has_week_time ? 0 : adjusted_time) |
                                                   (has_wkt ? is_wkt : 0)));
  put(header::major, std::uint8_t{1});
  put(header::minor, std::uint8_t{4});
  put_text(header::system, file.system, 32);
  put_text(header::software, "Skycap", 32);
  put(header::size, static_cast<std::uint16_t>(header::end));
  put(header::first_point, static_cast<std::uint32_t>(bytes.size()));
  put(header::records, static_cast<std::uint32_t>(file.records.size()));
  put(header::point_format,
      static_cast<std::uint8_t>(file.point_format | (file.is_compressed ? compressed_bit : 0)));
  put(header::point_size,
      static_cast<std::uint16_t>(point_size(file.point_format) + file.extra_bytes));
  for (int axis = 0; axis < 3; ++axis) {
    put(header::scale + 8UL * axis, file.scale[axis]);
    put(header::offset + 8UL * axis, file.offset[axis]);
    if (file.points == 0) continue;
    put(header::bounds + 16UL * axis, file.bounds.max()[axis]);
    put(header::bounds + 16UL * axis + 8, file.bounds.min()[axis]);
  }
  put(header::points, file.points);
  for (std::size_t i = 0; i < file.points_by_return.size(); ++i) {
    put(header::points_by_return + 8 * i, file.points_by_return[i]);
  }
  std::size_t offset = header::end;
  for (const WrittenRecord& written : file.records) {
    put_text(offset + record::user, written.user, record::user_size);
    put(offset + record::id, written.id);
    put(offset + record::length, static_cast<std::uint16_t>(written.content.size()));
    put_text(offset + record::description, written.description, record::end - record::description);
    put_text(offset + record::end, written.content, written.content.size());
    offset += record::end + written.content.size();
  }
  return bytes;
}

std::string chunk_table(std::span<const WrittenChunk> chunks, bool has_various_sizes) {
  std::string table;
  append_value(table, std::uint32_t{0});
  append_value(table, static_cast<std::uint32_t>(chunks.size()));
  ArithmeticEncoder encoder;
  IntegerCoder numbers(32, 2);
  WrittenChunk last;
  for (const WrittenChunk& chunk : chunks) {
    if (has_various_sizes) numbers.code(encoder, last.points, chunk.points, 0);
    numbers.code(encoder, last.bytes, chunk.bytes, 1);
    last = chunk;
  }
  return table + encoder.finish();
}

std::vector<WrittenChunk> find_chunks(std::istream& file, std::uint64_t begin, std::uint64_t end,
                                      int point_format, std::size_t point_size) {
  std::vector<WrittenChunk> chunks;
  std::string sizes((1 + layer_count(point_format, point_size)) * sizeof(std::uint32_t), '\0');
  while (begin < end) {
    file.seekg(static_cast<std::streamoff>(begin + point_size));
    file.read(sizes.data(), static_cast<std::streamsize>(sizes.size()));
    if (!file) throw_bad_file("ends within a chunk of compressed points");
    std::uint64_t bytes = point_size + sizes.size();
    for (std::size_t i = sizeof(std::uint32_t); i < sizes.size(); i += sizeof(std::uint32_t)) {
      bytes += value_at<std::uint32_t>(sizes.data(), i);
    }
    if (bytes > end - begin) throw_bad_file("has a chunk that extends beyond the points");
    chunks.push_back({value_at<std::uint32_t>(sizes.data(), 0), static_cast<std::uint32_t>(bytes)});
    begin += bytes;
  }
  return chunks;
}

}  // namespace skycap::geometry::las
