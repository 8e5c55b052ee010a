#include "geometry/error.h"
#include "missions/studio/http_interface.h"
#include "missions/support/module.h"

namespace skycap::missions::studio {

std::unique_ptr<HttpServer> make_http_server(int port, RequestHandler& handler) {
  using Make = HttpServer*(int, RequestHandler&);
  std::unique_ptr<HttpServer> server(
      support::module_function<Make>("libskycap_http.so", "skycap_http_server")(port, handler));
  if (!server) {
    throw Error(ErrorKind::bad_usage,
                "cannot listen on port " + std::to_string(port) +
                    " of 127.0.0.1; use another --port, or omit it for any free port");
  }
  return server;
}

}  // namespace skycap::missions::studio
