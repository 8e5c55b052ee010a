#include <filesystem>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "geometry/error.h"
#include "geometry/io/column_cloud.h"
#include "geometry/io/file.h"
#include "geometry/io/las/las_conversion.h"
#include "missions/cli/commands.h"

namespace skycap::missions::cli {
namespace {

namespace fs = std::filesystem;

bool is_las_name(const fs::path& path) {
  const std::string extension = geometry::lower_extension(path);
  return extension == ".las" || extension == ".laz";
}

/// File beside the output that replaces it when it is complete, and is removed otherwise.
class PendingFile {
 public:
  explicit PendingFile(fs::path final_path)
      : final_path_(std::move(final_path)),
        path_(final_path_.parent_path() / (".part-" + final_path_.filename().string())) {
    if (final_path_.has_parent_path()) {
      std::error_code ignored;  // writing reports a missing folder
      fs::create_directories(final_path_.parent_path(), ignored);
    }
  }
  PendingFile(const PendingFile&) = delete;
  PendingFile& operator=(const PendingFile&) = delete;
  ~PendingFile() {
    std::error_code ignored;
    fs::remove(path_, ignored);
  }

  const fs::path& path() const { return path_; }

  /// Calls `write`. Messages of errors name the final file instead of this one.
  template <typename Write>
  auto named(const Write& write) const {
    try {
      return write();
    } catch (const Error& error) {
      std::string text = error.what();
      const std::string pending = path_.string();
      if (text.starts_with(pending)) text.replace(0, pending.size(), final_path_.string());
      throw Error(error.kind(), text);
    }
  }

  void commit() const {
    geometry::sync_to_disk(path_);
    std::error_code error;
    fs::rename(path_, final_path_, error);
    if (error) {
      throw Error(ErrorKind::bad_file,
                  final_path_.string() + ": cannot be written: " + error.message());
    }
  }

 private:
  fs::path final_path_, path_;
};

void require_names(const ConvertOptions& options) {
  if (!geometry::is_written_cloud(options.out)) {
    throw Error(ErrorKind::bad_usage,
                options.out.string() +
                    ": the name of the output must end in .ply, .pcd, .las, .laz, .e57, .xyz, "
                    ".txt, .asc or .csv");
  }
  std::error_code ignored;
  if (fs::equivalent(options.in, options.out, ignored)) {
    throw Error(ErrorKind::bad_usage,
                options.out.string() + ": input and output are the same file; use another name");
  }
}

std::string read_crs(const std::optional<fs::path>& file) {
  if (!file) return {};
  std::string wkt = geometry::read_file(*file, 1 << 16);
  while (!wkt.empty() && (wkt.back() == '\n' || wkt.back() == '\r' || wkt.back() == ' ')) {
    wkt.pop_back();
  }
  const bool is_wkt = wkt.find('[') != std::string::npos && wkt.ends_with(']');
  constexpr std::size_t longest = 65534;
  if (is_wkt && wkt.size() <= longest) return wkt;
  throw Error(ErrorKind::bad_file, file->string() + ": is not a reference system in WKT");
}

}  // namespace

int convert_cloud(const ConvertOptions& options, const Console& console) {
  require_names(options);
  const std::string crs = read_crs(options.crs);
  const Eigen::Vector3d shift(options.shift[0], options.shift[1], options.shift[2]);
  const PendingFile pending(options.out);
  ProgressLine progress(console, options.is_quiet);
  const auto show = [&](double share) {
    if (console.stop.stop_requested()) throw Error(ErrorKind::bad_usage, "interrupted");
    progress.show(fmt::format("converting {}: {:.0f} %", options.in.string(), 100.0 * share));
  };
  std::vector<std::string> lost;
  std::size_t skipped = 0;
  show(0.0);
  if (is_las_name(options.in) && is_las_name(options.out)) {
    const bool is_compressed = geometry::lower_extension(options.out) == ".laz";
    lost = pending.named([&] {
      return geometry::las::convert_las(options.in, pending.path(), is_compressed, shift, crs,
                                        show);
    });
  } else {
    geometry::ColumnCloud cloud = geometry::read_column_cloud(options.in);
    if (!crs.empty()) cloud.crs_wkt = crs;
    if (!shift.isZero(0.0)) {
      for (Eigen::Vector3d& position : cloud.positions) position += shift;
    }
    lost = cloud.lost;
    skipped = cloud.skipped;
    show(0.5);
    const std::vector<std::string> more =
        pending.named([&] { return geometry::write_column_cloud(pending.path(), cloud); });
    lost.insert(lost.end(), more.begin(), more.end());
  }
  if (console.stop.stop_requested()) throw Error(ErrorKind::bad_usage, "interrupted");
  pending.commit();
  progress.clear();
  if (skipped > 0)
    lost.push_back(fmt::format("{} points are NaN or infinite and skipped", skipped));
  if (!lost.empty())
    warn(console, fmt::format("{}: {}", options.out.string(), fmt::join(lost, "; ")));
  if (!options.is_quiet) {
    console.out << fmt::format("{}: {:.1f} MB -> {}: {:.1f} MB\n", options.in.string(),
                               1e-6 * static_cast<double>(fs::file_size(options.in)),
                               options.out.string(),
                               1e-6 * static_cast<double>(fs::file_size(options.out)));
  }
  return 0;
}

}  // namespace skycap::missions::cli
