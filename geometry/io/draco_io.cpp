#include <array>
#include <memory>
#include <string>

#include <draco/compression/decode.h>
#include <draco/core/decoder_buffer.h>

#include "geometry/error.h"
#include "geometry/io/mesh_io.h"

namespace skycap::geometry {

Mesh decode_draco(std::string_view name, std::string_view bytes) {
  const auto fail = [name](const std::string& what) {
    throw Error(ErrorKind::bad_file, std::string(name) + ": " + what);
  };
  draco::DecoderBuffer buffer;
  buffer.Init(bytes.data(), bytes.size());
  const auto type = draco::Decoder::GetEncodedGeometryType(&buffer);
  if (!type.ok()) fail("is not Draco data: " + type.status().error_msg_string());
  if (type.value() != draco::TRIANGULAR_MESH) fail("contains Draco points; expected a Draco mesh");
  draco::Decoder decoder;
  const auto decoded = decoder.DecodeMeshFromBuffer(&buffer);
  if (!decoded.ok()) {
    fail("is damaged or incomplete Draco data: " + decoded.status().error_msg_string());
  }
  const draco::Mesh& source = *decoded.value();
  const draco::PointAttribute* const positions =
      source.GetNamedAttribute(draco::GeometryAttribute::POSITION);
  if (positions == nullptr || positions->num_components() != 3) {
    fail("has no positions with three coordinates");
  }
  // Draco reads any byte as a valid value of this type.
  if (positions->data_type() == draco::DT_BOOL) fail("has positions of an unsupported type");

  Mesh mesh;
  mesh.vertices.resize(positions->size());
  for (std::uint32_t v = 0; v < mesh.vertices.size(); ++v) {
    const draco::AttributeValueIndex index(v);
    if (!positions->ConvertValue<double>(index, 3, mesh.vertices[v].data())) {
      fail("has positions of an unsupported type");
    }
  }
  mesh.triangles.reserve(source.num_faces());
  for (draco::FaceIndex f(0); f < source.num_faces(); ++f) {
    std::array<std::uint32_t, 3> triangle;
    for (unsigned i = 0; i < 3; ++i) {
      const draco::PointIndex point = source.face(f)[i];
      if (point >= source.num_points()) fail("has a face with a vertex that does not exist");
      triangle[i] = positions->mapped_index(point).value();
      if (triangle[i] >= mesh.vertices.size()) fail("has a face with a vertex that does not exist");
    }
    mesh.triangles.push_back(triangle);
  }
  return mesh;
}

}  // namespace skycap::geometry
