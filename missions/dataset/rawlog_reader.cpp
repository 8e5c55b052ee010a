// Loads the module that knows MRPT.
#include "missions/dataset/rawlog_reader.h"

#include "geometry/error.h"
#include "missions/dataset/reader_process.h"
#include "missions/plugins/module.h"

namespace skycap::missions::dataset {

std::unique_ptr<RawlogReader> open_rawlog(const std::filesystem::path& file) {
  if (!std::filesystem::is_regular_file(file)) {
    throw Error(ErrorKind::bad_file, file.string() + ": is no file; name a rawlog of MRPT");
  }
  const auto make =
      plugins::module_function<MakeRawlogReader>("libskycap_rawlog.so", make_rawlog_reader_name);
  return read_apart(file.string(), [&] { return std::unique_ptr<RawlogReader>(make(file)); });
}

}  // namespace skycap::missions::dataset
