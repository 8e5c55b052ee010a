// Layers of the 3-D view.

const layer_names = {
  measured: "points", missing: "missing", unreachable: "unreachable", route: "route", fleet: "fleet", clearance: "clearance", views: "views", next: "next view",
  free: "free-space boundary", volumes: "volumes", priors: "prior data", ground: "ground", background: "background",
};

/// Returns the box of the scene to survey, or null.
function scene_box(data) {
  const volume = ((data.scene && data.scene.volumes) || []).find(({ role }) => role === "scene");
  if (!volume) return null;
  const box = new THREE.Box3();
  for (const [x, y] of volume.corners) {
    for (const z of [volume.bottom, volume.top]) box.expandByPoint(new THREE.Vector3(x, y, z));
  }
  return box;
}

/// Returns the bounding box of all objects of the survey, and the box that is shown first. Scans
/// also contain the ground far from the scene.
function extent_of(data, clouds) {
  const box = new THREE.Box3();
  for (const [name, cloud] of Object.entries(clouds)) {
    if (cloud.count && name !== "free") box.union(new THREE.Box3().setFromArray(cloud.positions));
  }
  const core = box.clone(), scene = data.pieces ? scene_box(data) : null;
  if (scene && scene.intersectsBox(core)) core.intersect(scene);
  for (const view of views_of(data)) box.expandByPoint(vector(view.position));
  if (data.scene && data.scene.pad) box.expandByPoint(vector(data.scene.pad));
  if (box.isEmpty()) {
    for (const volume of (data.scene && data.scene.volumes) || []) {
      volume.corners.forEach(([x, y]) => box.expandByPoint(new THREE.Vector3(x, y, volume.bottom || 0)));
    }
  }
  if (box.isEmpty()) box.set(new THREE.Vector3(-1, -1, 0), new THREE.Vector3(1, 1, 1));
  return { all: box, core: core.isEmpty() ? box.clone() : core };
}

/// The views of a survey, or the pieces or images of a scan.
const views_of = (data) => data.pieces || data.summary.per_view || [];
const sorties_of = (data) => value_at(data, "summary.flight.route.sorties") || [];

const vehicles_of = (data) => value_at(data, "summary.flight.fleet.vehicles") || [];

/// Returns [{points, clearance, sortie, from, to}] of verified legs. Legs are straight lines if a
/// summary has none.
function legs_of(data) {
  const legs = [], views = views_of(data);
  const order = value_at(data, "summary.flight.route.order") || [];
  sorties_of(data).forEach((sortie, number) => {
    if (sortie.legs) {
      for (const leg of sortie.legs) {
        legs.push({ points: leg.points, clearance: leg.clearance_m, sortie: number,
          from: leg.from, to: leg.to });
      }
      return;
    }
    for (let i = sortie.first_station; i < sortie.last_station; ++i) {
      legs.push({ points: [views[order[i]].position, views[order[i + 1]].position],
        clearance: null, sortie: number, from: order[i], to: order[i + 1] });
    }
  });
  return legs;
}

/// Colours distinguish clearances up to this much above the required one [m].
const told_apart = 3;

function clearance_colour(clearance, asked) {
  if (clearance === null || !(asked > 0)) return [120, 200, 230];
  return along(nearness_stops, (clearance - asked) / told_apart);
}

/// Returns indices in an order whose prefixes are evenly distributed: about 500 of them, then those
/// that half the step adds, and so on.
function sparse_first(count) {
  const order = new Uint32Array(count), widest = 2 ** Math.max(6, Math.floor(Math.log2(count / 500)));
  let next = 0;
  for (let i = 0; i < count; i += widest) order[next++] = i;
  for (let step = widest / 2; step >= 1; step /= 2) {
    for (let i = step; i < count; i += 2 * step) order[next++] = i;
  }
  return order;
}

