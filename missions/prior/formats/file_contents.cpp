#include "missions/prior/formats/file_contents.h"

#include "geometry/error.h"

namespace skycap::missions::prior {

void fail_file(const std::filesystem::path& file, const std::string& what) {
  throw Error(ErrorKind::bad_file, file.string() + ": " + what);
}

}  // namespace skycap::missions::prior
