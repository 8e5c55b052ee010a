/// Sources of the studio's page, compiled into the program.
#pragma once

#include <string_view>

namespace skycap::missions::studio {

std::string_view page_html();    ///< Returns page/studio.html.
std::string_view page_style();   ///< Returns page/studio.css.
std::string_view page_script();  ///< Returns page/*.js, concatenated.

}  // namespace skycap::missions::studio
