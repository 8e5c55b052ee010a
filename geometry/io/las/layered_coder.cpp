// LAZ specification 1.4, section 9: POINT14, RGB14, RGBNIR14 and BYTE14 of versions 3 and 4. Each
// attribute has a separate layer, with models for each scanner channel. Decoder and encoder are the
// same code with a different arithmetic coder (arithmetic_coder.h).
#include <algorithm>
#include <array>
#include <cstring>
#include <optional>
#include <utility>
#include <vector>

#include "geometry/byte_values.h"
#include "geometry/io/las/chunk_decoder.h"
#include "geometry/io/las/chunk_encoder.h"
#include "geometry/io/las/colour_coder.h"
#include "geometry/io/las/layout.h"
#include "geometry/io/las/position_coder.h"
#include "geometry/io/las/return_contexts.h"
#include "geometry/io/las/time_coder.h"

namespace skycap::geometry::las {
namespace {

constexpr std::size_t channels = 4;

/// Layers by their index in a chunk. The layer of infrared follows that of the colour, those of
/// additional bytes follow all others.
enum Layer : std::size_t {
  steps,
  heights,
  classes,
  flags,
  intensities,
  scan_angles,
  user_data,
  sources,
  times,
  colours,
  infrared
};

/// Offsets and sizes of a point format.
struct PointLayout {
  PointLayout(int format, std::size_t point_size)
      : size(point_size),
        has_colour(format >= 7),
        has_infrared(format == 8),
        extra_offset(las::point_size(format)),
        first_extra_layer(colours + (has_colour ? 1U : 0U) + (has_infrared ? 1U : 0U)) {}

  std::size_t extra() const { return size - extra_offset; }
  std::size_t layers() const { return first_extra_layer + extra(); }

  std::size_t size;
  bool has_colour, has_infrared;
  std::size_t extra_offset, first_extra_layer;
};
constexpr std::size_t infrared_offset = point::colour + sizeof(Colour);

/// All fields of formats 6 to 8 except the colour and the channel.
struct Point14 {
  std::int32_t x = 0, y = 0, z = 0;
  std::uint16_t intensity = 0, scan_angle = 0, source = 0;
  std::uint8_t num_returns = 0, return_number = 0;  // 4 bits each
  std::uint8_t classification = 0;
  std::uint8_t flags = 0;  // 4 classification flags, scan direction, edge of flight line
  std::uint8_t user_data = 0;
  std::uint64_t time = 0;
  bool has_new_time = false;

  bool is_first() const { return return_number == 1; }
  bool is_last() const { return return_number >= num_returns; }
  /// Returns the kind of return: only, first, last or intermediate.
  std::size_t kind() const { return (is_first() ? 2U : 0U) + (is_last() ? 1U : 0U); }
};

std::size_t channel_of(const char* bytes) {
  return value_at<std::uint8_t>(bytes, point::flags) >> 4 & 3U;
}

Point14 to_point(const char* bytes) {
  Point14 point;
  std::memcpy(&point.x, bytes, 12);
  const auto returns = value_at<std::uint8_t>(bytes, point::returns);
  const auto flag_bits = value_at<std::uint8_t>(bytes, point::flags);
  point.intensity = value_at<std::uint16_t>(bytes, point::intensity);
  point.return_number = returns & 15;
  point.num_returns = returns >> 4;
  point.classification = value_at<std::uint8_t>(bytes, point::classification);
  point.flags = static_cast<std::uint8_t>((flag_bits & 15) | (flag_bits >> 6) << 4);
  point.user_data = value_at<std::uint8_t>(bytes, point::user_data);
  point.scan_angle = value_at<std::uint16_t>(bytes, point::scan_angle);
  point.source = value_at<std::uint16_t>(bytes, point::source);
  point.time = value_at<std::uint64_t>(bytes, point::time);
  return point;
}

void put_needed_fields(const Point14& point, std::size_t channel, char* bytes) {
  put_value(bytes, 0, point.x);
  put_value(bytes, 4, point.y);
  put_value(bytes, 8, point.z);
  put_value(bytes, point::returns,
            static_cast<std::uint8_t>(point.num_returns << 4 | point.return_number));
  put_value(bytes, point::flags,
            static_cast<std::uint8_t>((point.flags & 15) | channel << 4 | (point.flags >> 4) << 6));
  put_value(bytes, point::classification, point.classification);
}

void put_other_fields(const Point14& point, char* bytes) {
  put_value(bytes, point::intensity, point.intensity);
  put_value(bytes, point::user_data, point.user_data);
  put_value(bytes, point::scan_angle, point.scan_angle);
  put_value(bytes, point::source, point.source);
  put_value(bytes, point::time, point.time);
}

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
  Models user_data = Models(64, SymbolModel(256));          // by that of the last point
  PositionCoder position;
  std::array<RunningMedian, 12> x_steps, y_steps;
  std::array<std::int32_t, 8> heights{};       // last height per return level
  std::array<std::uint16_t, 8> intensities{};  // last intensity per kind of return and time change
  IntegerCoder intensity{16, 4}, scan_angle{16, 2}, source{16, 1};
  TimeCoder times{true};

