// The 3-D view. It draws its layers after changes and finds the object at a screen position.

/// Maximum duration of a frame during motion, and delay of the complete frame after the last change
/// [ms].
const fluent_frame = 40, rest = 250;

/// Returns whether the browser draws without a graphics card. Antialiasing then takes much of the time.
function is_software() {
  const gl = document.createElement("canvas").getContext("webgl2");
  if (!gl) return true;
  const name = gl.getParameter(gl.RENDERER), info = name === "WebKit WebGL" && gl.getExtension("WEBGL_debug_renderer_info");
  const renderer = info ? gl.getParameter(info.UNMASKED_RENDERER_WEBGL) : name;
  const release = gl.getExtension("WEBGL_lose_context");
  if (release) release.loseContext();
  return /swiftshader|llvmpipe|software|basic render/i.test(renderer);
}

class Viewer {
  constructor(canvas, data, clouds) {
    this.canvas = canvas;
    this.data = data;
    this.clouds = clouds;
    this.main = clouds.measured || clouds.model || null;
    const context = canvas.getContext("webgl2", { antialias: !is_software() });
    if (!context) throw new Error("this browser does not support 3-D graphics (WebGL 2)");
    this.renderer = new THREE.WebGLRenderer({ canvas, context });
    this.renderer.autoClear = false;
    data.on_background = () => this.draw_soon();
    Object.assign(this, build_layers(data, clouds));
    this.cloud_layers = Object.entries(this.layers).filter(([, layer]) => layer.userData.cloud);
    this.camera = new THREE.PerspectiveCamera(45, 1, this.size / 1000, this.size * 12);
    this.camera.up.set(0, 0, 1);
    this.controls = new THREE.OrbitControls(this.camera, canvas);
    Object.assign(this.controls, { enableKeys: false, screenSpacePanning: true, zoomSpeed: 1.2,
      minDistance: this.size / 400, maxDistance: this.size * 6 });
    this.controls.addEventListener("change", () => this.draw_soon());
    this.listeners = [];
    this.points_per_millisecond = 2000;  // initial value until the first measurement
    this.mode = null;
    this.last_view = Infinity;
    this.marks = new THREE.Group();
    this.make_scenes();
    this.make_screen();
    new ResizeObserver(() => this.resize()).observe(canvas.parentElement);
    this.resize();
    this.look("overview", false);
  }

  make_scenes() {
    this.cloud_scene = new THREE.Scene();
    this.shape_scene = new THREE.Scene();
    for (const [name, layer] of Object.entries(this.layers)) {
      (layer.userData.cloud ? this.cloud_scene : this.shape_scene).add(layer);
    }
    this.shape_scene.add(this.marks, new THREE.HemisphereLight(0xffffff, 0x8090a0, 1));
  }

  make_screen() {
    this.target = new THREE.WebGLRenderTarget(4, 4, {
      minFilter: THREE.NearestFilter, magFilter: THREE.NearestFilter });
    // Other types have 16 bits here, and depth shading would show their steps.
    this.target.depthTexture = new THREE.DepthTexture(4, 4, THREE.FloatType);
    this.screen = new THREE.Mesh(new THREE.PlaneBufferGeometry(2, 2), screen_material());
    this.screen.frustumCulled = false;
    this.screen_scene = new THREE.Scene();
    this.screen_scene.add(this.screen);
  }

  resize() {
    const box = this.canvas.parentElement.getBoundingClientRect();
    const width = Math.max(1, Math.round(box.width)), height = Math.max(1, Math.round(box.height));
    this.size_on_screen = [width, height];
    this.full_ratio = Math.min(window.devicePixelRatio || 1, 2);
    this.set_ratio(this.full_ratio);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.draw_soon();
  }

  /// Sets the number of pixels per CSS pixel.
  set_ratio(ratio) {
    if (ratio === this.ratio && this.size_on_screen === this.drawn_size) return;
    const [width, height] = this.size_on_screen;
    Object.assign(this, { ratio, drawn_size: this.size_on_screen });
    this.renderer.setPixelRatio(ratio);
    this.renderer.setSize(width, height, false);
    this.target.setSize(Math.round(width * ratio), Math.round(height * ratio));
  }

