// LAZ specification 1.4, section 8: POINT10, GPSTIME11, RGB12 and BYTE of version 2. All points are
// decoded in order by one arithmetic decoder.
#include <array>
#include <cstring>
#include <optional>
#include <utility>
#include <vector>

#include "geometry/byte_values.h"
#include "geometry/io/las/chunk_decoder.h"
#include "geometry/io/las/colour_coder.h"
#include "geometry/io/las/position_coder.h"
#include "geometry/io/las/return_contexts.h"
#include "geometry/io/las/time_coder.h"

namespace skycap::geometry::las {
namespace {

/// Point of format 0 in file layout.
struct Point10 {
  std::int32_t x = 0, y = 0, z = 0;
  std::uint16_t intensity = 0;
  std::uint8_t returns = 0, classification = 0, scan_angle = 0, user_data = 0;
  std::uint16_t source = 0;
};
static_assert(sizeof(Point10) == 20);

class Point10Decoder {
 public:
  void begin(const Point10& first);
  const Point10& read(ArithmeticDecoder& decoder);

 private:
  void read_attributes(ArithmeticDecoder& decoder, std::uint32_t changed);
  void read_position(ArithmeticDecoder& decoder);
  std::size_t num_returns() const { return last_.returns >> 3 & 7; }
  std::size_t return_number() const { return last_.returns & 7; }
  std::size_t return_context() const { return old_return_contexts[num_returns()][return_number()]; }

  Point10 last_;
  SymbolModel changed_{64};
  std::vector<SymbolModel> returns_ =
      std::vector<SymbolModel>(256);  // by the value of the last point
  std::vector<SymbolModel> classes_ = returns_,
                           user_data_ = returns_;  // by the value of the last point
  std::array<SymbolModel, 2> scan_angles_;         // by scan direction
  IntegerCoder intensity_{16, 4}, source_{16, 1};
  PositionCoder position_;
  std::array<std::uint16_t, 16> intensities_{};  // last intensity per kind of return
  std::array<RunningMedian, 16> x_steps_{}, y_steps_{};
  std::array<std::int32_t, 8> heights_{};  // last height per return level
};

void Point10Decoder::begin(const Point10& first) {
  last_ = first;
  last_.intensity = 0;  // required for compatibility with encoders
  changed_.reset();
  for (auto* models : {&returns_, &classes_, &user_data_}) {
    for (SymbolModel& model : *models) model.reset();
  }
  for (SymbolModel& model : scan_angles_) model.reset();
  intensity_.reset();
  source_.reset();
  position_.reset();
  intensities_ = {};
  x_steps_ = y_steps_ = {};
  heights_ = {};
}

const Point10& Point10Decoder::read(ArithmeticDecoder& decoder) {
  const std::uint32_t changed = decoder.symbol(changed_);
  if (changed != 0) read_attributes(decoder, changed);
  read_position(decoder);
  return last_;
}

void Point10Decoder::read_attributes(ArithmeticDecoder& decoder, std::uint32_t changed) {
  const auto symbol = [&](SymbolModel& model) {
    return static_cast<std::uint8_t>(decoder.symbol(model));
  };
  if ((changed & 32) != 0) last_.returns = symbol(returns_[last_.returns]);
  const std::size_t context = return_context();
  std::uint16_t& intensity = intensities_[context];
  if ((changed & 16) != 0) {
    intensity = static_cast<std::uint16_t>(
        intensity_.read(decoder, intensity, std::min<std::size_t>(context, 3)));
  }
  last_.intensity = intensity;
  if ((changed & 8) != 0) last_.classification = symbol(classes_[last_.classification]);
  if ((changed & 4) != 0) {
    const std::size_t direction = last_.returns >> 6 & 1;
    last_.scan_angle =
        static_cast<std::uint8_t>(last_.scan_angle + symbol(scan_angles_[direction]));
  }
  if ((changed & 2) != 0) last_.user_data = symbol(user_data_[last_.user_data]);
  if ((changed & 1) != 0) {
    last_.source = static_cast<std::uint16_t>(source_.read(decoder, last_.source));
  }
}

void Point10Decoder::read_position(ArithmeticDecoder& decoder) {
  const std::size_t context = return_context();
  const bool is_single = num_returns() == 1;
  const auto step =
      position_.code_step(decoder, x_steps_[context], y_steps_[context], is_single, {});
  last_.x = wrapped_sum(last_.x, step.x);
  last_.y = wrapped_sum(last_.y, step.y);
  std::int32_t& height = heights_[return_level(num_returns(), return_number())];
  last_.z = height = position_.code_height(decoder, height, is_single);
}

class PointwiseDecoder : public ChunkDecoder {
 public:
  PointwiseDecoder(int format, std::size_t point_size)
      : has_time_(format == 1 || format == 3),
        has_colour_(format == 2 || format == 3),
        last_(point_size),
        extra_(point_size - extra_offset()) {}

  void begin(ByteWindow chunk, char* point) override;
  void next(char* point) override;

 private:
  std::size_t colour_offset() const { return sizeof(Point10) + (has_time_ ? 8 : 0); }
  std::size_t extra_offset() const { return colour_offset() + (has_colour_ ? 6 : 0); }

  bool has_time_, has_colour_;
  std::vector<char> last_;
  ByteWindow compressed_;
  std::optional<ArithmeticDecoder> decoder_;
  Point10Decoder points_;
  TimeCoder times_{false};
  ColourCoder colours_;
  std::vector<SymbolModel> extra_;
};

void PointwiseDecoder::begin(ByteWindow chunk, char* point) {
  chunk.take(last_.data(), last_.size());
  std::memcpy(point, last_.data(), last_.size());
  compressed_ = std::move(chunk);
  decoder_.reset();
  points_.begin(value_at<Point10>(last_.data(), 0));
  if (has_time_) times_.begin(value_at<std::uint64_t>(last_.data(), sizeof(Point10)));
  colours_.reset();
  for (SymbolModel& model : extra_) model.reset();
}

void PointwiseDecoder::next(char* point) {
  if (!decoder_) decoder_.emplace(std::move(compressed_));  // a chunk of one point ends here
  put_value(last_.data(), 0, points_.read(*decoder_));
  if (has_time_) put_value(last_.data(), sizeof(Point10), times_.code(*decoder_));
  if (has_colour_) {
    const auto colour = value_at<Colour>(last_.data(), colour_offset());
    put_value(last_.data(), colour_offset(), colours_.code(*decoder_, colour));
  }
  for (std::size_t i = 0; i < extra_.size(); ++i) {
    char& byte = last_[extra_offset() + i];
    byte = static_cast<char>(static_cast<std::uint8_t>(byte) + decoder_->symbol(extra_[i]));
  }
  std::memcpy(point, last_.data(), last_.size());
}

}  // namespace

std::unique_ptr<ChunkDecoder> make_pointwise_decoder(int format, std::size_t point_size) {
  return std::make_unique<PointwiseDecoder>(format, point_size);
}

}  // namespace skycap::geometry::las