  void begin(const Point14& first);
};

void Channel::begin(const Point14& first) {
  is_used = true;
  last = first;
  last.has_new_time = false;
  for (Models* models :
       {&changed, &num_returns_models, &return_numbers, &classes, &flags, &user_data}) {
    for (SymbolModel& model : *models) model.reset();
  }
  channel_step.reset();
  return_step.reset();
  position.reset();
  x_steps = y_steps = {};
  heights.fill(first.z);
  intensities.fill(first.intensity);
  for (IntegerCoder* numbers : {&intensity, &scan_angle, &source}) numbers->reset();
  times.begin(first.time);
}

/// Coders of the layers of a chunk. A missing layer is constant or not read.
template <typename Coder>
using Layers = std::vector<std::optional<Coder>>;

template <typename Coder>
class Point14Coder {
 public:
  void begin(const Point14& first, std::size_t channel) {
    for (Channel& other : channels_) other.is_used = false;
    channel_ = channel;
    channels_[channel_].begin(first);
  }

  /// Codes `point` of the scanner channel `channel`, which decoders ignore.
  const Point14& code(Layers<Coder>& layers, const Point14& point, std::size_t channel);

  std::size_t channel() const { return channel_; }
  bool channel_is_new() const { return channel_is_new_; }

 private:
  std::uint32_t code_changed(Coder& coder, const Point14& point, std::size_t channel);
  std::uint32_t find_changed(const Point14& point, std::size_t channel) const;
  void code_returns(Coder& coder, std::uint32_t changed, const Point14& point);
  void code_position(Layers<Coder>& layers, const Point14& point);
  void code_bytes(Layers<Coder>& layers, const Point14& point);
  void code_numbers(Layers<Coder>& layers, std::uint32_t changed, const Point14& point);

