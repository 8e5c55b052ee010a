// Controls around the 3-D view, and information about a view, a point or a distance.

const colour_modes = [["quality", "reconstruction"], ["gsd", "ground sampling distance"],
  ["observations", "photos of a point"], ["parallax", "parallax"], ["state", "coverage"], ["file", "file colours"], ["view", "view"], ["height", "height"],
  ["time", "time"], ["incidence", "incidence"], ["density", "density"]];

class Panel {
  constructor(stage, data, clouds) {
    this.stage = stage;
    this.data = data;
    this.canvas = element("canvas", { tabindex: "0", "aria-label": "3-D view of the survey" });
    stage.append(this.canvas);
    this.viewer = new Viewer(this.canvas, data, clouds);
    this.legend = element("div", { class: "legend" });
    this.card = null;
    this.tags = [];
    stage.append(this.legend);
    this.add_north();
    this.measured = null;  // positions picked so far during a measurement
    this.viewer.listeners.push(() => this.place_tags());
    this.listen();
    this.bars = [this.view_bar(), this.replay_bar()].filter(Boolean);
    this.colour(this.modes()[0][0]);
  }

  modes() {
    const cloud = this.viewer.main || {}, is_scan = this.data.kind === "scan";
    const has = { quality: cloud.quality, gsd: cloud.gsd, observations: cloud.observations, parallax: cloud.parallax,
      state: cloud.state, file: cloud.colour, view: cloud.view && !is_scan, height: true,
      time: cloud.view && is_scan, incidence: cloud.incidence, density: this.data.kind !== "photos" };
    return colour_modes.filter(([name]) => has[name]);
  }

  view_bar() {
    const select = element("select", { id: "colour", "aria-label": "colour of the points",
      onchange: () => this.colour(select.value) },
      this.modes().map(([name, text]) => element("option", { value: name }, text)));
    const sides = ["N", "E", "S", "W", "top", "overview"].map((side) => element("button", {
      type: "button", "data-look": side, title: side.length === 1 ? "seen from " + side : side,
      onclick: () => this.viewer.look(side) }, side === "overview" ? "all" : side));
    const layers = Object.keys(layer_names).filter((name) => this.viewer.layers[name]).map((name) => {
      const box = element("input", { type: "checkbox", "data-layer": name,
        onchange: () => this.viewer.show_layer(name, box.checked) });
      box.checked = this.viewer.layers[name].visible;
      return element("label", {}, box, layer_names[name]);
    });
    this.ruler = element("button", { type: "button", id: "measure",
      onclick: () => this.measure(!this.measured) }, "measure");
    return element("div", { class: "bar" }, element("label", {}, "colour", select),
      element("span", { class: "group" }, sides), this.ruler, layers);
  }

  replay_bar() {
    const count = views_of(this.data).length;
    if (count < 2) return null;
    this.slider = element("input", { type: "range", id: "replay", min: "0", max: String(count - 1),
      step: "1", "aria-label": "views of the survey", oninput: () => this.show_view(+this.slider.value) });
    this.slider.value = count - 1;
    this.play_button = element("button", { type: "button", id: "play", onclick: () => this.play() }, "replay");
    this.now = element("span", { class: "now" });
    this.say_view(count - 1);
    return element("div", { class: "bar" }, this.play_button, this.slider, this.now);
  }

  set_colour(mode) {
    const select = this.bars[0].querySelector("#colour");
    if (!this.modes().some(([name]) => name === mode)) return;
    select.value = mode;
    this.colour(mode);
  }

  set_layers(names) {
    for (const box of this.bars[0].querySelectorAll("[data-layer]")) {
      box.checked = names.includes(box.dataset.layer);
      this.viewer.show_layer(box.dataset.layer, box.checked);
    }
  }

  say_view(number) {
    const views = views_of(this.data);
    if (this.data.pieces) {
      const time = views[number].time_s, start = this.data.kind === "flown" ? 0 : views[0].time_s;
      this.now.textContent = this.data.piece + " " + number + " (0 to " + (views.length - 1) + ") · " +
        (time === null ? "missed" : shown(time - start, "clock"));
      return;
    }
    const ceiling = this.data.summary.attainable_coverage;
    const attainable = typeof ceiling === "number" ? " of " + shown(ceiling, "share") + " attainable" : "";
    const covered = typeof views[number].coverage === "number" ? " · covered " +
      shown(views[number].coverage, "share") + attainable : "";  // unknown for real sites
    this.now.textContent = "view " + number + " (0 to " + (views.length - 1) + ")" + covered;
  }

