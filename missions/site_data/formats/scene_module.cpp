// Reader of scenes based on Assimp. scene_file.cpp loads this module in a separate process.
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <assimp/DefaultIOSystem.h>
#include <assimp/Importer.hpp>
#include <assimp/MemoryIOWrapper.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include "missions/site_data/formats/file_contents.h"
#include "missions/site_data/formats/scene_nodes.h"

namespace skycap::missions::site_data {
namespace {

constexpr int deepest = 60;  ///< Maximum nesting of nodes, as for objects in selection.cpp.

/// Decodes percent-encoded characters such as "%20".
std::string decoded(const std::string& name) {
  std::string result;
  for (std::size_t i = 0; i < name.size(); ++i) {
    unsigned code = 0;
    const bool is_code =
        name[i] == '%' && i + 2 < name.size() &&
        std::from_chars(&name[i + 1], &name[i + 1] + 2, code, 16).ptr == &name[i + 1] + 2;
    result += is_code ? static_cast<char>(code) : name[i];
    if (is_code) i += 2;
  }
  return result;
}

/// File access restricted to one folder and its subfolders, which contain buffers and materials of
/// a scene. Names may be URI references (RFC 3986).
class OneFolder final : public Assimp::DefaultIOSystem {
 public:
  explicit OneFolder(const std::filesystem::path& file) : folder_(find_folder(file)) {}

  Assimp::IOStream* Open(const char* file, const char* mode) override {
    const bool is_for_reading = mode != nullptr && mode[0] == 'r';
    if (!is_for_reading) return nullptr;
    std::error_code failure;
    std::string name = file;
    if (!std::filesystem::exists(name, failure)) name = decoded(name);
    if (!is_below(find_folder(name))) return nullptr;
    Assimp::IOStream* const stream = Assimp::DefaultIOSystem::Open(name.c_str(), mode);
    return stream == nullptr ? nullptr : without_mark(stream);
  }

 private:
  bool is_below(const std::filesystem::path& folder) const {
    return std::mismatch(folder_.begin(), folder_.end(), folder.begin(), folder.end()).first ==
           folder_.end();
  }
  /// Returns the stream without a UTF-8 byte order mark, which most of Assimp's readers do not
  /// support.
  static Assimp::IOStream* without_mark(Assimp::IOStream* stream) {
    std::array<char, 3> beginning{};
    const bool is_marked = stream->Read(beginning.data(), 1, 3) == 3 &&
                           std::string_view(beginning.data(), 3) == "\xEF\xBB\xBF";
    if (!is_marked) {
      stream->Seek(0, aiOrigin_SET);
      return stream;
    }
    const std::size_t size = stream->FileSize() - 3;
    auto* const bytes = new std::uint8_t[size];  // Owned by the stream.
    const std::size_t read = stream->Read(bytes, 1, size);
    delete stream;
    return new Assimp::MemoryIOStream(bytes, read, true);
  }
  /// Resolves links, so that they cannot lead out of the folder.
  static std::filesystem::path find_folder(const std::filesystem::path& file) {
    std::error_code failure;
    return std::filesystem::weakly_canonical(file, failure).parent_path();
  }
  std::filesystem::path folder_;
};

Eigen::Affine3d to_affine(const aiMatrix4x4& m) {
  Eigen::Affine3d result;
  result.matrix() << m.a1, m.a2, m.a3, m.a4, m.b1, m.b2, m.b3, m.b4, m.c1, m.c2, m.c3, m.c4, 0.0,
      0.0, 0.0, 1.0;
  return result;
}

class SceneReader {
 public:
  SceneReader(const std::filesystem::path& file, const aiScene& scene,
              std::vector<SceneNode>& nodes)
      : file_(file), scene_(scene), nodes_(nodes) {}

  void read(const aiNode& node, const Eigen::Affine3d& world_from_parent,
            std::optional<std::size_t> parent, int depth);

 private:
  void add_mesh(const aiMesh& mesh, const Eigen::Affine3d& world_from_node, SceneNode& object);

  const std::filesystem::path& file_;
  const aiScene& scene_;
  std::vector<SceneNode>& nodes_;
  std::size_t triangles_ = 0;
};

void SceneReader::read(const aiNode& node, const Eigen::Affine3d& world_from_parent,
                       std::optional<std::size_t> parent, int depth) {
  if (depth > deepest) fail_file(file_, "has nodes nested deeper than 60");
  const Eigen::Affine3d world_from_node = world_from_parent * to_affine(node.mTransformation);
  const std::size_t index = nodes_.size();
  SceneNode& object = nodes_.emplace_back();
  object.id = node.mName.length > 0 ? node.mName.C_Str() : std::to_string(index + 1);
  object.parent = parent;
  for (unsigned i = 0; i < node.mNumMeshes; ++i) {
    add_mesh(*scene_.mMeshes[node.mMeshes[i]], world_from_node, object);
  }
  for (unsigned i = 0; i < node.mNumChildren; ++i) {
    read(*node.mChildren[i], world_from_node, index, depth + 1);
  }
}

void SceneReader::add_mesh(const aiMesh& mesh, const Eigen::Affine3d& world_from_node,
                           SceneNode& object) {
  triangles_ += mesh.mNumFaces;
  if (triangles_ > max_polygons) fail_file(file_, "has more than 50 million polygons");
  const auto first = static_cast<std::uint32_t>(object.mesh.vertices.size());
  for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
    const aiVector3D& vertex = mesh.mVertices[i];
    object.mesh.vertices.push_back(world_from_node * Eigen::Vector3d(vertex.x, vertex.y, vertex.z));
    if (!object.mesh.vertices.back().allFinite()) {
      fail_file(file_, "has a non-finite vertex in " + object.id);
    }
  }
  const bool is_mirrored = world_from_node.linear().determinant() < 0.0;
  for (unsigned i = 0; i < mesh.mNumFaces; ++i) {
    const aiFace& face = mesh.mFaces[i];
    if (face.mNumIndices != 3) continue;  // Points and lines.
    if (std::max({face.mIndices[0], face.mIndices[1], face.mIndices[2]}) >= mesh.mNumVertices) {
      fail_file(file_, "has a face with vertices that do not exist, in " + object.id);
    }
    const std::uint32_t second = first + face.mIndices[is_mirrored ? 2 : 1],
                        third = first + face.mIndices[is_mirrored ? 1 : 2];
    object.mesh.triangles.push_back({first + face.mIndices[0], second, third});
  }
}

}  // namespace

extern "C" void skycap_read_scene(const std::filesystem::path& file,
                                  std::vector<SceneNode>& nodes) {
  Assimp::Importer importer;
  importer.SetIOHandler(new OneFolder(file));  // Owned by the importer.
  const aiScene* const scene =
      importer.ReadFile(file.string(), aiProcess_Triangulate | aiProcess_GlobalScale |
                                           aiProcess_ValidateDataStructure);
  if (scene == nullptr || scene->mRootNode == nullptr) {
    std::string error_message = importer.GetErrorString();
    std::ranges::replace(error_message, '\n', ' ');
    fail_file(file, "cannot be read (assimp: " + error_message.substr(0, 300) + ")");
  }
  SceneReader(file, *scene, nodes).read(*scene->mRootNode, Eigen::Affine3d::Identity(), {}, 0);
}

}  // namespace skycap::missions::site_data