  std::array<Channel, channels> channels_;
  std::size_t channel_ = 0;
  bool channel_is_new_ = false;  // changed since the last point
};

// Bits of the change mask; bits 0 and 1 contain the change of the return number.
constexpr std::uint32_t num_returns_bit = 4, scan_angle_bit = 8, time_bit = 16, source_bit = 32,
                        channel_bit = 64;

template <typename Coder>
const Point14& Point14Coder<Coder>::code(Layers<Coder>& layers, const Point14& point,
                                         std::size_t channel) {
  Coder& coder = *layers[Layer::steps];
  const std::uint32_t changed = code_changed(coder, point, channel);
  code_returns(coder, changed, point);
  code_position(layers, point);
  code_bytes(layers, point);
  code_numbers(layers, changed, point);
  return channels_[channel_].last;
}

/// Returns the changes from the last point of the same channel, or of the current channel if the
/// channel has no earlier point.
template <typename Coder>
std::uint32_t Point14Coder<Coder>::find_changed(const Point14& point, std::size_t channel) const {
  const Point14& last = channels_[channels_[channel].is_used ? channel : channel_].last;
  std::uint32_t changed = 0;
  const auto mark = [&](std::uint32_t bit, bool differs) {
    if (differs) changed |= bit;
  };
  mark(channel_bit, channel != channel_);
  mark(source_bit, point.source != last.source);
  mark(time_bit, point.time != last.time);
  mark(scan_angle_bit, point.scan_angle != last.scan_angle);
  mark(num_returns_bit, point.num_returns != last.num_returns);
  const std::uint32_t step = (point.return_number + 16U - last.return_number) % 16;
  return changed | (step == 0 ? 0 : step == 1 ? 1 : step == 15 ? 2 : 3);
}

template <typename Coder>
std::uint32_t Point14Coder<Coder>::code_changed(Coder& coder, const Point14& point,
                                                std::size_t channel) {
  Channel& old = channels_[channel_];
  const Point14& last = old.last;
  const std::size_t context =
      (last.is_first() ? 1U : 0U) + (last.is_last() ? 2U : 0U) + (last.has_new_time ? 4U : 0U);
  std::uint32_t changed = 0;
  if constexpr (Coder::encodes) changed = find_changed(point, channel);
  changed = coder.symbol(old.changed[context], changed);
  channel_is_new_ = (changed & channel_bit) != 0;
  if (channel_is_new_) {
    const auto step = static_cast<std::uint32_t>((channel + channels - channel_ - 1) % channels);
    channel_ = (channel_ + std::size_t{coder.symbol(old.channel_step, step)} + 1) % channels;
    if (!channels_[channel_].is_used) channels_[channel_].begin(last);
  }
  channels_[channel_].last.has_new_time = (changed & time_bit) != 0;
  return changed;
}

template <typename Coder>
void Point14Coder<Coder>::code_returns(Coder& coder, std::uint32_t changed, const Point14& point) {
  Channel& channel = channels_[channel_];
  Point14& last = channel.last;
  const std::uint8_t old = last.return_number;
  if ((changed & num_returns_bit) != 0) {
    SymbolModel& model = channel.num_returns_models[last.num_returns];
    last.num_returns = static_cast<std::uint8_t>(coder.symbol(model, point.num_returns));
  }
  std::uint32_t number = old;
  if ((changed & 3) == 1) number = old + 1U;
  if ((changed & 3) == 2) number = old + 15U;
  if ((changed & 3) == 3) {
    if (last.has_new_time) {
      number = coder.symbol(channel.return_numbers[old], point.return_number);
    } else {
      const std::uint32_t step = (point.return_number + 14U - old) % 16;
      number = old + coder.symbol(channel.return_step, step) + 2;
    }
  }
  last.return_number = number % 16;
}

template <typename Coder>
void Point14Coder<Coder>::code_position(Layers<Coder>& layers, const Point14& point) {
  Channel& channel = channels_[channel_];
  Point14& last = channel.last;
  const std::size_t context =
      2U * return_contexts[last.num_returns][last.return_number] + (last.has_new_time ? 1 : 0);
  const bool is_single = last.num_returns == 1;
  const auto step = channel.position.code_step(
      *layers[Layer::steps], channel.x_steps[context], channel.y_steps[context], is_single,
      {wrapped_difference(point.x, last.x), wrapped_difference(point.y, last.y)});
  last.x = wrapped_sum(last.x, step.x);
  last.y = wrapped_sum(last.y, step.y);
  if (!layers[Layer::heights]) return;
  std::int32_t& height = channel.heights[return_level(last.num_returns, last.return_number)];
  last.z = height =
      channel.position.code_height(*layers[Layer::heights], height, is_single, point.z);
}

template <typename Coder>
void Point14Coder<Coder>::code_bytes(Layers<Coder>& layers, const Point14& point) {
  Channel& channel = channels_[channel_];
  Point14& last = channel.last;
  const auto code = [&](std::size_t layer, SymbolModel& model, std::uint8_t value) {
    return static_cast<std::uint8_t>(layers[layer]->symbol(model, value));
  };
  if (layers[Layer::classes]) {
    const std::size_t context = (last.classification & 31U) * 2 + (last.kind() == 3 ? 1 : 0);
    last.classification = code(Layer::classes, channel.classes[context], point.classification);
  }
  if (layers[Layer::flags]) {
    last.flags = code(Layer::flags, channel.flags[last.flags], point.flags);
  }
  if (layers[Layer::user_data]) {
    last.user_data =
        code(Layer::user_data, channel.user_data[last.user_data / 4U], point.user_data);
  }
}

template <typename Coder>
void Point14Coder<Coder>::code_numbers(Layers<Coder>& layers, std::uint32_t changed,
                                       const Point14& point) {
  Channel& channel = channels_[channel_];
  Point14& last = channel.last;
  const std::size_t new_time = last.has_new_time ? 1 : 0;
  const auto code = [&](std::size_t layer, IntegerCoder& numbers, std::uint16_t old,
                        std::uint16_t value, std::size_t context) {
    return static_cast<std::uint16_t>(numbers.code(*layers[layer], old, value, context));
  };
  if (layers[Layer::intensities]) {
    const std::size_t kind = last.kind();
    std::uint16_t& old = channel.intensities[2 * kind + new_time];
    last.intensity = old = code(Layer::intensities, channel.intensity, old, point.intensity, kind);
  }
  if (layers[Layer::scan_angles] && (changed & scan_angle_bit) != 0) {
    last.scan_angle =
        code(Layer::scan_angles, channel.scan_angle, last.scan_angle, point.scan_angle, new_time);
  }
  if (layers[Layer::sources] && (changed & source_bit) != 0) {
    last.source = code(Layer::sources, channel.source, last.source, point.source, 0);
  }
  if (layers[Layer::times] && (changed & time_bit) != 0) {
    last.time = channel.times.code(*layers[Layer::times], point.time);
  }
}

/// Colour, infrared and additional bytes of a point.
struct Extras {
  Colour colour{};
  std::uint16_t infrared = 0;
  std::vector<std::uint8_t> bytes;
};

/// Coder of the colours or the additional bytes of several channels. Version 3 predicts some of
/// them from a wrong channel, which must be reproduced; version 4 corrects this.
template <typename State>
class ChannelStates {
 public:
  void begin(const Extras& first, std::size_t channel) {
    for (State& other : states_) other.is_used = false;
    channel_ = channel;
    states_[channel_].begin(first);
  }

