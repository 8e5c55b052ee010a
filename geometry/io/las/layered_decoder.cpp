// LAZ specification 1.4, section 9: POINT14, RGB14, RGBNIR14 and BYTE14 of versions 3 and 4. Each
// attribute has a separate layer, with models for each scanner channel.
#include <array>
#include <cstring>
#include <optional>
#include <utility>
#include <vector>

#include "geometry/byte_values.h"
#include "geometry/io/las/chunk_decoder.h"
#include "geometry/io/las/colour_decoder.h"
#include "geometry/io/las/layout.h"
#include "geometry/io/las/position_decoder.h"
#include "geometry/io/las/return_contexts.h"

namespace skycap::geometry::las {
namespace {

constexpr std::size_t channels = 4;

/// Decoded layers, by their index in a chunk.
enum Layer : std::size_t { steps = 0, heights = 1, classes = 2, flags = 3, colours = 9 };

/// All decoded fields of a point except its colour.
struct Point14 {
  std::int32_t x = 0, y = 0, z = 0;
  std::uint8_t num_returns = 0, return_number = 0;  // 4 bits each
  std::uint8_t classification = 0;
  std::uint8_t flags = 0;  // 4 classification flags, scan direction, edge of flight line
  bool has_new_time = false;

  bool is_first() const { return return_number == 1; }
  bool is_last() const { return return_number >= num_returns; }
};

using Models = std::vector<SymbolModel>;

/// Models and state of one scanner channel.
struct Channel {
  bool is_used = false;
  Point14 last;
  Models changed = Models(8, SymbolModel(128));  // by the kind and time of the last return
  SymbolModel channel_step{3}, return_step{13};
  Models num_returns_models = Models(16, SymbolModel(16));  // by that of the last point
  Models return_numbers = num_returns_models;               // by that of the last point
  Models classes = Models(64, SymbolModel(256));            // by that of the last point
  Models flags = Models(64, SymbolModel(64));               // by that of the last point
  PositionDecoder position;
  std::array<RunningMedian, 12> x_steps, y_steps;
  std::array<std::int32_t, 8> heights{};  // last height per return level

  void begin(const Point14& first);
};

void Channel::begin(const Point14& first) {
  is_used = true;
  last = first;
  last.has_new_time = false;
  for (Models* models : {&changed, &num_returns_models, &return_numbers, &classes, &flags}) {
    for (SymbolModel& model : *models) model.reset();
  }
  channel_step.reset();
  return_step.reset();
  position.reset();
  x_steps = y_steps = {};
  heights.fill(first.z);
}

/// Layers of a chunk. An empty layer means that its attribute is constant.
using Layers = std::array<std::optional<ArithmeticDecoder>, colours + 1>;

class Point14Decoder {
 public:
  void begin(const Point14& first, std::size_t channel);
  const Point14& read(Layers& layers);
  std::size_t channel() const { return channel_; }
  bool channel_is_new() const { return channel_is_new_; }

 private:
  std::uint32_t read_changed(ArithmeticDecoder& decoder);
  void read_returns(ArithmeticDecoder& decoder, std::uint32_t changed);
  void read_position(Layers& layers);
  void read_class_and_flags(Layers& layers);

