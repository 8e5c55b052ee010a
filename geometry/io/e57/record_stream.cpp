#include "geometry/io/e57/record_stream.h"

#include <algorithm>

#include "geometry/byte_values.h"
#include "geometry/io/e57/layout.h"

namespace skycap::geometry::e57 {
namespace {

/// Returns the maximum number of records that fit into `size` bytes. Records with unusually few
/// bits, or none, are accepted only up to a harmless number. Otherwise a short file could exhaust
/// the memory.
std::uint64_t max_records(const ScanDescription& scan, std::uint64_t size) {
  std::uint64_t bits = 0;
  for (const Field& field : scan.fields) {
    bits += field.coding == Coding::text ? 8 : field.bits();  // text has at least one length byte
  }
  constexpr std::uint64_t usual_bits = 24, harmless = 1 << 16;
  if (bits == 0) return harmless;
  const std::uint64_t capacity = size * 8 / bits;
  return bits >= usual_bits ? capacity
                            : std::min(capacity, std::max(harmless, size * 8 / usual_bits));
}

std::string at(std::uint64_t offset) {
  return " at byte " + std::to_string(offset) + " (not counting checksums)";
}

}  // namespace

RecordStream::RecordStream(Pages& pages, const ScanDescription& scan,
                           std::span<const std::size_t> fields)
    : pages_(&pages),
      scan_(&scan),
      fields_(fields.begin(), fields.end()),
      values_(fields.size()),
      left_(scan.records) {
  for (const std::size_t field : fields) columns_.emplace_back(scan.fields[field].bits());
  const std::uint64_t begin = pages.logical(scan.section, "a scan");
  if (pages.size() - begin < section::size) throw_bad_file("ends inside a scan header");
  const std::string head = pages.bytes(begin, section::size);
  if (head[section::kind] != section::compressed_vector) {
    throw_bad_file("has no records" + at(begin) + ", where a scan declares them");
  }
  const auto length = value_at<std::uint64_t>(head.data(), section::length);
  if (length < section::size || length > pages.size() - begin) {
    throw_bad_file("has a scan" + at(begin) + " that extends beyond the end of the file");
  }
  end_ = begin + length;
  const std::uint64_t capacity = max_records(scan, length);
  if (scan.records > capacity) {
    throw_bad_file("declares " + std::to_string(scan.records) + " points in a scan of " +
                   std::to_string(length) + " bytes, which has space for at most " +
                   std::to_string(capacity));
  }
  next_packet_ =
      pages.logical(value_at<std::uint64_t>(head.data(), section::data), "the data of a scan");
}

std::size_t RecordStream::next(std::size_t max) {
  std::uint64_t count = std::min<std::uint64_t>(max, left_);
  if (count == 0) return 0;
  const auto available = [&] {
    std::uint64_t min = count;
    for (const Column& column : columns_) min = std::min(min, column.available());
    return min;
  };
  while (available() == 0) read_packet();
  count = available();
  stored_.resize(count);
  for (std::size_t i = 0; i < fields_.size(); ++i) {
    columns_[i].take(stored_);
    values_[i].resize(count);
    const Field& field = scan_->fields[fields_[i]];
    std::ranges::transform(stored_, values_[i].begin(),
                           [&](std::uint64_t stored) { return field.value(stored); });
  }
  left_ -= count;
  return count;
}

void RecordStream::read_packet() {
  if (next_packet_ >= end_ || end_ - next_packet_ < packet::min_size) {
    throw_bad_file("ends after " + std::to_string(scan_->records - left_) + " of the " +
                   std::to_string(scan_->records) + " points of a scan");
  }
  const std::string head = pages_->bytes(next_packet_, packet::min_size);
  const std::size_t size =
      std::size_t{value_at<std::uint16_t>(head.data(), packet::size_less_one)} + 1;
  if (size % packet::min_size != 0 || size > end_ - next_packet_) {
    throw_bad_file("has a packet" + at(next_packet_) + " of " + std::to_string(size) +
                   " bytes; its size must be a multiple of 4, and it must end inside its scan");
  }
  const auto kind = value_at<std::uint8_t>(head.data(), packet::kind);
  if (kind > packet::empty) {
    throw_bad_file("has a packet" + at(next_packet_) + " of kind " + std::to_string(kind) +
                   "; valid kinds are 0, 1 and 2");
  }
  if (kind == packet::data) read_streams(pages_->bytes(next_packet_, size), next_packet_);
  next_packet_ += size;
}

void RecordStream::read_streams(std::string_view packet, std::uint64_t offset) {
  const std::size_t streams = scan_->fields.size();
  const std::size_t begin = packet::lengths + 2 * streams;
  if (packet.size() < begin || value_at<std::uint16_t>(packet.data(), packet::streams) != streams) {
    throw_bad_file("has a packet" + at(offset) +
                   " that does not contain one stream for each of the " + std::to_string(streams) +
                   " fields");
  }
  std::vector<std::size_t> begins{begin};  // offsets of the streams and of their end
  for (std::size_t i = 0; i < streams; ++i) {
    begins.push_back(begins.back() +
                     value_at<std::uint16_t>(packet.data(), packet::lengths + 2 * i));
  }
  if (begins.back() > packet.size()) {
    throw_bad_file("has a packet" + at(offset) + " whose streams are longer than the packet");
  }
  // In valid files, the values of a record are in the same packet or in the next one.
  constexpr std::size_t max_pending = 16 << 20;
  for (std::size_t i = 0; i < fields_.size(); ++i) {
    const std::size_t field = fields_[i];
    columns_[i].append(packet.substr(begins[field], begins[field + 1] - begins[field]));
    if (columns_[i].bytes_waiting() > max_pending) {
      throw_bad_file("has records whose values are more than 16 MiB apart");
    }
  }
}

}  // namespace skycap::geometry::e57