  show_view(number) {
    const views = views_of(this.data);
    this.viewer.replay(number);
    this.say_view(number);
    const path = views.slice(0, number + 1).map((view) => vector(view.position));
    const is_end = number === views.length - 1;
    const marks = is_end ? [] : [this.data.piece === "piece" ? this.ball(views[number].position) : this.pyramid(number)];
    if (!is_end && path.length > 1) {
      marks.push(new THREE.Line(line_geometry(path), new THREE.LineBasicMaterial({
        color: 0xffffff, transparent: true, opacity: 0.55 })));
    }
    this.viewer.mark(marks);
  }

  play() {
    const count = views_of(this.data).length;
    if (this.timer) return this.pause();
    if (+this.slider.value === count - 1) this.slider.value = 0;
    this.play_button.textContent = "pause";
    this.show_view(+this.slider.value);
    this.timer = setInterval(() => {
      this.slider.value = +this.slider.value + 1;
      this.show_view(+this.slider.value);
      if (+this.slider.value === count - 1) this.pause();
    }, Math.max(60, Math.min(500, 12000 / count)));
  }

  pause() {
    clearInterval(this.timer);
    this.timer = null;
    this.play_button.textContent = "replay";
  }

  colour(mode) {
    const meaning = this.viewer.colour_by(mode), rows = [];
    for (const state of meaning.rows) {
      rows.push(element("div", { class: "row" }, swatch(state.colour, "dot"), state.name));
    }
    if (meaning.note) rows.push(element("div", { class: "row" }, meaning.note));
    if (meaning.ramp) rows.push(...ramp_legend(meaning.ramp.title, meaning.ramp));
    const asked = value_at(this.data, "summary.flight.clearance_m.total");
    if (this.viewer.layers.route && asked > 0 && legs_of(this.data).some((leg) => leg.clearance !== null)) {
      rows.push(...ramp_legend("route: verified clearance", { stops: nearness_stops,
        low: shown(asked, "metres"), high: "from " + shown(asked + told_apart, "metres") }));
    }
    vehicles_of(this.data).forEach((vehicle, i) => {
      rows.push(element("div", { class: "row" }, swatch(vehicle_colour(i), "dot"), "fleet: vehicle " + (i + 1)));
    });
    for (const way of trajectory_lines(this.data).filter(({ name }) => name)) {
      rows.push(element("div", { class: "row" }, swatch(way.colour, "dot"), way.name));
    }
    const scene = this.data.scene || {};
    const is_drawn = (prior) => prior.corners.length > 0, priors = scene.priors || [];
    const roles = new Set([...(scene.volumes || []), ...priors.filter(is_drawn)].map((one) => one.role));
    for (const role of roles) {
      const look = volume_looks[role], colour = new THREE.Color(look.colour);
      rows.push(element("div", { class: "row" },
        swatch([255 * colour.r, 255 * colour.g, 255 * colour.b], "dot"), look.name));
    }
    for (const prior of priors.filter((one) => !is_drawn(one))) {
      rows.push(element("div", { class: "row" }, prior.name + " has too many triangles to display"));
    }
    rows.push(element("div", { class: "row hint" }, this.viewer.layers.views
      ? "click a view or a point for details" : "click a point for its position"));
    this.legend.replaceChildren(...rows);
  }

  listen() {
    let down = null;
    this.canvas.addEventListener("pointerdown", (event) => {
      down = { x: event.clientX, y: event.clientY, id: event.pointerId };
    });
    this.canvas.addEventListener("pointerup", (event) => {
      if (!down || down.id !== event.pointerId) return;
      if (Math.hypot(event.clientX - down.x, event.clientY - down.y) > 5) return;
      const box = this.canvas.getBoundingClientRect();
      this.click(event.clientX - box.left, event.clientY - box.top);
    });
  }

  click(x, y) {
    if (this.editor && this.editor.click(x, y)) return;
    const point = this.viewer.point_at(x, y);
    if (this.measured) {
      if (point) this.measure_to(place_of(point));
      return;
    }
    const view = this.viewer.view_at(x, y);
    if (view >= 0) this.tell_view(view);
    else if (point) this.tell_point(point);
    else this.close_card();
  }

  pyramid(number) {
    const view = views_of(this.data)[number], distance = value_at(this.data, "summary.photo.view_distance_m");
    const depth = distance || 2.2 * (this.viewer.layers.views.userData.depth || 1);  // of a photo: its footprint
    return new THREE.LineSegments(line_geometry(frustum_lines(view, this.data.scene.sensor, depth)),
      new THREE.LineBasicMaterial({ color: 0xffffff }));
  }

