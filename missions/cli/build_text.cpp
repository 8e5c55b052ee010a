#include "missions/cli/build_text.h"

#include "missions/build.h"
#include "missions/version.h"

namespace skycap::missions::cli {

std::string build_text() {
  return std::string("skycap ") + version + "\ncommit    " + build_commit + "\ncompiler  " +
         build_compiler + "\nbuild     " + build_preset + ", " + build_type;
}

}  // namespace skycap::missions::cli
