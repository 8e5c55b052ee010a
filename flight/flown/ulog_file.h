/// Messages of a PX4 ULog (.ulg), in the formats that the log describes.
///
/// Source: PX4 User Guide, ULog File Format: a header of 16 bytes, then messages with a header of
/// size (2 bytes) and type (1 byte).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace skycap::flight {

/// Field of a logged topic. Members of nested types have names such as "outer.inner".
struct UlogField {
  std::string type, name;
  std::size_t offset = 0;  ///< [bytes]
  std::size_t count = 1;   ///< Number of elements.
};

/// Data of a topic at one time. Refers to the format and to the bytes of the log.
class UlogMessage {
 public:
  UlogMessage(const std::string& topic, int instance, const std::vector<UlogField>& fields,
              std::string_view data)
      : topic_(topic), instance_(instance), fields_(fields), data_(data) {}

  const std::string& topic() const { return topic_; }
  int instance() const { return instance_; }  ///< Number of the topic's publisher, from 0.
  std::optional<double> number(std::string_view name, std::size_t index = 0) const;
  double number_or(std::string_view name, double otherwise) const {
    return number(name).value_or(otherwise);
  }
  double time() const { return 1e-6 * number_or("timestamp", 0.0); }  ///< Time since start [s].
  /// Returns four elements of a field (w, x, y, z), or std::nullopt.
  std::optional<std::array<double, 4>> quaternion(std::string_view name) const;

 private:
  const std::string& topic_;
  int instance_;
  const std::vector<UlogField>& fields_;
  std::string_view data_;
};

/// Splits a log, which may arrive in pieces, into messages. Skips damaged data up to the next
/// synchronisation message, as PX4's tools do.
class UlogParser {
 public:
  using Receiver = std::function<void(const UlogMessage&)>;
  explicit UlogParser(Receiver receive) : receive_(std::move(receive)) {}

  /// As DataflashParser::parse(). Throws Error{bad_file} if the file is not a ULog.
  std::size_t parse(std::string_view bytes, bool is_last);

  std::size_t skipped() const { return skipped_; }     ///< Damaged bytes.
  bool is_truncated() const { return is_truncated_; }  ///< The last message is incomplete.
  double dropped() const { return dropped_; }          ///< Time that the logger lost [s].
  std::size_t dropouts() const { return dropouts_; }

 private:
  /// Topic that the log contains.
  struct Subscription {
    std::string topic;
    int instance = 0;
    std::vector<UlogField> fields;
  };

  void read_message(char type, std::string_view body);
  void read_format(std::string_view body);
  void read_flags(std::string_view body);
  void subscribe(std::string_view body);
  /// Appends the fields of a type at `offset` and returns the offset of their end, or std::nullopt
  /// for an unknown type.
  std::optional<std::size_t> add_fields(const std::string& type, const std::string& prefix,
                                        std::size_t offset, int depth,
                                        std::vector<UlogField>& fields) const;

  Receiver receive_;
  std::map<std::string, std::string> formats_;
  std::map<std::uint16_t, Subscription> subscriptions_;
  std::vector<std::uint64_t> appended_;  ///< Offsets of appended data in the file.
  std::uint64_t position_ = 0;           ///< Offset of the next unused byte in the file.
  bool has_header_ = false, is_truncated_ = false, is_lost_ = false;
  std::size_t skipped_ = 0, dropouts_ = 0;
  double dropped_ = 0.0;
};

}  // namespace skycap::flight
