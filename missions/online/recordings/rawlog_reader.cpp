// Loader of the module that contains MRPT.
#include "missions/online/recordings/rawlog_reader.h"

#include "geometry/error.h"
#include "missions/online/recordings/reader_process.h"
#include "missions/support/module.h"

namespace skycap::missions::online {

std::unique_ptr<RawlogReader> open_rawlog(const std::filesystem::path& file) {
  if (!std::filesystem::is_regular_file(file)) {
    throw Error(ErrorKind::bad_file, file.string() + ": is not a file; expected an MRPT rawlog");
  }
  const auto make =
      support::module_function<MakeRawlogReader>("libskycap_rawlog.so", make_rawlog_reader_name);
  return read_apart(file.string(), [&] { return std::unique_ptr<RawlogReader>(make(file)); });
}

}  // namespace skycap::missions::online
