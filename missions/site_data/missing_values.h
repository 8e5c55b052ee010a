/// Missing values of a file of prior data.
#pragma once

#include <string>

#include "missions/site_data/source.h"

namespace skycap::missions::site_data {

/// Values that neither a file nor its source has, without which it cannot be read.
struct MissingValues {
  bool crs = false, vertical = false;
  bool base = false;           ///< of outlines
  std::string compute_height;  ///< the first outline without a height; empty: none
};

/// Throws what read_prior() throws for a file that cannot be opened.
MissingValues missing_values(const Source& source);

}  // namespace skycap::missions::site_data