  /// Draws as many points as are possible at an interactive rate, and on slow computers with
  /// half the resolution and without large surfaces of prior data. Draws everything after a period without changes.
  draw_soon() {
    clearTimeout(this.completion);
    if (this.is_waiting) return;
    this.is_waiting = true;
    requestAnimationFrame(() => {
      this.is_waiting = false;
      const share = this.fluent_share(), detail = this.is_slow ? 0.5 : 1;
      this.draw(share, detail);
      this.measure_pace();
      if (share < 1 || detail < 1) this.completion = setTimeout(() => requestAnimationFrame(() => this.draw()), rest);
    });
  }

  points_on() {
    return this.cloud_layers.reduce((sum, [, layer]) => sum + (layer.visible ? layer.userData.cloud.count : 0), 0);
  }

  fluent_share() {
    return Math.min(1, this.points_per_millisecond * fluent_frame / Math.max(1, this.points_on()));
  }

  /// Measures the points per millisecond of the last frame. The GPU works asynchronously.
  measure_pace() {
    const gl = this.renderer.getContext(), start = performance.now(), points = this.shown_share * this.points_on();
    const fence = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
    gl.flush();
    const look = () => {
      if (gl.getSyncParameter(fence, gl.SYNC_STATUS) !== gl.SIGNALED && !gl.isContextLost()) {
        setTimeout(look, 4);
        return;
      }
      gl.deleteSync(fence);
      const duration = performance.now() - start, is_full = this.ratio === this.full_ratio;
      this.points_per_millisecond = Math.max(100, points / Math.max(4, duration));
      // A frame of half the resolution takes at least a quarter of the time.
      if (is_full ? duration > fluent_frame : duration < fluent_frame / 8) this.is_slow = is_full;
    };
    setTimeout(look, 4);
  }

  /// Shows an evenly distributed fraction of the points, and enlarges them accordingly.
  show_share(share) {
    this.shown_share = share;
    for (const [, layer] of this.cloud_layers) {
      const { cloud, spacing } = layer.userData;
      layer.geometry.setDrawRange(0, Math.ceil(share * cloud.count));
      layer.material.uniforms.spacing.value = spacing / Math.sqrt(share);
    }
  }

  set_point_scale(camera, height) {
    for (const [name, layer] of this.cloud_layers) {
      const { uniforms } = layer.material;
      uniforms.scale.value = height / (2 * Math.tan(camera.fov * Math.PI / 360));
      uniforms.least.value = (name === "measured" ? 1.6 : 3) * this.ratio;
    }
  }

  draw(share = 1, detail = 1) {
    this.set_ratio(detail * this.full_ratio);
    // Without a graphics card, triangles take most of the time. Their edges remain visible.
    const surfaces = this.layers.priors ? this.layers.priors.children.filter((part) => part.isMesh) : [];
    const is_heavy = (mesh) => mesh.geometry.attributes.position.count > 6000;
    for (const mesh of surfaces) mesh.visible = detail === 1 || !is_heavy(mesh);
    const { renderer, target, camera } = this, { uniforms } = this.screen.material;
    this.show_share(share);
    this.set_point_scale(camera, target.height);
    renderer.setRenderTarget(target);
    renderer.setClearColor(0, 0);
    renderer.clear();
    renderer.render(this.cloud_scene, camera);
    renderer.setRenderTarget(null);
    uniforms.picture.value = target.texture;
    uniforms.depths.value = target.depthTexture;
    uniforms.pixel.value.set(1.2 * this.ratio / target.width, 1.2 * this.ratio / target.height);
    uniforms.near.value = camera.near;
    uniforms.far.value = camera.far;
    uniforms.samples.value = detail === 1 ? 16 : 8;
    renderer.clear();
    renderer.render(this.screen_scene, camera);
    renderer.render(this.shape_scene, camera);
    for (const listener of this.listeners) listener();
  }