  /// Returns the properties of a view and its results.
  view_rows(number) {
    const view = views_of(this.data)[number], path = "per_view." + number + ".";
    const [x, y, z] = view.direction;
    const heading = (Math.atan2(x, y) * 180 / Math.PI + 360) % 360;
    const rows = [
      ["position", places_text(view.position)], ["heading", shown(heading, "degrees")],
      ["pitch", shown(Math.asin(Math.max(-1, Math.min(1, z))) * 180 / Math.PI, "degrees")]];
    if (this.data.kind === "flown") {
      return [["item", view.item], ["state", view.missed ? "missed" : "captured"], ...rows,
        ["time after take-off", shown(view.time_s, "clock")], ["distance from the plan", shown(view.error_m, "metres")]];
    }
    if (this.data.pieces) {
      return [...rows, ["time", shown(view.time_s, "clock")], ["points shown", shown(view.points, "count")]];
    }
    if (this.data.kind === "photos") {
      return [...rows, ["observed samples", figure(this.data, path + "observed_samples", "count")],
        ["ground sampling distance", figure(this.data, path + "gsd_m", "millimetres")]];
    }
    rows.push(["returns", figure(this.data, path + "returns", "count")],
      ["new points", figure(this.data, path + "points_new", "count")],
      ["planning time", figure(this.data, path + "planning_time_s", "seconds")],
      ["path length", figure(this.data, path + "distance_m", "metres")]);
    if (typeof view.coverage === "number") rows.push(["coverage after this view", figure(this.data, path + "coverage", "share")]);
    // In that case the legs lead to other views.
    const leg = value_at(this.data, "summary.flight.replanned.is_flown") ? null
      : legs_of(this.data).find((one) => one.to === number);
    if (leg && leg.clearance !== null) rows.push(["leg clearance", shown(leg.clearance, "metres")]);
    return rows;
  }

  tell_view(number) {
    this.viewer.mark([this.pyramid(number)]);
    const parts = [list_of(this.view_rows(number))];
    if (this.viewer.layers.measured && this.viewer.main.view) {
      const { sensor } = this.data.scene, width = 480;
      const aspect = Math.tan(Math.min(sensor.horizontal_fov, 2.6) / 2) / Math.tan(Math.min(sensor.vertical_fov, 2.6) / 2);
      const picture = element("canvas", { width: String(width), height: String(Math.round(width / aspect)) });
      this.viewer.picture_of(number, picture);
      parts.push(picture, element("p", { class: "caption" }, "points added by this view, from the sensor position"));
    }
    const name = this.data.kind === "flown" ? "Capture " : this.data.pieces ? "Image " : "View ";
    this.open_card(name + number, parts);
  }

  tell_point(point) {
    const { cloud, index } = point, rows = [["position", places_text(place_of(point))]];
    if (cloud.state) rows.push(["state", states[cloud.state[index]].name]);
    if (cloud.quality) rows.push(["reconstruction", photo_classes[cloud.quality[index]].name]);
    for (const [name, map] of Object.entries(this.data.maps || {})) {
      if (cloud[name]) rows.push([map.title, shown(map_value(map, cloud[name][index]), map.form)]);
    }
    if (cloud.view) rows.push([this.data.piece || "measured from view", String(cloud.view[index])]);
    const { scales } = this.data, incidence = incidence_of(cloud, index, scales), half = scales.incidence_step_deg / 2;
    if (incidence !== null) rows.push(["incidence", incidence - half + "° to " + (incidence + half) + "°"]);
    if (cloud.view && views_of(this.data)[cloud.view[index]]) {
      const eye = vector(views_of(this.data)[cloud.view[index]].position);
      rows.push(["range", shown(eye.distanceTo(vector(place_of(point))), "metres")]);
    }
    this.viewer.mark([this.ball(place_of(point))]);
    this.open_card(point.name === "measured" ? "Point" : "Missing surface", [list_of(rows)]);
  }