  std::array<Channel, channels> channels_;
  std::size_t channel_ = 0;
  bool channel_is_new_ = false;  // changed since the last point
};

void Point14Decoder::begin(const Point14& first, std::size_t channel) {
  for (Channel& other : channels_) other.is_used = false;
  channel_ = channel;
  channels_[channel_].begin(first);
}

const Point14& Point14Decoder::read(Layers& layers) {
  ArithmeticDecoder& decoder = *layers[Layer::steps];
  const std::uint32_t changed = read_changed(decoder);
  read_returns(decoder, changed);
  read_position(layers);
  read_class_and_flags(layers);
  return channels_[channel_].last;
}

/// Reads the change mask. Bits 0 and 1: return number; 2: number of returns; 4: time; 6: channel.
/// Other bits belong to layers that are not decoded.
std::uint32_t Point14Decoder::read_changed(ArithmeticDecoder& decoder) {
  Channel& channel = channels_[channel_];
  const Point14& last = channel.last;
  const std::size_t context =
      (last.is_first() ? 1U : 0U) + (last.is_last() ? 2U : 0U) + (last.has_new_time ? 4U : 0U);
  const std::uint32_t changed = decoder.symbol(channel.changed[context]);
  channel_is_new_ = (changed & 64) != 0;
  if (channel_is_new_) {
    channel_ = (channel_ + decoder.symbol(channel.channel_step) + 1) % channels;
    if (!channels_[channel_].is_used) channels_[channel_].begin(channel.last);
  }
  channels_[channel_].last.has_new_time = (changed & 16) != 0;
  return changed;
}

void Point14Decoder::read_returns(ArithmeticDecoder& decoder, std::uint32_t changed) {
  Channel& channel = channels_[channel_];
  Point14& point = channel.last;
  const std::uint8_t last = point.return_number;
  if ((changed & 4) != 0) {
    point.num_returns =
        static_cast<std::uint8_t>(decoder.symbol(channel.num_returns_models[point.num_returns]));
  }
  std::uint32_t number = last;
  if ((changed & 3) == 1) number = last + 1U;
  if ((changed & 3) == 2) number = last + 15U;
  if ((changed & 3) == 3) {
    number = point.has_new_time ? decoder.symbol(channel.return_numbers[last])
                                : last + decoder.symbol(channel.return_step) + 2;
  }
  point.return_number = number % 16;
}

void Point14Decoder::read_position(Layers& layers) {
  Channel& channel = channels_[channel_];
  Point14& point = channel.last;
  const std::size_t context =
      2U * return_contexts[point.num_returns][point.return_number] + (point.has_new_time ? 1 : 0);
  const bool is_single = point.num_returns == 1;
  const auto step = channel.position.read_step(*layers[Layer::steps], channel.x_steps[context],
                                               channel.y_steps[context], is_single);
  point.x = wrapped_sum(point.x, step.x);
  point.y = wrapped_sum(point.y, step.y);
  if (!layers[Layer::heights]) return;
  std::int32_t& height = channel.heights[return_level(point.num_returns, point.return_number)];
  point.z = height = channel.position.read_height(*layers[Layer::heights], height, is_single);
}

void Point14Decoder::read_class_and_flags(Layers& layers) {
  Channel& channel = channels_[channel_];
  Point14& point = channel.last;
  if (layers[Layer::classes]) {
    const bool is_only = point.is_first() && point.is_last();
    const std::size_t context = (point.classification & 31U) * 2 + (is_only ? 1 : 0);
    point.classification =
        static_cast<std::uint8_t>(layers[Layer::classes]->symbol(channel.classes[context]));
  }
  if (layers[Layer::flags]) {
    point.flags =
        static_cast<std::uint8_t>(layers[Layer::flags]->symbol(channel.flags[point.flags]));
  }
}

/// Decoder of colours of several channels. Version 3 predicts some colours from a wrong channel,
/// which readers must reproduce; version 4 corrects this.
class Colour14Decoder {
 public:
  void begin(const Colour& first, std::size_t channel) {
    for (ChannelColour& other : channels_) other.is_used = false;
    channel_ = channel;
    channels_[channel_].begin(first);
  }

  /// `channel` is the channel according to the version. Without a decoder, the colour is constant.
  Colour read(std::optional<ArithmeticDecoder>& decoder, std::size_t channel, int version) {
    std::size_t remembered = channel_;
    if (channel != channel_) {
      const bool is_new = !channels_[channel].is_used;
      if (is_new) channels_[channel].begin(channels_[channel_].last);
      channel_ = channel;
      if (is_new || version > 3) remembered = channel;
    }
    Colour& last = channels_[remembered].last;
    if (decoder) last = channels_[channel_].decoder.read(*decoder, last);
    return last;
  }

 private:
  struct ChannelColour {
    bool is_used = false;
    Colour last{};
    ColourDecoder decoder;

