// Editing in a frame of skycap studio. The studio sends objects by message; this page draws them with
// handles, and returns clicked places and moved handles. A page that is not in a frame has no editor.
//
//     from the studio  {objects: [{id, name, role, shape, points, bottom, top, direction, is_fixed}],
//                       hidden: [layers and roles of volumes], tool: true or false,
//                       survey: Float32Array with the points measured so far,
//                       shows_view: true to scroll to the 3-D view,
//                       fits: true to show all objects that can be moved}
//     to the studio    {ready: {ground, pad}}, {placed: [x, y, z]}, {moved: {id, points, is_over}},
//                      {selected: id}
//
// Shapes: point, view, line, prism (corners) and box (two opposite corners). Units: metres.

const edit_colours = { takeoff: 0xffd24a, rally: 0x7fd6a0, view: 0x8fd0ff, selected: 0xffffff, line: 0xffd24a,
  no_fly: 0xe03c3c, geofence: 0x3aa0e0, scene: 0xc8a0f0, vehicle: 0xff7ad9, next: 0xffd24a };
const survey_colour = [120, 226, 150];
const handle_reach = 14;  // [px]

class Editor {
  constructor(panel) {
    this.panel = panel;
    this.viewer = panel.viewer;
    this.objects = [];
    this.handles = [];
    this.tags = [];
    this.group = new THREE.Group();
    this.viewer.shape_scene.add(this.group);
    addEventListener("message", (event) => {
      if (event.source === parent && event.data && typeof event.data === "object") this.hear(event.data);
    });
    panel.stage.addEventListener("pointerdown", (event) => this.press(event), true);
    addEventListener("pointermove", (event) => this.move(event));
    addEventListener("pointerup", () => this.release());
    addEventListener("pointercancel", () => this.release());
    this.tell({ ready: { ground: panel.data.scene ? panel.data.scene.ground : 0,
      pad: panel.data.scene ? panel.data.scene.pad : null } });
  }

  tell(message) { parent.postMessage(message, "*"); }

  hear({ objects, hidden, tool, survey, shows_view: shows, fits }) {
    if (shows) this.panel.stage.scrollIntoView({ block: "start" });
    if (Array.isArray(hidden)) this.hide(hidden);
    if (survey instanceof Float32Array) this.show_survey(survey);
    if (Array.isArray(objects)) {
      // During a drag, the object under the pointer is newer than the studio's.
      const dragged = this.drag && this.drag.object;
      this.objects = objects.map((one) => (dragged && one.id === dragged.id ? dragged : one));
      this.show();
    }
    if (fits) this.fit();
    if (tool !== undefined) {
      this.has_tool = !!tool;
      this.panel.stage.classList.toggle("measuring", this.has_tool);
    }
  }

  /// Shows the points of a running survey instead of the points of the model.
  show_survey(positions) {
    const { viewer } = this, count = positions.length / 3;
    if (this.survey) viewer.remove_cloud("survey");
    this.survey = count > 0;
    if (viewer.layers.measured) viewer.layers.measured.visible = !this.survey;
    if (this.survey) viewer.add_cloud("survey", { count, of: count, positions, spacing: spacing_of(positions) }, survey_colour);
    viewer.draw_soon();
  }

  /// Moves the camera so that all objects with handles are seen.
  fit() {
    this.handles.forEach(({ place }) => this.viewer.extent.core.expandByPoint(place));
    this.viewer.look("overview", false);
  }

  hide(names) {
    const { layers } = this.viewer;
    for (const name of names) if (layers[name]) layers[name].visible = false;
    for (const part of (layers.volumes ? layers.volumes.children : [])) {
      if (names.includes(part.userData.role)) part.visible = false;
    }
  }

