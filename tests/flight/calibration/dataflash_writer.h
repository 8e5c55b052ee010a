/// Writes dataflash logs by AP_Logger's description of the format.
#pragma once

#include <cstdint>
#include <map>
#include <string>

namespace skycap::flight {

/// A type of messages as a log describes it.
struct LogFormat {
  std::uint8_t type = 0;
  std::string name, letters, labels;  ///< labels separated by commas
};

/// The size of its messages, header included.
std::size_t compute_size(const LogFormat& format);

class DataflashWriter {
 public:
  /// Adds the FMT message.
  void describe(const LogFormat& format);

  /// Adds a message of numbers by their labels, and of one text; what is not given is zero.
  void add(const LogFormat& format, const std::map<std::string, double>& values,
           const std::string& text = "");

  const std::string& bytes() const { return bytes_; }

 private:
  void begin(std::uint8_t type);
  void put_text(std::string text, std::size_t size);

  std::string bytes_;
};

}  // namespace skycap::flight