/// Estimates the distance between neighbouring points on a surface, as compute_spacing() does in
/// missions/report/cloud_code.h: from cubes that contain two points on average.
function spacing_of(positions) {
  const count = positions.length / 3, step = Math.max(1, Math.ceil(count / 5000)), taken = new Set();
  let side = new THREE.Box3().setFromArray(positions).getSize(new THREE.Vector3()).length() / 2;
  for (let i = 0; i < 40 && taken.size < count / step / 2; ++i, side /= 1.5) {
    taken.clear();
    for (let k = 0; k < 3 * count; k += 3 * step) {
      const [x, y, z] = [0, 1, 2].map((axis) => Math.floor(positions[k + axis] / side) & 65535);
      taken.add(65536 * (65536 * x + y) + z);
    }
  }
  return 1.5 * side / Math.SQRT2 / Math.sqrt(step);
}

function cloud_points(cloud, least, spacing = cloud.spacing) {
  const geometry = new THREE.BufferGeometry();
  geometry.setIndex(new THREE.BufferAttribute(sparse_first(cloud.count), 1));
  geometry.setAttribute("position", new THREE.BufferAttribute(cloud.positions, 3));
  const colours = new THREE.BufferAttribute(new Uint8Array(3 * cloud.count), 3, true);
  geometry.setAttribute("colour", colours);
  const shots = cloud.view || new Uint16Array(cloud.count);
  geometry.setAttribute("shot", new THREE.BufferAttribute(new Uint16Array(shots), 1));
  const points = new THREE.Points(geometry, point_material(spacing * 1.5, least));
  points.frustumCulled = false;
  Object.assign(points.userData, { cloud, spacing: spacing * 1.5 });
  return points;
}

/// Returns the points of a cloud that are in certain states.
function part_of_cloud(cloud, is_in) {
  const indices = Array.from(cloud.state.keys()).filter((i) => is_in(cloud.state[i]));
  const positions = new Float32Array(3 * indices.length);
  indices.forEach((from, to) => positions.set(cloud.positions.subarray(3 * from, 3 * from + 3), 3 * to));
  return { ...cloud, count: indices.length, positions, state: Uint8Array.from(indices, (i) => cloud.state[i]) };
}

/// Layers of missing and unreachable surface. In a simulation, the latter includes the insides of
/// walls, which would hide the measured outsides.
function missing_layers(data, missing, main) {
  const layers = {}, unreachable = states.findIndex((state) => state.key === "unreachable");
  // Sparse points would be drawn larger than the area that they represent.
  const widest = main && main.count > 1 ? 3 * main.spacing : Infinity;
  const add = (name, is_in) => {
    const part = part_of_cloud(missing, is_in);
    if (part.count) layers[name] = cloud_points(part, 3, Math.min(missing.spacing, widest));
  };
  add("missing", (state) => state !== unreachable);
  add("unreachable", (state) => state === unreachable);
  if (layers.unreachable) layers.unreachable.visible = value_at(data, "summary.surface.known_by") === "planner";
  return layers;
}

function ground_grid(extent, height) {
  const size = extent.all.getSize(new THREE.Vector3());
  const reach = 1.3 * Math.max(size.x, size.y), cell = Math.pow(10, Math.round(Math.log10(reach / 12)));
  const half = Math.ceil(reach / 2 / cell) * cell;
  const middle = extent.all.getCenter(new THREE.Vector3());
  const x0 = Math.round(middle.x / cell) * cell, y0 = Math.round(middle.y / cell) * cell;
  const points = [];
  for (let at = -half; at <= half + cell / 2; at += cell) {
    points.push(new THREE.Vector3(x0 + at, y0 - half, height), new THREE.Vector3(x0 + at, y0 + half, height));
    points.push(new THREE.Vector3(x0 - half, y0 + at, height), new THREE.Vector3(x0 + half, y0 + at, height));
  }
  const material = new THREE.LineBasicMaterial({ color: 0x6f8797, transparent: true, opacity: 0.22 });
  const lines = new THREE.LineSegments(line_geometry(points), material);
  lines.userData = { north: new THREE.Vector3(x0, y0 + half, height), cell };
  return lines;
}

const volume_looks = {
  no_fly: { colour: 0xe03c3c, opacity: 0.16, name: "no-fly volume" },
  geofence: { colour: 0x3aa0e0, opacity: 0.04, name: "geofence" },
  unknown: { colour: 0xd8b24a, opacity: 0, name: "unknown box" },
  scene: { colour: 0xb0c4d0, opacity: 0, name: "scene to survey" },
  target: { colour: 0x58b07a, opacity: 0.3, name: "prior: target" },
  obstacle: { colour: 0xe0703c, opacity: 0.5, name: "prior: obstacle" },
  terrain: { colour: 0x9a8f6a, opacity: 0.5, name: "prior: terrain" },
  truth: { colour: 0xb8c8d8, opacity: 0.3, name: "prior: truth" },
};

