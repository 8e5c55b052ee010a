#include "geometry/io/las/las_file_writer.h"

#include <algorithm>
#include <utility>

#include "geometry/error.h"

namespace skycap::geometry::las {

LasFileWriter::LasFileWriter(std::filesystem::path path, WrittenFile file)
    : path_(std::move(path)),
      file_(std::move(file)),
      point_size_(std::size_t{point_size(file_.point_format)} + file_.extra_bytes),
      stream_(path_, std::ios::binary | std::ios::trunc) {
  if (file_.is_compressed) {
    file_.records.push_back(compression_record(file_.point_format, point_size_, chunk_points));
    encoder_ = make_chunk_encoder(file_.point_format, point_size_);
  }
  const std::vector<std::uint8_t> header = make_header(file_);
  first_point_ = header.size();
  put({reinterpret_cast<const char*>(header.data()), header.size()});
  if (encoder_ != nullptr) put(std::string(sizeof(std::uint64_t), '\0'));  // offset of the table
}

void LasFileWriter::put(std::string_view bytes) {
  stream_.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (!stream_) throw Error(ErrorKind::bad_file, path_.string() + ": cannot be written");
  size_ += bytes.size();
}

void LasFileWriter::count(const char* bytes) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto value = value_at<std::int32_t>(bytes, point::position + 4 * axis);
    auto& [least, greatest] = extremes_;
    least[axis] = file_.points == 0 ? value : std::min(least[axis], value);
    greatest[axis] = file_.points == 0 ? value : std::max(greatest[axis], value);
  }
  const auto number = value_at<std::uint8_t>(bytes, point::returns) & 15U;
  if (number > 0) ++file_.points_by_return[number - 1];
  ++file_.points;
}

void LasFileWriter::add(std::string_view records) {
  for (std::size_t begin = 0; begin < records.size(); begin += point_size_) {
    const char* const point = records.data() + begin;
    count(point);
    if (encoder_ == nullptr) continue;
    encoder_->add(point);
    if (encoder_->points() == chunk_points) end_chunk();
  }
  if (encoder_ == nullptr) put(records);
}

void LasFileWriter::end_chunk() {
  const std::uint32_t points = encoder_->points();
  const std::string bytes = encoder_->finish();
  chunks_.push_back({points, static_cast<std::uint32_t>(bytes.size())});
  put(bytes);
}

void LasFileWriter::finish() {
  const std::uint64_t table = [&] {
    if (encoder_ != nullptr && encoder_->points() > 0) end_chunk();
    return size_;
  }();
  if (encoder_ != nullptr) put(chunk_table(chunks_, false));
  file_.bounds.setEmpty();
  for (const auto& corner : extremes_) {
    Eigen::Vector3d position;
    for (int axis = 0; axis < 3; ++axis) {
      position[axis] =
          corner[static_cast<std::size_t>(axis)] * file_.scale[axis] + file_.offset[axis];
    }
    file_.bounds.extend(position);
  }
  const std::vector<std::uint8_t> header = make_header(file_);
  stream_.seekp(0);
  put({reinterpret_cast<const char*>(header.data()), header.size()});
  if (encoder_ != nullptr) {
    std::string offset;
    append_value(offset, table);
    put(offset);
  }
  stream_.close();
  if (!stream_) throw Error(ErrorKind::bad_file, path_.string() + ": cannot be written");
}

}  // namespace skycap::geometry::las
