// Geometry of routes, frusta and volumes.

const vector = (list) => new THREE.Vector3(list[0], list[1], list[2]);

/// Returns round tubes along polylines [{points, colour}], in one geometry.
function tubes(lines, radius, sides) {
  const positions = [], normals = [], colours = [], indices = [];
  for (const { points, colour } of lines) {
    for (let i = 1; i < points.length; ++i) {
      add_tube(vector(points[i - 1]), vector(points[i]), radius, sides, colour);
    }
  }
  function add_tube(from, to, size, around, colour) {
    const axis = to.clone().sub(from);
    if (axis.length() === 0) return;
    axis.normalize();
    const across = Math.abs(axis.z) < 0.9 ? new THREE.Vector3(0, 0, 1) : new THREE.Vector3(1, 0, 0);
    const u = axis.clone().cross(across).normalize(), v = axis.clone().cross(u);
    const first = positions.length / 3;
    for (let k = 0; k < around; ++k) {
      const angle = 2 * Math.PI * k / around;
      const out = u.clone().multiplyScalar(Math.cos(angle)).addScaledVector(v, Math.sin(angle));
      for (const end of [from, to]) {
        const place = end.clone().addScaledVector(out, size);
        positions.push(place.x, place.y, place.z);
        normals.push(out.x, out.y, out.z);
        colours.push(colour[0] / 255, colour[1] / 255, colour[2] / 255);
      }
      const a = first + 2 * k, b = first + 2 * ((k + 1) % around);
      indices.push(a, b, a + 1, b, b + 1, a + 1);
    }
  }
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.Float32BufferAttribute(positions, 3));
  geometry.setAttribute("normal", new THREE.Float32BufferAttribute(normals, 3));
  geometry.setAttribute("color", new THREE.Float32BufferAttribute(colours, 3));
  geometry.setIndex(indices);
  return geometry;
}

/// Returns the corners of a camera's frustum at the distance `depth`. The top of the image is up.
function frustum_corners(view, sensor, depth) {
  const eye = vector(view.position), forward = vector(view.direction).normalize();
  const steep = Math.abs(forward.z) > 0.999999;
  const right = forward.clone()
    .cross(steep ? new THREE.Vector3(0, 1, 0) : new THREE.Vector3(0, 0, 1)).normalize();
  const up = right.clone().cross(forward);
  const width = Math.tan(Math.min(sensor.horizontal_fov, 2.6) / 2) * depth;
  const height = Math.tan(Math.min(sensor.vertical_fov, 2.6) / 2) * depth;
  return [[-1, -1], [1, -1], [1, 1], [-1, 1]].map(([x, y]) => eye.clone()
    .addScaledVector(forward, depth).addScaledVector(right, x * width).addScaledVector(up, y * height));
}

function frustum_lines(view, sensor, depth) {
  const eye = vector(view.position), corners = frustum_corners(view, sensor, depth);
  const points = [];
  corners.forEach((corner, i) => points.push(eye, corner, corner, corners[(i + 1) % 4]));
  return points;
}

function line_geometry(points) {
  return new THREE.BufferGeometry().setFromPoints(points);
}

/// Returns the vertical walls on a footprint and their edges. Open ends are limited to the visible
/// range.
function prism(volume, lowest, highest) {
  const bottom = volume.bottom === null ? lowest : Math.max(volume.bottom, lowest);
  const top = volume.top === null ? highest : Math.min(volume.top, highest);
  const corners = volume.corners, edges = [], walls = [];
  corners.forEach((corner, i) => {
    const next = corners[(i + 1) % corners.length];
    const low = new THREE.Vector3(corner[0], corner[1], bottom);
    const high = new THREE.Vector3(corner[0], corner[1], top);
    const next_low = new THREE.Vector3(next[0], next[1], bottom);
    const next_high = new THREE.Vector3(next[0], next[1], top);
    edges.push(low, high, low, next_low, high, next_high);
    walls.push(low, next_low, next_high, low, next_high, high);
  });
  const outline = corners.map((corner) => new THREE.Vector2(corner[0], corner[1]));
  for (const triangle of THREE.ShapeUtils.triangulateShape(outline, [])) {
    for (const height of [bottom, top]) {
      for (const i of triangle) walls.push(new THREE.Vector3(corners[i][0], corners[i][1], height));
    }
  }
  return { edges: line_geometry(edges), walls: line_geometry(walls) };
}