/// Returns the surfaces of prior data.
function prior_group(data) {
  const group = new THREE.Group();
  for (const prior of (data.scene && data.scene.priors) || []) {
    const look = volume_looks[prior.role], geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(prior.corners), 3));
    geometry.computeVertexNormals();
    group.add(new THREE.Mesh(geometry, new THREE.MeshLambertMaterial({
      color: look.colour, transparent: true, opacity: look.opacity, side: THREE.DoubleSide,
      depthWrite: false })));
    group.add(new THREE.LineSegments(new THREE.EdgesGeometry(geometry, 20),
      new THREE.LineBasicMaterial({ color: look.colour })));
  }
  return group;
}

function volume_group(data, extent) {
  const group = new THREE.Group(), ground = data.scene ? data.scene.ground : 0;
  const highest = extent.all.max.z + 0.15 * extent.all.getSize(new THREE.Vector3()).length();
  for (const volume of (data.scene && data.scene.volumes) || []) {
    const look = volume_looks[volume.role], shape = prism(volume, ground, highest);
    const parts = [new THREE.LineSegments(shape.edges, new THREE.LineBasicMaterial({
      color: look.colour, transparent: true, opacity: 0.8 }))];
    if (look.opacity > 0) {
      parts.push(new THREE.Mesh(shape.walls, new THREE.MeshBasicMaterial({
        color: look.colour, transparent: true, opacity: look.opacity, side: THREE.DoubleSide,
        depthWrite: false })));
    }
    for (const part of parts) part.userData.role = volume.role;
    group.add(...parts);
  }
  return group;
}

function view_group(data, size) {
  const group = new THREE.Group(), views = views_of(data);
  // a scanner has no frustum.
  if (!views.length || !data.scene || data.piece === "piece") return group;
  const depth = size / 26;
  group.userData.depth = depth;
  const points = views.flatMap((view) => frustum_lines(view, data.scene.sensor, depth));
  const geometry = line_geometry(points), colours = new Float32Array(3 * points.length);
  geometry.setAttribute("color", new THREE.BufferAttribute(colours, 3));
  views.forEach((view, i) => {
    const colour = view.missed ? missed_colour : along(ramp_stops.slice(1), views.length > 1 ? i / (views.length - 1) : 0);
    for (let k = 16 * i; k < 16 * i + 16; ++k) colours.set(colour.map((c) => c / 255), 3 * k);
  });
  group.add(new THREE.LineSegments(geometry, new THREE.LineBasicMaterial({ vertexColors: THREE.VertexColors })));
  return group;
}

function route_group(data, size) {
  const group = new THREE.Group(), asked = value_at(data, "summary.flight.clearance_m.total");
  const lines = legs_of(data).map((leg) => ({
    points: leg.points, colour: clearance_colour(leg.clearance, asked) }));
  lines.push(...trajectory_lines(data));
  if (!lines.length) return group;
  group.add(new THREE.Mesh(tubes(lines, size / 900, 8),
    new THREE.MeshLambertMaterial({ vertexColors: THREE.VertexColors })));
  if (data.scene && data.scene.pad) group.add(pad_ring(data.scene.pad, size, 0xffffff));
  return group;
}

function pad_ring(pad, size, color) {
  const ring = new THREE.Mesh(new THREE.RingBufferGeometry(size / 110, size / 75, 40),
    new THREE.MeshBasicMaterial({ color, side: THREE.DoubleSide }));
  ring.position.set(pad[0], pad[1], pad[2] + size / 2000);
  return ring;
}

/// Returns the paths of several vehicles, each in its colour, and their pads.
function fleet_group(data, size) {
  const group = new THREE.Group();
  const lines = vehicles_of(data).flatMap((vehicle, i) => vehicle.sorties.flatMap((sortie) =>
    sortie.legs.map((leg) => ({ points: leg.points, colour: vehicle_colour(i) }))));
  if (!lines.length) return group;
  group.add(new THREE.Mesh(tubes(lines, size / 900, 8),
    new THREE.MeshLambertMaterial({ vertexColors: THREE.VertexColors })));
  vehicles_of(data).forEach((vehicle, i) => group.add(pad_ring(vehicle.pad, size, css_colour(vehicle_colour(i)))));
  return group;
}