  /// Returns the models of `channel`, which is the channel according to the version, and the state
  /// with the last value.
  std::pair<State&, State&> select(std::size_t channel, int version) {
    std::size_t remembered = channel_;
    if (channel != channel_) {
      const bool is_new = !states_[channel].is_used;
      if (is_new) states_[channel].begin(states_[channel_].last);
      channel_ = channel;
      if (is_new || version > 3) remembered = channel;
    }
    return {states_[channel_], states_[remembered]};
  }

 private:
  std::array<State, channels> states_;
  std::size_t channel_ = 0;
};

struct ColourState {
  bool is_used = false;
  Extras last;
  ColourCoder colour;
  SymbolModel infrared_mask{4};
  std::array<SymbolModel, 2> infrared_bytes;

  void begin(const Extras& first) {
    is_used = true;
    last = first;
    colour.reset();
    infrared_mask.reset();
    for (SymbolModel& model : infrared_bytes) model.reset();
  }
};

struct ByteState {
  bool is_used = false;
  Extras last;
  Models bytes;

  void begin(const Extras& first) {
    is_used = true;
    last = first;
    bytes.resize(first.bytes.size());
    for (SymbolModel& model : bytes) model.reset();
  }
};

/// Codes the change of a byte.
template <typename Coder>
std::uint8_t code_byte(Coder& coder, SymbolModel& model, std::uint8_t last, std::uint8_t value) {
  return static_cast<std::uint8_t>(last + coder.symbol(model, (value + 256U - last) & 0xFFU));
}

template <typename Coder>
std::uint16_t code_infrared(Coder& coder, ColourState& state, std::uint16_t last,
                            std::uint16_t value) {
  std::uint32_t mask = 0;
  if constexpr (Coder::encodes) {
    const std::uint32_t difference = last ^ value;
    mask = ((difference & 0xFF) != 0 ? 1U : 0U) + (difference >> 8 != 0 ? 2U : 0U);
  }
  mask = coder.symbol(state.infrared_mask, mask);
  std::uint32_t result = 0;
  for (std::uint32_t half = 0; half < 2; ++half) {
    auto byte = static_cast<std::uint8_t>(last >> 8 * half);
    if ((mask >> half & 1) != 0) {
      byte = code_byte(coder, state.infrared_bytes[half], byte,
                       static_cast<std::uint8_t>(value >> 8 * half));
    }
    result |= std::uint32_t{byte} << 8 * half;
  }
  return static_cast<std::uint16_t>(result);
}

Extras to_extras(const PointLayout& layout, const char* bytes) {
  Extras extras;
  if (layout.has_colour) extras.colour = value_at<Colour>(bytes, point::colour);
  if (layout.has_infrared) extras.infrared = value_at<std::uint16_t>(bytes, infrared_offset);
  extras.bytes.assign(bytes + layout.extra_offset, bytes + layout.size);
  return extras;
}

/// Coder of all layers of a chunk.
template <typename Coder>
class LayeredCoder {
 public:
  LayeredCoder(const PointLayout& layout, int version) : layout_(layout), version_(version) {}