  /// Moves the camera to a side of the scene or to an overview.
  look(from, is_smooth = true) {
    const directions = { N: [0, 1, 0.35], E: [1, 0, 0.35], S: [0, -1, 0.35], W: [-1, 0, 0.35],
      top: [0, -0.0001, 1], overview: [-0.62, -0.85, 0.62] };
    const whole = from === "top" ? this.extent.all : this.extent.core;
    const centre = whole.getCenter(new THREE.Vector3());
    const radius = 0.5 * whole.getSize(new THREE.Vector3()).length() || 1;
    const distance = radius / Math.sin(Math.min(this.camera.fov * Math.PI / 360,
      Math.atan(Math.tan(this.camera.fov * Math.PI / 360) * this.camera.aspect)));
    const direction = vector(directions[from]).normalize();
    const share = from === "overview" ? 0.92 : 0.98;
    this.move_to(centre.clone().addScaledVector(direction, share * distance), centre, is_smooth);
  }

  /// Moves the camera close to a position, on the side that it faces.
  look_at_place(place, normal, radius) {
    const centre = vector(place), out = vector(normal || [0, 0, 0]);
    if (out.length() < 0.5) out.copy(this.camera.position).sub(centre);
    out.normalize();
    if (Math.abs(out.z) > 0.99) out.set(0.1, 0.1, out.z).normalize();  // y is up on the screen
    this.move_to(centre.clone().addScaledVector(out, Math.max(4 * radius, this.size / 9)), centre, true);
  }

  move_to(position, target, is_smooth) {
    const start = performance.now(), from = this.camera.position.clone(), to_start = this.controls.target.clone();
    const is_still = !is_smooth || matchMedia("(prefers-reduced-motion: reduce)").matches;
    const ticket = this.movement = {};
    const step = () => {
      if (this.movement !== ticket) return;
      const time = is_still ? 1 : Math.min(1, (performance.now() - start) / 450);
      const share = time * time * (3 - 2 * time);
      this.camera.position.copy(from).lerp(position, share);
      this.controls.target.copy(to_start).lerp(target, share);
      this.controls.update();
      this.draw_soon();
      if (time < 1) requestAnimationFrame(step);
      else this.movement = null;
    };
    step();
  }

  /// Adds a cloud in one colour.
  add_cloud(name, cloud, colour) {
    const layer = cloud_points(cloud, 1.6), colours = layer.geometry.getAttribute("colour");
    for (let i = 0; i < cloud.count; ++i) colours.array.set(colour, 3 * i);
    this.layers[name] = layer;
    this.cloud_layers.push([name, layer]);
    this.cloud_scene.add(layer);
  }

  remove_cloud(name) {
    const layer = this.layers[name];
    this.cloud_scene.remove(layer);
    layer.geometry.dispose();
    layer.material.dispose();
    delete this.layers[name];
    this.cloud_layers = this.cloud_layers.filter(([other]) => other !== name);
  }

  show_layer(name, is_shown) {
    if (this.layers[name]) this.layers[name].visible = is_shown;
    this.draw_soon();
  }

  /// Colours the points by one of colour_modes and updates the legend.
  colour_by(mode) {
    this.mode = mode;
    const legend = { rows: [], ramp: null };
    for (const [name, layer] of this.cloud_layers) {
      const { cloud } = layer.userData;
      const paint = name === "measured" ? painter_of(mode, cloud, legend, this.data) : painter_of("state", cloud, {}, this.data);
      const colours = layer.geometry.getAttribute("colour");
      for (let i = 0; i < cloud.count; ++i) colours.array.set(paint(i), 3 * i);
      colours.needsUpdate = true;
    }
    this.draw_soon();
    return legend;
  }

  /// Shows the survey after this view.
  replay(last_view) {
    this.last_view = last_view;
    const views = views_of(this.data).length, is_all = last_view >= views - 1;
    if (this.layers.measured) this.layers.measured.material.uniforms.last_view.value = is_all ? 65535 : last_view;
    for (const [name, layer] of this.cloud_layers) {
      if (name !== "measured") layer.material.uniforms.last_view.value = is_all ? 65535 : -1;
    }
    if (this.layers.views) this.layers.views.children[0].geometry.setDrawRange(0, is_all ? Infinity : 16 * (last_view + 1));
    this.draw_soon();
  }