/// Returns the next view of a live survey and the path to it.
function next_group(data, size) {
  const group = new THREE.Group(), next = data.live;
  if (!next || !next.position || !data.scene) return group;
  const points = frustum_lines(next, data.scene.sensor, size / 16);
  group.add(new THREE.LineSegments(line_geometry(points), new THREE.LineBasicMaterial({ color: 0xffd24a })));
  if (next.way.length > 1) {
    group.add(new THREE.Mesh(tubes([{ points: next.way, colour: [255, 210, 74] }], size / 900, 8),
      new THREE.MeshLambertMaterial({ vertexColors: THREE.VertexColors })));
  }
  return group;
}

/// Returns the verified clearance around the route.
function clearance_group(data) {
  const group = new THREE.Group(), asked = value_at(data, "summary.flight.clearance_m.total");
  const lines = legs_of(data).map((leg) => ({ points: leg.points, colour: [120, 200, 240] }));
  if (!lines.length || !(asked > 0)) return group;
  group.add(new THREE.Mesh(tubes(lines, asked, 20), new THREE.MeshLambertMaterial({
    vertexColors: THREE.VertexColors, transparent: true, opacity: 0.13, depthWrite: false,
    side: THREE.DoubleSide })));
  return group;
}

/// Returns the boundary of the measured free space, in which the route is verified.
function free_group(cloud) {
  const group = new THREE.Group();
  if (!cloud || !cloud.count) return group;
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.BufferAttribute(cloud.positions, 3));
  group.add(new THREE.Points(geometry, new THREE.PointsMaterial({ color: 0x6fc4e8, size: cloud.spacing / 3,
    transparent: true, opacity: 0.6, depthWrite: false })));
  return group;
}

/// Returns the image of the site, drawn flat at the height of the ground. `on_load` is called when it can be drawn.
function background_image({ corners, image, name }, height, on_load) {
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.Float32BufferAttribute(corners.flatMap(([x, y]) => [x, y, height]), 3));
  geometry.setAttribute("uv", new THREE.Float32BufferAttribute([0, 1, 1, 1, 1, 0, 0, 0], 2));
  geometry.setIndex([0, 3, 2, 0, 2, 1]);
  const material = new THREE.MeshBasicMaterial({ side: THREE.DoubleSide, polygonOffset: true, polygonOffsetFactor: 2, polygonOffsetUnits: 2 });
  const mesh = new THREE.Mesh(geometry, material);
  mesh.name = name;
  material.map = new THREE.TextureLoader().load(image, () => {
    mesh.userData.is_loaded = true;
    on_load();
  });
  return mesh;
}

function build_layers(data, clouds) {
  const extent = extent_of(data, clouds);
  const size = extent.all.getSize(new THREE.Vector3()).length() || 1;
  const layers = {};
  const main = clouds.measured || clouds.model;
  if (main && main.count) layers.measured = cloud_points(main, 1.6);
  if (clouds.missing && clouds.missing.count) Object.assign(layers, missing_layers(data, clouds.missing, main));
  const add = (name, group) => { if (group.children.length || group.isLine) layers[name] = group; };
  add("route", route_group(data, size));
  add("fleet", fleet_group(data, size));
  add("clearance", clearance_group(data));
  add("views", view_group(data, size));
  add("next", next_group(data, size));
  add("free", free_group(clouds.free));
  add("volumes", volume_group(data, extent));
  add("priors", prior_group(data));
  layers.ground = ground_grid(extent, data.scene ? data.scene.ground : extent.all.min.z);
  if (data.background) {
    layers.background = background_image(data.background, data.scene ? data.scene.ground : extent.all.min.z,
      () => { if (data.on_background) data.on_background(); });
  }
  // The flight of a fleet is shown instead of the same flight by one vehicle.
  for (const name of layers.fleet ? ["route", "clearance", "free"] : ["clearance", "free"]) {
    if (layers[name]) layers[name].visible = false;
  }
  return { layers, extent, size };
}
