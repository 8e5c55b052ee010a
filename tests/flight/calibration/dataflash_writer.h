/// Writes DataFlash logs according to the format description of AP_Logger.
#pragma once

#include <cstdint>
#include <map>
#include <string>

namespace skycap::flight {

/// Message type as described in a log.
struct LogFormat {
  std::uint8_t type = 0;
  std::string name, letters, labels;  ///< labels separated by commas
};

/// Returns the message size [bytes] including the header.
std::size_t compute_size(const LogFormat& format);

class DataflashWriter {
 public:
  /// Adds the FMT message.
  void describe(const LogFormat& format);

  /// Adds a message with numbers by label and one optional text. Missing values are 0.
  void add(const LogFormat& format, const std::map<std::string, double>& values,
           const std::string& text = "");

  const std::string& bytes() const { return bytes_; }

 private:
  void begin(std::uint8_t type);
  void put_text(std::string text, std::size_t size);

  std::string bytes_;
};

}  // namespace skycap::flight
