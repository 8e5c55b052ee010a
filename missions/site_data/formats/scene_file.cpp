// Reader of scenes. Assimp runs in a separate process because damaged files can cause crashes or
// infinite loops.
#include <cstdint>
#include <exception>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "geometry/error.h"
#include "missions/site_data/formats/geodata_file.h"
#include "missions/site_data/formats/scene_nodes.h"
#include "missions/support/child_process.h"
#include "missions/support/module.h"

namespace skycap::missions::site_data {
namespace {

using support::ChildProcess;
using support::PipeWriter;

enum class Answer : std::uint8_t { nodes, error };

void put_nodes(PipeWriter& pipe, const std::vector<SceneNode>& nodes) {
  pipe.put(nodes.size());
  for (const SceneNode& node : nodes) {
    pipe.put_text(node.id);
    pipe.put(node.parent.value_or(nodes.size()));
    const auto& vertices = node.mesh.vertices;
    pipe.put_row(vertices.empty() ? nullptr : vertices.data()->data(), 3 * vertices.size());
    pipe.put_row(node.mesh.triangles.data(), node.mesh.triangles.size());
  }
}

std::vector<SceneNode> receive_nodes(ChildProcess& child) {
  const auto count = child.read<std::size_t>();
  std::vector<SceneNode> nodes;
  for (std::size_t i = 0; i < count; ++i) {
    SceneNode& node = nodes.emplace_back();
    node.id = child.read_text();
    const auto parent = child.read<std::size_t>();
    if (parent < i) node.parent = parent;
    const auto coordinates = child.read_row<std::vector<double>>();
    for (std::size_t at = 0; at + 2 < coordinates.size(); at += 3) {
      node.mesh.vertices.push_back(Eigen::Vector3d::Map(&coordinates[at]));
    }
    node.mesh.triangles = child.read_row<decltype(node.mesh.triangles)>();
  }
  return nodes;
}

void put_error(PipeWriter& pipe, const std::string& what) {
  pipe.put(Answer::error);
  pipe.put_text(what);
}

/// Main function of the child process.
void read_nodes(PipeWriter& pipe, ReadScene* read, const std::filesystem::path& file) {
  std::vector<SceneNode> nodes;
  try {
    read(file, nodes);
  } catch (const Error& failure) {
    return put_error(pipe, failure.what());
  } catch (const std::exception& failure) {
    return put_error(pipe, file.string() + ": cannot be read (assimp: " + failure.what() + ")");
  }
  pipe.put(Answer::nodes);
  put_nodes(pipe, nodes);
}

/// Returns an upper limit of Assimp's processor time for valid files, with a large margin [s].
unsigned max_seconds(const std::filesystem::path& file) {
  constexpr std::uintmax_t megabyte = 1'000'000;
  return static_cast<unsigned>(8 + 4 * (std::filesystem::file_size(file) / megabyte));
}

}  // namespace

FileContents read_scene(const std::filesystem::path& file) {
  ReadScene* const read =
      support::module_function<ReadScene>("libskycap_assimp.so", read_scene_name);
  ChildProcess child({file.string(), "assimp", max_seconds(file)},
                     [&](PipeWriter& pipe) { read_nodes(pipe, read, file); });
  if (child.read<Answer>() == Answer::error) throw Error(ErrorKind::bad_file, child.read_text());
  FileContents contents;
  contents.is_scene = true;
  contents.is_y_up = true;
  contents.unit = 1.0;
  for (SceneNode& node : receive_nodes(child)) {
    FileObject& object = contents.objects.emplace_back();
    object.id = std::move(node.id);
    object.parent = node.parent;
    object.mesh = std::move(node.mesh);
  }
  return contents;
}

}  // namespace skycap::missions::site_data
