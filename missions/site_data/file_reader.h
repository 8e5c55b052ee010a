/// Reader of prior data in all formats. The format is detected from the contents, then from the
/// file name extension.
#pragma once

#include <memory>
#include <string>

#include "missions/site_data/formats/file_contents.h"
#include "missions/site_data/prior.h"

namespace skycap::missions::site_data {

/// Contents of a file. The caller may modify the points and nodes; all other members may be shared
/// with other callers, see ReadOnce.
using SharedContents = std::shared_ptr<FileContents>;

/// Reads the contents of a file in its own coordinates. Clouds are downsampled to the source's
/// spacing. Throws Error{bad_file} if the file is damaged, too large or of an unknown format.
SharedContents read_contents(const Source& source, const SiteFrame& site);

/// Cache for the last object file that the thread has parsed, active during the lifetime of the
/// object. A map can be target, obstacle and source of the site's position at the same time. The
/// cache contains one file. Clouds and rasters are not cached. A nested object has no effect.
class ReadOnce {
 public:
  ReadOnce();
  ReadOnce(const ReadOnce&) = delete;
  ReadOnce& operator=(const ReadOnce&) = delete;
  ~ReadOnce();

 private:
  friend SharedContents read_contents(const Source& source, const SiteFrame& site);

  std::string key_;  ///< All parameters that the contents depend on.
  SharedContents contents_;
};

}  // namespace skycap::missions::site_data
