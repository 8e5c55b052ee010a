/// Sources of the HTML report, compiled into the program.
#pragma once

#include <string_view>
#include <vector>

namespace skycap::missions::report {

/// Returns page/page.html, with the placeholders {{title}}, {{data}}, ...
std::string_view page_frame();
std::string_view page_style();   ///< Returns page/style.css.
std::string_view page_script();  ///< Returns page/*.js, concatenated.

/// JavaScript library packaged by Debian.
struct PageLibrary {
  std::string_view name;  ///< name of the library: three, orbit or chart
  std::string_view text;
};

/// Returns the libraries in execution order.
const std::vector<PageLibrary>& page_libraries();

}  // namespace skycap::missions::report
