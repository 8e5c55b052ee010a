// skycap studio: plans, looks at results and exports in the browser.
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <stop_token>
#include <string>

#include "geometry/error.h"
#include "missions/cli/command_options.h"
#include "missions/studio/service.h"
#include "missions/support/external_program.h"

namespace skycap::missions::cli {
namespace {

namespace fs = std::filesystem;

struct StudioOptions {
  fs::path what = ".";  ///< folder, or file whose folder is used
  int port = 0;
  bool opens_browser = true;
};

/// Opens an address in a browser. Without a display it is not tried, because xdg-open would start a
/// text browser that waits for a terminal.
bool is_opened(const std::string& address) {
  // NOLINTNEXTLINE(concurrency-mt-unsafe): nothing sets variables
  const bool has_screen = std::getenv("DISPLAY") || std::getenv("WAYLAND_DISPLAY");
  return has_screen && support::start_external_program({"xdg-open", address});
}

int studio(const StudioOptions& options, const Console& console) {
  std::error_code ignored;
  const bool is_folder = fs::is_directory(options.what, ignored);
  if (!is_folder && !fs::exists(options.what, ignored)) {
    throw Error(ErrorKind::bad_file, options.what.string() + ": does not exist");
  }
  const fs::path folder = is_folder                        ? options.what
                          : options.what.has_parent_path() ? options.what.parent_path()
                                                           : fs::path(".");
  studio::Service service(studio::WorkFolder(folder), fs::read_symlink("/proc/self/exe"),
                          is_folder ? "" : options.what.filename().string());
  const std::unique_ptr<studio::HttpServer> server =
      studio::make_http_server(options.port, service);
  service.set_port(server->port());

  // Ctrl-C cancels the commands, which save their results.
  const PendingResultsGuard results(console);
  const std::stop_callback stop(console.stop, [&] {
    server->stop();
    service.stop();
  });
  const std::string address = "http://127.0.0.1:" + std::to_string(server->port()) + "/" +
                              service.guard().page_token() + "/";
  console.out << "folder    " << service.folder().path().string() << "\naddress   " << address
              << "\nstop      Ctrl-C. Keep the address secret: it permits running Skycap\n"
              << std::flush;
  if (options.opens_browser && !is_opened(address)) {
    console.out << "next      open the address in a browser on this machine\n" << std::flush;
  }
  server->run();
  service.stop();
  return 0;
}

}  // namespace

void add_studio(CLI::App& app, const Console& console, Action& action) {
  CLI::App* command =
      app.add_subcommand("studio", "Plan, look at results and export in the browser");
  const auto options = std::make_shared<StudioOptions>();
  command->add_option("what", options->what,
                      "Folder, or a mission, map, model or cloud in it (default: this folder)");
  command->add_option("--port", options->port, "Port on 127.0.0.1 (default: 0, any free port)")
      ->check(CLI::Range(0, 65535));
  command->add_flag("!--no-browser", options->opens_browser, "Do not open the browser");
  command->callback(
      [=, &console, &action] { action = [=, &console] { return studio(*options, console); }; });
}

}  // namespace skycap::missions::cli