    void begin(const Colour& first) {
      is_used = true;
      last = first;
      decoder.reset();
    }
  };
  std::array<ChannelColour, channels> channels_;
  std::size_t channel_ = 0;
};

class LayeredDecoder : public ChunkDecoder {
 public:
  LayeredDecoder(int format, int version, std::size_t point_size)
      : version_(version), has_colour_(format >= 7), first_(point_size) {
    constexpr std::array<std::size_t, 3> sizes = {30, 36, 38}, layers = {9, 10, 11};
    const auto kind = static_cast<std::size_t>(format - 6);
    layers_in_file_ = layers[kind] + point_size - sizes[kind];
  }

  void begin(ByteWindow chunk, char* point) override;
  void next(char* point) override;

 private:
  void find_layers(ByteWindow& chunk);

  int version_;
  bool has_colour_;
  std::vector<char> first_;
  std::size_t layers_in_file_;
  std::array<ByteWindow, colours + 1> compressed_;
  std::array<bool, colours + 1> is_there_{};
  bool is_open_ = false;
  Layers layers_;
  Point14Decoder points_;
  Colour14Decoder colours_;
};

Point14 decoded_part(const char* bytes) {
  Point14 point;
  std::memcpy(&point.x, bytes, 12);
  const auto returns = value_at<std::uint8_t>(bytes, point::returns);
  const auto flag_bits = value_at<std::uint8_t>(bytes, point::flags);
  point.return_number = returns & 15;
  point.num_returns = returns >> 4;
  point.classification = value_at<std::uint8_t>(bytes, point::classification);
  point.flags = static_cast<std::uint8_t>((flag_bits & 15) | (flag_bits >> 6) << 4);
  return point;
}

void put_decoded_part(const Point14& point, std::size_t channel, char* bytes) {
  put_value(bytes, 0, point.x);
  put_value(bytes, 4, point.y);
  put_value(bytes, 8, point.z);
  put_value(bytes, point::returns,
            static_cast<std::uint8_t>(point.num_returns << 4 | point.return_number));
  put_value(bytes, point::flags,
            static_cast<std::uint8_t>((point.flags & 15) | channel << 4 | (point.flags >> 4) << 6));
  put_value(bytes, point::classification, point.classification);
}

void LayeredDecoder::begin(ByteWindow chunk, char* point) {
  chunk.take(first_.data(), first_.size());
  std::memcpy(point, first_.data(), first_.size());
  find_layers(chunk);
  const std::size_t channel = value_at<std::uint8_t>(first_.data(), point::flags) >> 4 & 3U;
  points_.begin(decoded_part(first_.data()), channel);
  if (has_colour_) colours_.begin(value_at<Colour>(first_.data(), point::colour), channel);
  is_open_ = false;
}

/// Reads the data after the first point: number of points (known from the chunk table), size of
/// each layer, and layers.
void LayeredDecoder::find_layers(ByteWindow& chunk) {
  chunk.value<std::uint32_t>();
  std::vector<std::uint32_t> sizes(layers_in_file_);
  for (std::uint32_t& size : sizes) size = chunk.value<std::uint32_t>();
  std::uint64_t begin = chunk.offset();
  for (std::size_t layer = 0; layer < sizes.size(); ++layer) {
    if (layer < compressed_.size()) {
      is_there_[layer] = sizes[layer] != 0;
      compressed_[layer] = chunk.part(begin, sizes[layer]);
    }
    begin += sizes[layer];
  }
}

void LayeredDecoder::next(char* point) {
  if (!is_open_) {  // a chunk of one point may have no layers
    for (const std::size_t layer : {+steps, +heights, +classes, +flags, +colours}) {
      layers_[layer].reset();
      const bool is_needed = layer == steps || is_there_[layer];
      if (is_needed && (layer != colours || has_colour_)) {
        layers_[layer].emplace(std::move(compressed_[layer]));
      }
    }
    is_open_ = true;
  }
  put_decoded_part(points_.read(layers_), points_.channel(), point);
  if (!has_colour_) return;
  const bool is_channel_stored = version_ > 3 || points_.channel_is_new();
  const std::size_t channel = is_channel_stored ? points_.channel() : 0;
  put_value(point, point::colour, colours_.read(layers_[colours], channel, version_));
}

}  // namespace

std::unique_ptr<ChunkDecoder> make_layered_decoder(int format, int version,
                                                   std::size_t point_size) {
  return std::make_unique<LayeredDecoder>(format, version, point_size);
}

}  // namespace skycap::geometry::las