  /// Draws all objects.
  show() {
    this.group.traverse((part) => { if (part.geometry) part.geometry.dispose(); });
    this.group.remove(...this.group.children);
    this.handles = [];
    const names = [], views = this.objects.filter((one) => one.shape === "view");
    for (const object of this.objects) {
      if (object.shape !== "view") this.group.add(...this.drawn(object));
      if (object.name) names.push([object.points[0], object.name]);
      if (!object.is_fixed) this.add_handles(object);
    }
    if (views.length) this.group.add(this.drawn_views(views));
    if (this.handles.length) this.group.add(this.drawn_handles());
    this.tags.forEach((tag) => this.panel.remove_tag(tag));
    this.tags = names.map(([place, text]) => this.panel.add_tag(vector(place), text, true, true));
    this.viewer.draw_soon();
  }

  add_handles(object) {
    object.points.forEach((place, part) => this.handles.push({ object, part, place: vector(place) }));
    if (object.points.length < 2 || object.shape === "line") return;
    const centre = new THREE.Vector3();
    object.points.forEach((place) => centre.addScaledVector(vector(place), 1 / object.points.length));
    this.handles.push({ object, part: -1, place: centre });  // moves the whole object
  }

  colour(object) { return edit_colours[object.is_selected ? "selected" : object.role] || 0xffffff; }

  drawn_handles() {
    const geometry = line_geometry(this.handles.map((handle) => handle.place));
    const colours = this.handles.flatMap(({ object }) => new THREE.Color(this.colour(object)).toArray());
    geometry.setAttribute("color", new THREE.Float32BufferAttribute(colours, 3));
    const points = new THREE.Points(geometry, new THREE.PointsMaterial({ size: 11 * this.viewer.ratio,
      sizeAttenuation: false, vertexColors: THREE.VertexColors, depthTest: false, transparent: true }));
    points.onBeforeRender = () => { points.material.size = 11 * this.viewer.ratio; };
    points.renderOrder = 2;
    points.frustumCulled = false;
    return points;
  }

  drawn_views(views) {
    const depth = this.viewer.size / 26, { sensor } = this.panel.data.scene, points = [], colours = [];
    for (const view of views) {
      const lines = frustum_lines({ position: view.points[0], direction: view.direction }, sensor, depth);
      const colour = new THREE.Color(this.colour(view)).toArray();
      points.push(...lines);
      lines.forEach(() => colours.push(...colour));
    }
    const geometry = line_geometry(points);
    geometry.setAttribute("color", new THREE.Float32BufferAttribute(colours, 3));
    return new THREE.LineSegments(geometry, new THREE.LineBasicMaterial({ vertexColors: THREE.VertexColors }));
  }

  drawn(object) {
    const color = this.colour(object), { size } = this.viewer;
    if (object.shape === "point") return [pad_ring(object.points[0], size, color)];
    if (object.shape === "line" || object.points.length < 3) {
      if (object.shape !== "box" || object.points.length < 2) {
        return [new THREE.Line(line_geometry(object.points.map(vector)), new THREE.LineBasicMaterial({ color }))];
      }
    }
    const shape = prism(this.prism_of(object), this.panel.data.scene ? this.panel.data.scene.ground : 0,
      this.viewer.extent.all.max.z + 0.15 * size);
    const opacity = object.role === "no_fly" ? 0.18 : 0.05;
    return [new THREE.LineSegments(shape.edges, new THREE.LineBasicMaterial({ color })),
      new THREE.Mesh(shape.walls, new THREE.MeshBasicMaterial({ color, transparent: true, opacity,
        side: THREE.DoubleSide, depthWrite: false }))];
  }

  prism_of({ shape, points, bottom, top }) {
    if (shape !== "box") return { corners: points, bottom: bottom ?? null, top: top ?? null };
    const [[x0, y0, z0], [x1, y1, z1]] = points;
    return { corners: [[x0, y0], [x1, y0], [x1, y1], [x0, y1]], bottom: Math.min(z0, z1), top: Math.max(z0, z1) };
  }

  place_in_canvas(event) {
    const box = this.panel.canvas.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  }

  ray_at(x, y) {
    const ray = new THREE.Raycaster(), { canvas } = this.panel;
    ray.setFromCamera({ x: 2 * x / canvas.clientWidth - 1, y: 1 - 2 * y / canvas.clientHeight }, this.viewer.camera);
    return ray;
  }