  void begin(const char* first) {
    const std::size_t channel = channel_of(first);
    points_.begin(to_point(first), channel);
    const Extras extras = to_extras(layout_, first);
    colours_.begin(extras, channel);
    bytes_.begin(extras, channel);
  }

  /// Encodes `point`.
  void encode(Layers<Coder>& layers, const char* point) {
    points_.code(layers, to_point(point), channel_of(point));
    code_extras(layers, to_extras(layout_, point), nullptr);
  }

  /// Decodes into `point`.
  void decode(Layers<Coder>& layers, char* point, bool decodes_all) {
    const Point14& decoded = points_.code(layers, {}, 0);
    put_needed_fields(decoded, points_.channel(), point);
    if (decodes_all) put_other_fields(decoded, point);
    if (layout_.has_colour || decodes_all) code_extras(layers, no_extras_, point);
  }

 private:
  /// Decoded values are written to `point`, unless it is null.
  void code_extras(Layers<Coder>& layers, const Extras& extras, char* point);

  PointLayout layout_;
  int version_;
  Point14Coder<Coder> points_;
  ChannelStates<ColourState> colours_;
  ChannelStates<ByteState> bytes_;
  Extras no_extras_{{}, 0, std::vector<std::uint8_t>(layout_.extra())};
};

template <typename Coder>
void LayeredCoder<Coder>::code_extras(Layers<Coder>& layers, const Extras& extras, char* point) {
  const bool is_channel_known = version_ > 3 || points_.channel_is_new();
  const std::size_t channel = is_channel_known ? points_.channel() : 0;
  if (layout_.has_colour) {
    const auto [models, remembered] = colours_.select(channel, version_);
    Extras& last = remembered.last;
    if (layers[Layer::colours]) {
      last.colour = models.colour.code(*layers[Layer::colours], last.colour, extras.colour);
    }
    if (point != nullptr) put_value(point, point::colour, last.colour);
    if (layout_.has_infrared) {
      auto& coder = layers[Layer::infrared];
      if (coder) last.infrared = code_infrared(*coder, models, last.infrared, extras.infrared);
      if (point != nullptr) put_value(point, infrared_offset, last.infrared);
    }
  }
  if (layout_.extra() == 0) return;
  const auto [models, remembered] = bytes_.select(channel, version_);
  for (std::size_t i = 0; i < layout_.extra(); ++i) {
    auto& coder = layers[layout_.first_extra_layer + i];
    std::uint8_t& last = remembered.last.bytes[i];
    if (coder) last = code_byte(*coder, models.bytes[i], last, extras.bytes[i]);
    if (point != nullptr) point[layout_.extra_offset + i] = static_cast<char>(last);
  }
}

class LayeredDecoder : public ChunkDecoder {
 public:
  LayeredDecoder(const PointLayout& layout, int version, bool decodes_all)
      : layout_(layout),
        decodes_all_(decodes_all),
        coder_(layout, version),
        compressed_(layout.layers()),
        is_there_(layout.layers()),
        layers_(layout.layers()) {}

  void begin(ByteWindow chunk, char* point) override {
    chunk.take(point, layout_.size);
    find_layers(chunk);
    coder_.begin(point);
    is_open_ = false;
  }

  void next(char* point) override {
    if (!is_open_) open_layers();
    coder_.decode(layers_, point, decodes_all_);
  }

 private:
  void find_layers(ByteWindow& chunk);
  void open_layers();
  bool is_needed(std::size_t layer) const {
    return decodes_all_ || layer <= flags || (layer == colours && layout_.has_colour);
  }

