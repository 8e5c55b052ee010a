/// Missing values that are required to read a file of prior data.
#pragma once

#include <string>

#include "missions/site_data/source.h"

namespace skycap::missions::site_data {

/// Required values that neither the file nor its source settings contain.
struct MissingValues {
  bool crs = false, vertical = false;
  bool base = false;                   ///< Base height of outlines.
  std::string outline_without_height;  ///< Name of the first outline without a height, or empty.
};

/// Returns the missing values of a source. Throws the same errors as read_prior() if the file
/// cannot be opened.
MissingValues missing_values(const Source& source);

}  // namespace skycap::missions::site_data
