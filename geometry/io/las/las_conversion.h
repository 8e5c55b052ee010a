/// Conversion of LAS and LAZ files of any size to LAS 1.4 with point formats 6 to 8.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "geometry/io/las/las_reader.h"
#include "geometry/io/las/las_writer.h"

namespace skycap::geometry::las {

/// Returns the records of a file that describe its reference system and its additional bytes.
/// Appends a sentence to `lost` for each record that is too long.
std::vector<WrittenRecord> kept_records(LasReader& reader, std::vector<std::string>& lost);

/// Converts points of any format to format 6, 7 (with colours) or 8 (with infrared), keeping all
/// fields and additional bytes. Waveforms are discarded.
class PointUpgrade {
 public:
  explicit PointUpgrade(const LasHeader& header);

  int format() const { return format_; }
  std::uint16_t extra_bytes() const { return static_cast<std::uint16_t>(extra_); }
  bool drops_waveforms() const { return waveform_ != 0; }

  /// Replaces `upgraded` with the converted records.
  void convert(std::string_view records, std::string& upgraded) const;

 private:
  void convert_old(const char* from, char* to) const;

  int old_format_, format_;
  std::size_t old_size_, size_, extra_, waveform_ = 0;
};

/// Receives the fraction of the points that have been converted.
using ConversionProgress = std::function<void(double share)>;

/// Writes `from` to `to` with the same integer coordinates, scale and fields. `shift` is added to
/// the offset [m]. `crs_wkt` replaces the reference system unless it is empty. Returns one sentence
/// per property that is not kept. Throws Error{bad_file}.
std::vector<std::string> convert_las(const std::filesystem::path& from,
                                     const std::filesystem::path& to, bool is_compressed,
                                     const Eigen::Vector3d& shift, const std::string& crs_wkt,
                                     const ConversionProgress& progress);

}  // namespace skycap::geometry::las