  /// Shows highlighted objects: the frustum of a view, a ring around a position, or a measured
  /// distance.
  mark(objects) {
    this.marks.remove(...this.marks.children);
    if (objects.length) this.marks.add(...objects);
    this.draw_soon();
  }

  on_screen(place) {
    const seen = place.clone().project(this.camera);
    return { x: (seen.x + 1) / 2 * this.canvas.clientWidth, y: (1 - seen.y) / 2 * this.canvas.clientHeight,
      is_seen: seen.z < 1 && seen.z > -1 };
  }

  /// Returns the view whose sensor is drawn within some pixels of a screen position, otherwise -1.
  view_at(x, y) {
    if (!this.layers.views || !this.layers.views.visible) return -1;
    let best = -1, least = 16;
    views_of(this.data).forEach((view, i) => {
      if (i > this.last_view) return;
      const seen = this.on_screen(vector(view.position));
      const distance = Math.hypot(seen.x - x, seen.y - y);
      if (!seen.is_seen || distance >= least) return;
      best = i;
      least = distance;
    });
    return best;
  }

  /// Returns the front-most cloud point at a screen position.
  point_at(x, y) {
    let best = null;
    for (const [name, layer] of this.cloud_layers) {
      const { cloud } = layer.userData;
      if (!layer.visible) continue;
      const found = nearest_on_screen(this, cloud, layer.material.uniforms, x, y);
      if (found && (!best || found.score < best.score)) best = { ...found, cloud, name };
    }
    return best;
  }

  /// Draws the points measured from a view, as seen by its sensor, into a 2-D canvas.
  picture_of(number, picture) {
    const view = views_of(this.data)[number], { sensor } = this.data.scene;
    const width = picture.width, height = picture.height;
    const camera = new THREE.PerspectiveCamera(sensor.vertical_fov * 180 / Math.PI,
      width / height, this.size / 2000, this.size * 12);
    camera.up.set(0, 0, 1);
    if (Math.abs(view.direction[2]) > 0.999999) camera.up.set(0, 1, 0);
    camera.position.copy(vector(view.position));
    camera.lookAt(vector(view.position).add(vector(view.direction)));
    camera.updateMatrixWorld();
    const { uniforms } = this.layers.measured.material, target = new THREE.WebGLRenderTarget(width, height);
    const before = [uniforms.first_view.value, uniforms.last_view.value];
    const were_shown = this.cloud_layers.map(([, layer]) => layer.visible);
    for (const [name, layer] of this.cloud_layers) layer.visible = name === "measured";
    uniforms.first_view.value = uniforms.last_view.value = number;
    this.show_share(1);
    this.set_point_scale(camera, height);
    this.renderer.setRenderTarget(target);
    this.renderer.setClearColor(0x06090c, 1);
    this.renderer.clear();
    this.renderer.render(this.cloud_scene, camera);
    const pixels = new Uint8Array(4 * width * height);
    this.renderer.readRenderTargetPixels(target, 0, 0, width, height, pixels);
    this.renderer.setRenderTarget(null);
    target.dispose();
    [uniforms.first_view.value, uniforms.last_view.value] = before;
    this.cloud_layers.forEach(([, layer], i) => { layer.visible = were_shown[i]; });
    const image = new ImageData(width, height);
    for (let row = 0; row < height; ++row) {
      image.data.set(pixels.subarray(4 * width * (height - 1 - row), 4 * width * (height - row)), 4 * width * row);
    }
    picture.getContext("2d").putImageData(image, 0, 0);
    this.draw_soon();
  }
}

