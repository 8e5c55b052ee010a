#include "geometry/io/las/compression.h"

#include <string>
#include <vector>

#include "geometry/byte_values.h"

namespace skycap::geometry::las {
namespace {

/// Part of a point that is compressed separately. Types are those of the specification.
struct Item {
  std::uint16_t type = 0, size = 0;
  bool operator==(const Item&) const = default;
};
constexpr Item point10{6, 20}, time11{7, 8}, colour12{8, 6};
constexpr Item point14{10, 30}, colour14{11, 6}, infrared14{12, 8};
constexpr std::uint16_t bytes10 = 0, bytes14 = 14;

/// Returns the items of a point format. Additional bytes of a point are user data.
std::vector<Item> standard_items(int format, std::size_t point_size) {
  std::vector<Item> items = {format >= 6 ? point14 : point10};
  if (format == 1 || format == 3) items.push_back(time11);
  if (format == 2 || format == 3) items.push_back(colour12);
  if (format == 7) items.push_back(colour14);
  if (format == 8) items.push_back(infrared14);
  std::size_t extra = point_size;
  for (const Item& item : items) extra -= item.size;
  if (extra > 0) {
    items.push_back({format >= 6 ? bytes14 : bytes10, static_cast<std::uint16_t>(extra)});
  }
  return items;
}

// Byte offsets in the record and in its items.
constexpr std::size_t compressor_offset = 0, coder_offset = 2, software_version_offset = 4,
                      chunk_size_offset = 12, unused_offset = 16, item_count_offset = 32,
                      items_offset = 34, item_size = 6;

constexpr std::string_view damaged = "has a damaged LAZ record: ";

}  // namespace

Compression parse_compression(std::string_view record, int format, std::size_t point_size) {
  const auto number = [&](std::size_t offset) {
    return value_at<std::uint16_t>(record.data(), offset);
  };
  if (record.size() < items_offset ||
      record.size() < items_offset + item_size * number(item_count_offset)) {
    throw_bad_file(std::string(damaged) + "it ends prematurely");
  }
  const bool is_layered = format >= 6;
  const int compressor = number(compressor_offset), expected = is_layered ? 3 : 2;
  if (compressor != expected || number(coder_offset) != 0) {
    throw_bad_file("is compressed by LAZ method " + std::to_string(compressor) +
                   "; points of format " + std::to_string(format) + " require method " +
                   std::to_string(expected) + "; compress it again, for example with laszip");
  }
  std::vector<Item> items;
  int version = is_layered ? 3 : 2;
  for (std::size_t i = 0; i < number(item_count_offset); ++i) {
    const std::size_t offset = items_offset + item_size * i;
    items.push_back({number(offset), number(offset + 2)});
    const int found = number(offset + 4);
    if (is_layered && i == 0 && found == 4) version = 4;
    if (found == version) continue;
    throw_bad_file("has LAZ items of version " + std::to_string(found) + "; points of format " +
                   std::to_string(format) + " require version " + (is_layered ? "3 or 4" : "2") +
                   " for all items; compress it again, for example with laszip");
  }
  if (items != standard_items(format, point_size)) {
    throw_bad_file(std::string(damaged) + "LAZ items do not match point format " +
                   std::to_string(format) + " and " + std::to_string(point_size) + " bytes");
  }
  const auto chunk_size = value_at<std::uint32_t>(record.data(), chunk_size_offset);
  if (chunk_size == 0) throw_bad_file(std::string(damaged) + "its chunk size is zero");
  return {.version = version, .chunk_size = chunk_size};
}

std::string write_compression(const Compression& compression, int format, std::size_t point_size) {
  const std::vector<Item> items = standard_items(format, point_size);
  std::string record(items_offset + item_size * items.size(), '\0');
  const auto put = [&](std::size_t offset, auto value) { put_value(record.data(), offset, value); };
  const auto put_number = [&](std::size_t offset, int value) {
    put(offset, static_cast<std::uint16_t>(value));
  };
  put_number(compressor_offset, 3);
  put_number(software_version_offset, 3 | 4 << 8);  // LASzip 3.4, whose format this is
  put(chunk_size_offset, compression.chunk_size);
  put(unused_offset, ~std::uint64_t{0});
  put(unused_offset + 8, ~std::uint64_t{0});
  put_number(item_count_offset, static_cast<int>(items.size()));
  for (std::size_t i = 0; i < items.size(); ++i) {
    const std::size_t offset = items_offset + item_size * i;
    put(offset, items[i].type);
    put(offset + 2, items[i].size);
    put_number(offset + 4, compression.version);
  }
  return record;
}

ChunkTable::ChunkTable(const ReadBytes& read, std::uint64_t file_size, std::uint64_t first_point,
                       const Compression& compression)
    : compression_(compression) {
  const auto offset_at = [&](std::uint64_t offset) {
    return ByteWindow(read, offset, file_size).value<std::uint64_t>();
  };
  begin_ = first_point + sizeof(std::uint64_t);
  end_ = offset_at(first_point);
  // Writers without random access store the offset at the end of the file.
  constexpr std::uint64_t elsewhere = ~std::uint64_t{0};
  if (end_ == elsewhere) end_ = offset_at(file_size - sizeof(std::uint64_t));
  if (end_ < begin_ || end_ > file_size) {
    throw_bad_file("has no valid chunk table: its declared offset (byte " + std::to_string(end_) +
                   ") is not between the points and the end of the file");
  }
  ByteWindow table(read, end_, file_size);
  if (table.value<std::uint32_t>() != 0) {
    throw_bad_file("has a damaged chunk table: its version is not 0");
  }
  unread_ = table.value<std::uint32_t>();
  if (unread_ > 0) decoder_ = ArithmeticDecoder(std::move(table));
}

ChunkTable::Chunk ChunkTable::next() {
  if (unread_ == 0)
    throw_bad_file("has fewer compressed chunks than its number of points requires");
  --unread_;
  if (compression_.has_various_chunks()) {
    last_points_ = numbers_.read(decoder_, last_points_, 0);
  } else {
    last_points_ = compression_.chunk_size;
  }
  last_size_ = numbers_.read(decoder_, last_size_, 1);
  if (last_size_ > end_ - begin_) {
    throw_bad_file("has a damaged chunk table: a chunk of " + std::to_string(last_size_) +
                   " bytes at byte " + std::to_string(begin_) + " extends into the table");
  }
  begin_ += last_size_;
  return {.begin = begin_ - last_size_, .end = begin_, .points = last_points_};
}

}  // namespace skycap::geometry::las
