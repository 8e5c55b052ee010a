/// Any file of prior data, by its content and then by its ending.
#pragma once

#include <memory>
#include <string>

#include "missions/site_data/formats/file_contents.h"
#include "missions/site_data/prior.h"

namespace skycap::missions::site_data {

/// Contents of a file. Points and nodes belong to the caller alone, who may change them; all else
/// may be shared, see ReadOnce.
using SharedContents = std::shared_ptr<FileContents>;

/// What the file holds, in its own coordinates; clouds are thinned to the source's spacing. Throws
/// Error{bad_file} if it is broken, too large or of no known format.
SharedContents read_contents(const Source& source, const SiteFrame& site);

/// While one lives, its thread does not parse a file of objects again that it has parsed last: a
/// map may be the target, an obstacle, and asked for its own position. Holds the contents of one
/// file; clouds and rasters are read each time. Has no effect within the life of another one.
class ReadOnce {
 public:
  ReadOnce();
  ReadOnce(const ReadOnce&) = delete;
  ReadOnce& operator=(const ReadOnce&) = delete;
  ~ReadOnce();

 private:
  friend SharedContents read_contents(const Source& source, const SiteFrame& site);

  std::string key_;  ///< all that the contents depend on
  SharedContents contents_;
};

}  // namespace skycap::missions::site_data
