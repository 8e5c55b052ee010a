#include "missions/scene/scene_tiles.h"

#include <algorithm>
#include <map>
#include <span>
#include <string_view>
#include <system_error>

#include <fmt/format.h>
#include <fnmatch.h>
#include <nlohmann/json.hpp>

#include "geometry/error.h"
#include "geometry/io/file.h"
#include "geometry/io/json.h"
#include "geometry/io/record_log.h"
#include "geometry/parallel.h"
#include "geometry/pose/world.h"
#include "geometry/split_mix.h"
#include "missions/scene/scene_source.h"
#include "missions/support/json_text.h"
#include "missions/support/sha256.h"
#include "missions/support/yaml_section.h"
#include "missions/support/yaml_tree.h"
#include "missions/version.h"
#include "sim/models/models.h"

namespace skycap::missions::scene {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;

/// Maximum number of tiles in the rows and columns of one entry.
constexpr int max_copies = 1'000'000;

/// Entry of a tiles file.
class TileEntry {
 public:
  /// `file` is the path of the tiles file in the scene. Paths in it are relative to its folder.
  TileEntry(support::YamlSection& section, const SceneOptions& scene, const fs::path& file,
            const fs::path& folder)
      : section_(section), base_path_(fs::path(file).parent_path()), folder_(folder) {
    one_.ground = scene.ground;  // Prevents tiles from having their own ground.
  }

  void append_to(std::vector<TileKind>& tiles) {
    if (section_.has("files") == section_.has("model")) {
      section_.fail_at("files",
                       "conflicts with model or is missing; set either files (a pattern such as "
                       "tiles/*.ply) or model");
    }
    origin_ = origin();
    const std::string key = section_.has("files") ? "files" : "model";
    if (section_.text(key).ends_with(".tiles")) {
      section_.fail_at(key, "is itself a tile list; use meshes or a model");
    }
    if (key == "files") {
      append_files(tiles);
    } else {
      append_blocks(tiles);
    }
    section_.finish();
  }

 private:
  Vector3d origin() {
    const std::vector<double> numbers = section_.numbers("position");
    if (numbers.empty()) return Vector3d::Zero();
    if (numbers.size() != 3) section_.fail_at("position", "must be [east, north, up] in metres");
    return {numbers[0], numbers[1], numbers[2]};
  }

  void append_files(std::vector<TileKind>& tiles) {
    const fs::path pattern = section_.text("files");
    std::vector<std::string> names;
    std::error_code failure;
    for (const auto& entry :
         fs::directory_iterator(folder_ / base_path_ / pattern.parent_path() / ".", failure)) {
      const std::string name = entry.path().filename();
      if (fnmatch(pattern.filename().c_str(), name.c_str(), FNM_PERIOD) == 0) {
        names.push_back(name);
      }
    }
    if (names.empty()) {
      section_.fail_at("files", "is " + pattern.string() +
                                    " and matches no file; specify a pattern of mesh files in one "
                                    "folder, such as tiles/*.ply");
    }
    std::ranges::sort(names);
    for (const std::string& name : names) {
      one_.model = base_path_ / pattern.parent_path() / name;
      tiles.push_back({one_, {origin_}});
    }
  }