/// Returns the point closest to the camera within 9 pixels. The distance in pixels is weighted in.
function nearest_on_screen(viewer, cloud, uniforms, x, y) {
  const matrix = new THREE.Matrix4().multiplyMatrices(viewer.camera.projectionMatrix,
    viewer.camera.matrixWorldInverse).elements;
  const width = viewer.canvas.clientWidth, height = viewer.canvas.clientHeight, reach = 9;
  const p = cloud.positions;
  let best = null;
  for (let i = 0; i < cloud.count; ++i) {
    const shot = cloud.view ? cloud.view[i] : 0;
    if (shot > uniforms.last_view.value) continue;
    const a = p[3 * i], b = p[3 * i + 1], c = p[3 * i + 2];
    const w = matrix[3] * a + matrix[7] * b + matrix[11] * c + matrix[15];
    if (w <= 0) continue;
    const px = ((matrix[0] * a + matrix[4] * b + matrix[8] * c + matrix[12]) / w + 1) / 2 * width - x;
    if (px > reach || px < -reach) continue;
    const py = (1 - (matrix[1] * a + matrix[5] * b + matrix[9] * c + matrix[13]) / w) / 2 * height - y;
    const off = Math.hypot(px, py);
    if (off > reach) continue;
    const score = w * (1 + 0.02 * off);
    if (!best || score < best.score) best = { index: i, score };
  }
  return best;
}

/// Returns a function from a point's index to its colour.
function painter_of(mode, cloud, legend, data) {
  const p = cloud.positions;
  const ramp = (title, values, low, high, form, stops = ramp_stops) => {
    legend.ramp = { title, low: shown(low, form), high: shown(high, form), stops };
    const table = Array.from({ length: 256 }, (_, i) => along(stops, i / 255));
    return (i) => table[Math.max(0, Math.min(255, Math.round(255 * (values(i) - low) / (high - low || 1))))];
  };
  if (mode === "height") {
    const heights = Float32Array.from({ length: cloud.count }, (_, i) => p[3 * i + 2]);
    return ramp("height", (i) => heights[i], quantile(heights, 0.001), quantile(heights, 0.999), "metres");
  }
  if (mode === "time" && data.pieces.length) {
    const times = data.pieces.map((piece) => piece.time_s), last = times.length - 1;
    return ramp("flight time", (i) => times[Math.min(cloud.view[i], last)] - times[0], 0, times[last] - times[0], "clock");
  }
  if (mode === "view" && cloud.view) {
    legend.note = "one colour per view";
    return (i) => view_colour(cloud.view[i]);
  }
  if (mode === "incidence" && cloud.incidence) {
    const unknown = [110, 120, 128];
    const paint = ramp("angle of incidence", (i) => incidence_of(cloud, i, data.scales), 0, 90, "degrees",
      [...ramp_stops].reverse());
    return (i) => (cloud.incidence[i] === data.scales.no_incidence ? unknown : paint(i));
  }
  if (mode === "quality" && cloud.quality) {
    legend.rows = photo_classes;
    return (i) => photo_classes[cloud.quality[i]].colour;
  }
  if (data.maps && data.maps[mode] && cloud[mode]) {
    const map = data.maps[mode], unknown = [110, 120, 128];
    const paint = ramp(map.title, (i) => map_value(map, cloud[mode][i]), map.low, map.high, map.form,
      mode === "gsd" ? [...ramp_stops].reverse() : ramp_stops);
    return (i) => (cloud[mode][i] === 0 ? unknown : paint(i));
  }
  if (mode === "density") {
    // The preview of a scan contains a fraction of its points.
    const all = data.kind === "scan" ? Math.max(data.summary.points || 0, cloud.of) : cloud.of;
    if (!cloud.density) cloud.density = densities(cloud, density_reach * cloud.spacing, all);
    return ramp("points per m²", (i) => cloud.density[i], 0, quantile(cloud.density, 0.99), "count");
  }
  if (mode === "file") {
    legend.note = "colours of the file";
    return (i) => data.palette[cloud.colour[i]];
  }
  if (cloud.state) {
    legend.rows = states;
    return (i) => states[cloud.state[i]].colour;
  }
  const plain = [190, 200, 208];
  return () => plain;
}
