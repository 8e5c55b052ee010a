#include "geometry/io/las/point_stream.h"

#include <utility>

namespace skycap::geometry::las {

PointStream::PointStream(ReadBytes read, std::uint64_t file_size, const StoredPoints& points,
                         std::string_view record)
    : read_(std::move(read)),
      chunks_(read_, file_size, points.first,
              parse_compression(record, points.format, points.size)) {
  const int version = parse_compression(record, points.format, points.size).version;
  decoder_ = points.format >= 6
                 ? make_layered_decoder(points.format, version, points.size, points.decodes_all)
                 : make_pointwise_decoder(points.format, points.size);
}

void PointStream::next(char* point) {
  if (left_in_chunk_ > 0) {
    --left_in_chunk_;
    return decoder_->next(point);
  }
  ChunkTable::Chunk chunk;
  while (chunk.points == 0) chunk = chunks_.next();
  left_in_chunk_ = chunk.points - 1;
  decoder_->begin(ByteWindow(read_, chunk.begin, chunk.end), point);
}

}  // namespace skycap::geometry::las
