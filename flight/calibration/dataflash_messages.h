/// Messages of an ArduPilot dataflash log (.bin), in the formats that the log describes (FMT;
/// AP_Logger/LogStructure.h).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace skycap::flight {

/// Format of the messages of one type, from an FMT message.
struct DataflashFormat {
  struct Field {
    std::string label;
    char letter = 0;         ///< Type, as in AP_Logger.
    std::size_t width = 0;   ///< [bytes]
    double unit = 1.0;       ///< Unit of the stored values.
    std::size_t offset = 0;  ///< Offset after the header [bytes].
  };
  std::string name;
  std::size_t size = 0;  ///< Size including the header [bytes].
  std::vector<Field> fields;

  /// Returns the field with this label, or null.
  const Field* find(std::string_view label) const;
};

/// Message with the format of its type. Refers to the format and to the bytes of the log.
class DataflashMessage {
 public:
  DataflashMessage(const DataflashFormat& format, std::string_view body)
      : format_(format), body_(body) {}

  const std::string& name() const { return format_.name; }

  std::optional<double> number(std::string_view label) const;
  double number_or(std::string_view label, double otherwise) const {
    return number(label).value_or(otherwise);
  }
  std::string text(std::string_view label) const;
  /// Returns the time [s]. Logs before Copter 3.3 store milliseconds.
  double time() const;
  /// Returns a reading. Logs before Copter 3.3 store it as an integer in hundredths.
  std::optional<double> reading(std::string_view label) const;

 private:
  const DataflashFormat& format_;
  std::string_view body_;
};

/// Message times, which ascend except for damage and restarts.
class LogClock {
 public:
  /// `keeps_gaps` states whether time continues after a gap at the logged time. Otherwise, a gap
  /// counts as a restart.
  explicit LogClock(bool keeps_gaps = false) : keeps_gaps_(keeps_gaps) {}

  /// Returns the continuous time [s], or std::nullopt for a damaged message.
  std::optional<double> read(double stated);

 private:
  /// Limits between consecutive messages [s].
  static constexpr double backwards = 1.0, forwards = 10.0;
  static constexpr int enough = 10;

  bool keeps_gaps_;
  double offset_ = 0.0, stranger_ = 0.0;
  std::optional<double> last_;
  int strangers_ = 0;
};

/// Splits a log, which may arrive in pieces, into messages. Skips damaged data: messages without a
/// valid successor.
class DataflashParser {
 public:
  using Receiver = std::function<void(const DataflashMessage&)>;
  explicit DataflashParser(Receiver receive) : receive_(std::move(receive)) {}

  /// Parses the messages in `bytes` and returns the number of bytes that were used. The remaining
  /// bytes must precede the next piece. `is_last` states that no bytes follow.
  std::size_t parse(std::string_view bytes, bool is_last);

  bool has_format() const { return has_format_; }      ///< A message format was described.
  std::size_t skipped() const { return skipped_; }     ///< Bytes outside of messages.
  bool is_truncated() const { return is_truncated_; }  ///< The last message is incomplete.

 private:
  Receiver receive_;
  std::array<std::optional<DataflashFormat>, 256> formats_;
  bool has_format_ = false, is_truncated_ = false;
  std::size_t skipped_ = 0;
};

}  // namespace skycap::flight