  int count(const std::string& key) {
    const int number = section_.integer(key, 1);
    if (number < 1 || number > 10'000) section_.fail_at(key, "must be from 1 to 10000");
    return number;
  }

  /// Adds rows and columns of models. The kind at each position is drawn from the position's
  /// number, so that there is no visible pattern.
  void append_blocks(std::vector<TileKind>& tiles) {
    const std::string model = section_.text("model");
    const bool is_builtin = model.starts_with("builtin:");
    one_.model = is_builtin || model.starts_with("model:") ? model : (base_path_ / model).string();
    const int columns = count("columns"), rows = count("rows");
    if (columns * rows > max_copies) {
      section_.fail_at("rows",
                       "multiplied by columns must be at most " + std::to_string(max_copies));
    }
    const bool is_alone = columns == 1 && rows == 1;
    const double spacing = is_alone ? section_.number("spacing", 0.0) : section_.number("spacing");
    if (!is_alone && !(spacing > 0.0)) section_.fail_at("spacing", "must be above 0");
    const int all_kinds = section_.integer("kinds", 1), seed = section_.integer("seed", 1);
    const bool is_drawn = is_builtin && sim::is_drawn(std::string_view(model).substr(8));
    if (all_kinds < 0 || (all_kinds != 1 && !is_drawn)) {
      section_.fail_at("kinds",
                       "is the number of different models (0: all) and applies only to generated "
                       "builtin models, such as builtin:city-block");
    }
    if (seed < 0) section_.fail_at("seed", "must not be negative");
    std::map<std::uint64_t, TileKind> kinds;
    for (int row = 0; row < rows; ++row) {
      for (int column = 0; column < columns; ++column) {
        const auto block = static_cast<std::uint64_t>(row) * static_cast<std::uint64_t>(columns) +
                           static_cast<std::uint64_t>(column);
        const std::uint64_t kind =
            all_kinds == 0 ? block
                           : geometry::split_mix(block) % static_cast<std::uint64_t>(all_kinds);
        TileKind& tile = kinds.try_emplace(kind, TileKind{one_, {}}).first->second;
        tile.scene.seed = static_cast<std::uint64_t>(seed) + kind;
        tile.shifts.push_back(origin_ + spacing * Vector3d(column - 0.5 * (columns - 1),
                                                           row - 0.5 * (rows - 1), 0.0));
      }
    }
    for (auto& [number, tile] : kinds) tiles.push_back(std::move(tile));
  }

  support::YamlSection& section_;
  fs::path base_path_, folder_;
  SceneOptions one_;
  Vector3d origin_ = Vector3d::Zero();
};

void require_for_tiles(const SceneOptions& scene) {
  const auto reject = [](const char* key) {
    throw Error(ErrorKind::bad_config, std::string(key) + " conflicts with a tile list; remove it");
  };
  if (!scene.copies.empty()) reject("scene.copies");
  if (scene.longest_side) reject("scene.longest_side");
  if (scene.materials) reject("scene.materials");
}

std::uint32_t checksum(const geometry::Mesh& mesh) {
  const auto compute_checksum = [](const auto& items) {
    return geometry::compute_crc32(
        {reinterpret_cast<const char*>(items.data()), items.size() * sizeof(items[0])});
  };
  return compute_checksum(mesh.vertices) ^
         static_cast<std::uint32_t>(
             geometry::split_mix(compute_checksum(mesh.triangles)));  // Avoids cancellation.
}

Eigen::AlignedBox3d at(const Eigen::AlignedBox3d& box, const Eigen::Isometry3d& pose) {
  return {box.min() + pose.translation(), box.max() + pose.translation()};
}

}  // namespace

bool is_tiled(const SceneOptions& scene) { return scene.model.ends_with(".tiles"); }

std::vector<TileKind> find_tiles(const SceneOptions& scene, const fs::path& folder) {
  require_for_tiles(scene);
  const std::string name = (folder / scene.model).string();
  const support::YamlNode root = support::parse_yaml(geometry::read_file(name), name);
  support::YamlSection sections(root, "", name);
  std::vector<TileKind> tiles;
  for (support::YamlSection& section : sections.sections("tiles")) {
    TileEntry(section, scene, scene.model, folder).append_to(tiles);
  }
  sections.finish();
  if (tiles.empty()) sections.fail_at("tiles", "is missing; list the tiles of the scene");
  return tiles;
}

TiledScene::TiledScene(const SceneOptions& scene, const fs::path& folder, unsigned threads,
                       const fs::path& index)
    : scene_(scene), folder_(folder) {
  for (TileKind& tile : find_tiles(scene_, folder)) kinds_.push_back({std::move(tile), {}, 0, {}});
  if (!read_index(index)) {
    geometry::parallel_for(kinds_.size(), threads, [&](std::size_t i) { look_at(kinds_[i]); });
    write_index(index);
  }
  std::string checksums;
  for (const Kind& kind : kinds_) {
    checksums += kind.content_checksum;
    for (const Eigen::Isometry3d& pose : copy_poses(kind.tile)) {
      const Eigen::AlignedBox3d box = at(kind.box, pose);
      for (const Vector3d& corner : {box.min(), box.max()}) {
        geometry::require_valid_position(corner,
                                         kind.tile.scene.model + ": a corner of the placed tile");
      }
      box_.extend(box);
      triangles_ += kind.triangles;
      for (const double at : pose.translation()) checksums += fmt::format(" {}", at);
    }
  }
  surroundings_ = make_surroundings(scene, box_);
  content_checksum_ = fmt::format("{} tiles {:08x} {:08x}", kinds_.size(),
                                  geometry::compute_crc32(checksums), checksum(surroundings_));
}

void TiledScene::look_at(Kind& kind) const {
  const geometry::Mesh mesh = turned_and_scaled(kind.tile);
  kind.box = geometry::bounding_box(mesh);
  kind.triangles = mesh.triangles.size();
  kind.content_checksum = fmt::format("{:08x}", checksum(mesh));
}

/// Returns all inputs that determine the result of look_at().
std::string TiledScene::index_key() const {
  std::string inputs = version;
  const Eigen::Affine3d turn = turn_and_scale(scene_);
  for (int i = 0; i < 16; ++i) inputs += fmt::format(" {}", turn.matrix()(i / 4, i % 4));
  for (const Kind& kind : kinds_) {
    const SceneOptions& one = kind.tile.scene;
    inputs += fmt::format("\n{} {} {}", one.model, one.seed, one.ground);
    const fs::path file = folder_ / one.model;
    std::error_code none;
    if (!fs::is_regular_file(file, none)) continue;
    inputs += fmt::format(" {} {}", fs::file_size(file),
                          fs::last_write_time(file).time_since_epoch().count());
  }
  return support::sha256(std::as_bytes(std::span(inputs)));
}

bool TiledScene::read_index(const fs::path& index) {
  std::error_code none;
  if (index.empty() || !fs::is_regular_file(index, none)) return false;
  try {
    const auto json = geometry::parse_json<nlohmann::ordered_json>(geometry::read_file(index));
    const auto& kinds = json.at("kinds");
    if (json.at("of") != index_key() || kinds.size() != kinds_.size()) return false;
    for (std::size_t i = 0; i < kinds_.size(); ++i) {
      kinds_[i].box = {support::to_vector(kinds[i].at("low")),
                       support::to_vector(kinds[i].at("high"))};
      kinds_[i].triangles = kinds[i].at("triangles").get<std::size_t>();
      kinds_[i].content_checksum = kinds[i].at("digest").get<std::string>();
    }
    return true;
  } catch (const nlohmann::json::exception&) {
    return false;
  } catch (const Error&) {  // The index will be created again.
    return false;
  }
}

void TiledScene::write_index(const fs::path& index) const {
  if (index.empty()) return;
  auto kinds = nlohmann::ordered_json::array();
  for (const Kind& kind : kinds_) {
    kinds.push_back({{"low", support::to_json(Vector3d(kind.box.min()))},
                     {"high", support::to_json(Vector3d(kind.box.max()))},
                     {"triangles", kind.triangles},
                     {"digest", kind.content_checksum}});
  }
  try {
    geometry::write_file(index, support::json_text({{"of", index_key()}, {"kinds", kinds}}));
  } catch (const Error&) {
    // Another process may be writing the same file. Without the index, the next run reads the
    // meshes again.
  }
}

geometry::Mesh TiledScene::turned_and_scaled(const TileKind& tile) const {
  geometry::Mesh mesh = load_model(tile.scene, folder_);
  geometry::transform(mesh, turn_and_scale(scene_));
  return mesh;
}

std::vector<Eigen::Isometry3d> TiledScene::copy_poses(const TileKind& tile) const {
  const Eigen::Affine3d turn = turn_and_scale(scene_);
  std::vector<Eigen::Isometry3d> poses;
  for (const Vector3d& shift : tile.shifts) {
    poses.emplace_back(Eigen::Translation3d(scene_.position + turn.linear() * shift));
  }
  return poses;
}

sim::Scene TiledScene::scene(unsigned threads, const TileFilter& tile_filter) const {
  sim::SceneBuilder builder(centre(), threads);
  const auto reflectance = static_cast<float>(scene_.reflectance);
  const auto collect_reflectances = [&](const geometry::Mesh& mesh) {
    const bool is_usual = reflectance == sim::Scene::default_reflectance;
    return std::vector<float>(is_usual ? 0 : mesh.triangles.size(), reflectance);
  };
  for (const Kind& kind : kinds_) {
    std::vector<Eigen::Isometry3d> poses = copy_poses(kind.tile);
    std::erase_if(poses, [&](const auto& pose) { return !tile_filter(at(kind.box, pose)); });
    if (poses.empty()) continue;
    const geometry::Mesh mesh = turned_and_scaled(kind.tile);
    const std::vector<sim::Surface> surfaces = load_surfaces(kind.tile.scene, folder_);
    builder.add({mesh, collect_reflectances(mesh), poses, surfaces});
  }
  if (!surroundings_.triangles.empty())
    builder.add({surroundings_, collect_reflectances(surroundings_), {}});
  return builder.finish();
}

}  // namespace skycap::missions::scene