  handle_at(x, y) {
    let best = null, least = handle_reach;
    for (const handle of this.handles) {
      const seen = this.viewer.on_screen(handle.place), distance = Math.hypot(seen.x - x, seen.y - y);
      if (!seen.is_seen || distance > least) continue;
      best = handle;
      least = distance;
    }
    return best;
  }

  press(event) {
    if (event.target !== this.panel.canvas || event.button !== 0 || this.has_tool) return;
    const handle = this.handle_at(...this.place_in_canvas(event));
    if (!handle) return;
    this.viewer.controls.enabled = false;  // until the release
    this.drag = { ...handle, is_vertical: event.shiftKey, is_moved: false, start: [event.clientX, event.clientY] };
    this.panel.canvas.setPointerCapture(event.pointerId);
  }

  /// Moves the handle in its horizontal plane, or with the Shift key vertically.
  move(event) {
    if (!this.drag) return;
    const { place, object, part, start } = this.drag;
    if (!this.drag.is_moved && Math.hypot(event.clientX - start[0], event.clientY - start[1]) < 4) return;
    const across = this.viewer.camera.getWorldDirection(new THREE.Vector3()).setZ(0).normalize();
    const normal = this.drag.is_vertical ? across : new THREE.Vector3(0, 0, 1);
    const plane = new THREE.Plane().setFromNormalAndCoplanarPoint(normal, place);
    const hit = this.ray_at(...this.place_in_canvas(event)).ray.intersectPlane(plane, new THREE.Vector3());
    if (!hit || hit.distanceTo(place) > 4 * this.viewer.size) return;
    const change = this.drag.is_vertical ? [0, 0, hit.z - place.z] : [hit.x - place.x, hit.y - place.y, 0];
    const points = object.points.map((point, i) => (part === -1 || part === i
      ? point.map((value, axis) => Math.round(100 * (value + change[axis])) / 100) : point));
    this.drag.place = hit.clone();
    if (!this.drag.is_vertical) this.drag.place.z = place.z;
    this.drag.is_moved = true;
    this.drag.object = { ...object, points };
    this.objects = this.objects.map((one) => (one.id === object.id ? this.drag.object : one));
    this.show();
    this.tell({ moved: { id: object.id, points, is_over: false } });
  }

  release() {
    if (!this.drag) return;
    const { object, is_moved } = this.drag;
    this.drag = null;
    this.viewer.controls.enabled = true;
    this.tell(is_moved ? { moved: { id: object.id, points: object.points, is_over: true } } : { selected: object.id });
  }

  /// Handles a click. Returns false if it does not concern the editor.
  click(x, y) {
    if (this.has_tool) {
      const place = this.surface_at(x, y);
      if (place) this.tell({ placed: place.toArray().map((value) => Math.round(100 * value) / 100) });
    }
    return this.has_tool || !!this.handle_at(x, y);
  }

  /// Returns the front-most place of points, prior data or ground.
  surface_at(x, y) {
    const { viewer } = this, ray = this.ray_at(x, y), places = [];
    const point = viewer.point_at(x, y);
    if (point) places.push(vector(place_of(point)));
    if (viewer.layers.priors && viewer.layers.priors.visible) {
      const hit = ray.intersectObjects(viewer.layers.priors.children.filter((one) => one.isMesh))[0];
      if (hit) places.push(hit.point);
    }
    const ground = this.panel.data.scene ? this.panel.data.scene.ground : 0;
    const low = ray.ray.intersectPlane(new THREE.Plane(new THREE.Vector3(0, 0, 1), -ground), new THREE.Vector3());
    if (low && low.distanceTo(viewer.extent.all.getCenter(new THREE.Vector3())) < 20 * viewer.size) places.push(low);
    const distance = (place) => place.distanceTo(viewer.camera.position);
    return places.sort((a, b) => distance(a) - distance(b))[0];
  }
}
