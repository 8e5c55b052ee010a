/// The page's sources, which the build puts into the program.
#pragma once

#include <string_view>
#include <vector>

namespace skycap::missions::report {

std::string_view page_frame();   ///< page/page.html: where {{title}}, {{data}} ... belong
std::string_view page_style();   ///< page/style.css
std::string_view page_script();  ///< page/*.js, one after the other

/// A JavaScript library of Debian's.
struct PageLibrary {
  std::string_view name;  ///< three, orbit or chart
  std::string_view text;
};

/// In the order in which they must be run.
const std::vector<PageLibrary>& page_libraries();

}  // namespace skycap::missions::report