  tell_hole(number) {
    const hole = this.data.summary.surface.holes[number];
    const ring = new THREE.Mesh(new THREE.SphereBufferGeometry(Math.max(hole.radius_m, this.viewer.size / 200), 24, 16),
      new THREE.MeshBasicMaterial({ color: 0xffffff, wireframe: true, transparent: true, opacity: 0.18 }));
    ring.position.copy(vector(hole.centre));
    this.viewer.mark([ring]);
    const shown = Object.keys(this.viewer.layers).filter((name) => this.viewer.layers[name].visible);
    this.set_layers([...shown, hole.reason === "unreachable" ? "unreachable" : "missing"]);
    this.viewer.look_at_place(hole.centre, hole.normal, Math.max(hole.radius_m, this.viewer.size / 60));
    this.stage.scrollIntoView({ block: "nearest" });
  }

  ball(place) {
    const ball = new THREE.Mesh(new THREE.SphereBufferGeometry(this.viewer.size / 420, 12, 8),
      new THREE.MeshBasicMaterial({ color: 0xffffff }));
    ball.position.copy(vector(place));
    return ball;
  }

  /// Returns true if a reload would discard a selection, a measurement or a replay.
  is_in_use() {
    return this.card || this.timer || this.measured || (this.slider && this.slider.value !== this.slider.max);
  }

  measure(is_on) {
    this.measured = is_on ? [] : null;
    this.ruler.classList.toggle("on", is_on);
    this.stage.classList.toggle("measuring", is_on);
    if (this.distance_tag) this.remove_tag(this.distance_tag);
    this.distance_tag = null;
    this.viewer.mark([]);
    this.close_card();
  }

  measure_to(place) {
    if (this.measured.length === 2) this.measure(true);
    this.measured.push(place);
    const marks = this.measured.map((one) => this.ball(one));
    if (this.measured.length === 2) {
      const [from, to] = this.measured.map(vector);
      const line = new THREE.Line(line_geometry([from, to]),
        new THREE.LineBasicMaterial({ color: 0xffffff, depthTest: false }));
      marks.push(line);
      const level = Math.hypot(to.x - from.x, to.y - from.y);
      this.distance_tag = this.add_tag(from.clone().lerp(to, 0.5), shown(from.distanceTo(to), "metres"), true);
      this.open_card("Distance", [list_of([["straight", shown(from.distanceTo(to), "metres")],
        ["level", shown(level, "metres")], ["height", shown(to.z - from.z, "metres")]])]);
    }
    this.viewer.mark(marks);
  }

  /// Adds a text at a place. `is_ruler`: shown without the ground; `is_above`: beside the place.
  add_tag(place, text, is_ruler, is_above) {
    const label = element("div", { class: is_ruler ? "tag" : "tag north" }, text);
    this.stage.append(label);
    const tag = { place, label, is_ruler, is_above };
    this.tags.push(tag);
    this.place_tags();
    return tag;
  }

  remove_tag(tag) {
    tag.label.remove();
    this.tags = this.tags.filter((one) => one !== tag);
  }

  add_north() {
    const { north } = this.viewer.layers.ground.userData;
    this.add_tag(north, "N", false);
  }

  place_tags() {
    for (const { place, label, is_ruler, is_above } of this.tags) {
      const seen = this.viewer.on_screen(place);
      const is_shown = seen.is_seen && (is_ruler || this.viewer.layers.ground.visible);
      label.style.display = is_shown ? "" : "none";
      label.style.transform = `translate(${seen.x}px, ${seen.y}px) translate(-50%, ${is_above ? -140 : -50}%)`;
    }
  }

  open_card(title, parts) {
    this.close_card(true);
    this.card = element("div", { class: "card" }, element("h3", {}, title),
      element("button", { type: "button", class: "close", "aria-label": "close",
        onclick: () => this.close_card() }, "×"), parts);
    this.stage.append(this.card);
  }

  close_card(keeps_marks) {
    if (this.card) this.card.remove();
    this.card = null;
    if (!keeps_marks) this.viewer.mark([]);
  }
}

const place_of = (point) => Array.from(point.cloud.positions.subarray(3 * point.index, 3 * point.index + 3));
const places_text = (place) => place.map((number) => number.toFixed(2)).join(", ");

function list_of(rows) {
  return element("dl", {}, rows.flatMap(([name, value]) => [element("dt", {}, name), element("dd", {}, value)]));
}

function swatch(colour, look = "swatch") {
  const made = element("span", { class: look });
  made.style.background = css_colour(colour);
  return made;
}

function ramp_legend(title, ramp) {
  const bar = element("span", { class: "ramp" });
  bar.style.background = css_ramp(ramp.stops);
  return [element("div", { class: "title" }, title), bar,
    element("div", { class: "ends" }, element("span", {}, ramp.low), element("span", {}, ramp.high))];
}