  PointLayout layout_;
  bool decodes_all_;
  LayeredCoder<ArithmeticDecoder> coder_;
  std::vector<ByteWindow> compressed_;
  std::vector<bool> is_there_;
  bool is_open_ = false;
  Layers<ArithmeticDecoder> layers_;
};

/// Reads the data after the first point: number of points (known from the chunk table), size of
/// each layer, and layers.
void LayeredDecoder::find_layers(ByteWindow& chunk) {
  chunk.value<std::uint32_t>();
  std::vector<std::uint32_t> sizes(compressed_.size());
  for (std::uint32_t& size : sizes) size = chunk.value<std::uint32_t>();
  std::uint64_t begin = chunk.offset();
  for (std::size_t layer = 0; layer < sizes.size(); ++layer) {
    is_there_[layer] = sizes[layer] != 0;
    if (is_needed(layer)) compressed_[layer] = chunk.part(begin, sizes[layer]);
    begin += sizes[layer];
  }
}

/// A chunk of one point may have no layers.
void LayeredDecoder::open_layers() {
  for (std::size_t layer = 0; layer < layers_.size(); ++layer) {
    layers_[layer].reset();
    const bool is_coded = layer == steps || is_there_[layer];
    if (is_coded && is_needed(layer)) layers_[layer].emplace(std::move(compressed_[layer]));
  }
  is_open_ = true;
}

class LayeredEncoder final : public ChunkEncoder {
 public:
  explicit LayeredEncoder(const PointLayout& layout)
      : layout_(layout),
        coder_(layout, 3),
        layers_(layout.layers()),
        changed_(layout.layers()),
        first_(layout.size, '\0') {
    for (auto& layer : layers_) layer.emplace();
  }

  void add(const char* point) override {
    if (points_++ == 0) {
      first_.assign(point, layout_.size);
      coder_.begin(point);
      changed_.assign(changed_.size(), false);
      return;
    }
    mark_changes(point);
    coder_.encode(layers_, point);
  }

  std::uint32_t points() const override { return points_; }
  std::string finish() override;

 private:
  /// A layer is omitted if all points have the value of the first point.
  void mark_changes(const char* point);

  PointLayout layout_;
  LayeredCoder<ArithmeticEncoder> coder_;
  Layers<ArithmeticEncoder> layers_;
  std::vector<bool> changed_;
  std::string first_;
  std::uint32_t points_ = 0;
};

void LayeredEncoder::mark_changes(const char* bytes) {
  const auto compare = [&](std::size_t layer, std::size_t offset, std::size_t size) {
    if (std::memcmp(bytes + offset, first_.data() + offset, size) != 0) changed_[layer] = true;
  };
  compare(classes, point::classification, 1);
  constexpr int channel_bits = 0x30;
  if (((bytes[point::flags] ^ first_[point::flags]) & ~channel_bits) != 0) changed_[flags] = true;
  compare(intensities, point::intensity, 2);
  compare(scan_angles, point::scan_angle, 2);
  compare(Layer::user_data, point::user_data, 1);
  compare(sources, point::source, 2);
  compare(times, point::time, 8);
  if (layout_.has_colour) compare(colours, point::colour, sizeof(Colour));
  if (layout_.has_infrared) compare(infrared, infrared_offset, 2);
  for (std::size_t i = 0; i < layout_.extra(); ++i) {
    compare(layout_.first_extra_layer + i, layout_.extra_offset + i, 1);
  }
}

std::string LayeredEncoder::finish() {
  if (points_ == 0) return {};
  std::string chunk = first_;
  append_value(chunk, points_);
  std::string content;
  for (std::size_t layer = 0; layer < layers_.size(); ++layer) {
    const std::string bytes = layers_[layer]->finish();
    const bool is_written = layer <= heights || changed_[layer];
    append_value(chunk, static_cast<std::uint32_t>(is_written ? bytes.size() : 0));
    if (is_written) content += bytes;
  }
  points_ = 0;
  return chunk + content;
}

}  // namespace

std::unique_ptr<ChunkDecoder> make_layered_decoder(int format, int version, std::size_t point_size,
                                                   bool decodes_all) {
  return std::make_unique<LayeredDecoder>(PointLayout(format, point_size), version, decodes_all);
}

std::unique_ptr<ChunkEncoder> make_chunk_encoder(int format, std::size_t point_size) {
  return std::make_unique<LayeredEncoder>(PointLayout(format, point_size));
}

std::size_t layer_count(int format, std::size_t point_size) {
  return PointLayout(format, point_size).layers();
}

}  // namespace skycap::geometry::las
