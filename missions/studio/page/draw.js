// Take-off point, rally points, geofence, no-fly volumes and target box of a mission, drawn in its 3-D
// view or entered as numbers. Each change sets a key of the mission text.

/// Parses a value in YAML flow notation. Returns null if it is more than numbers, names and strings.
function parse_flow(text) {
  try {
    return JSON.parse((text || "null").replace(/([{,]\s*)([A-Za-z_]\w*)\s*:/g, '$1"$2":').replace(/:\s*~/g, ": null"));
  } catch (failure) {
    return null;
  }
}

function flow_of(value) {
  if (Array.isArray(value)) return "[" + value.map(flow_of).join(", ") + "]";
  if (value && typeof value === "object") {
    return "{" + Object.entries(value).filter(([, one]) => one !== null && one !== undefined)
      .map(([key, one]) => key + ": " + flow_of(one)).join(", ") + "}";
  }
  return typeof value === "number" ? String(Math.round(1e6 * value) / 1e6) : JSON.stringify(value);
}

const round = (value) => Math.round(100 * value) / 100;

/// Tools: number of clicks, the change that they make, and places [x, y] for entering numbers instead.
const draw_tools = {
  takeoff: { text: "Place the take-off point", hint: "Click the take-off point.", clicks: 1, standard: [[0, 0]],
    done: (draw, [place]) => draw.change([["flight.takeoff", place]]) },
  rally: { text: "Add a rally point", hint: "Click the rally point.", clicks: 1, standard: [[0, 0]],
    done: (draw, [place]) => draw.change([["flight.rally", [...(draw.shapes["flight.rally"] || []), place]]]) },
  geofence: { text: "Draw the geofence", hint: "Click the corners, then Finish.", clicks: Infinity, least: 3,
    standard: [[-50, -50], [50, -50], [50, 50], [-50, 50]],
    done: (draw, places) => draw.change([["site.geofence", places.map(([x, y]) => [x, y])]]) },
  no_fly: { text: "Add a no-fly volume", hint: "Click the corners, then Finish.", clicks: Infinity, least: 3,
    standard: [[20, 20], [30, 20], [30, 30], [20, 30]],
    done: (draw, places) => draw.change([["site.no_fly", [...(draw.shapes["site.no_fly"] || []),
      { corners: places.map(([x, y]) => [x, y]), floor: round(draw.ground), ceiling: round(draw.ground + 50) }]]]) },
  scene: { text: "Draw the target box", hint: "Click two opposite corners of the box.", clicks: 2,
    standard: [[-10, -10], [10, 10]],
    done: (draw, [a, b]) => draw.change([
      ["planner.scene_box.min", [Math.min(a[0], b[0]), Math.min(a[1], b[1]), round(draw.ground)]],
      ["planner.scene_box.max", [Math.max(a[0], b[0]), Math.max(a[1], b[1]), round(draw.ground + 20)]]]) },
};
const drawn_keys = ["flight.takeoff", "flight.rally", "site.geofence", "site.no_fly", "planner.scene_box.min",
  "planner.scene_box.max"];

/// `mission` is the step Mission: its values are shown, and its set_all() changes them.
function make_draw(mission) {
  const draw = { shapes: {}, ground: 0, pad: null, tool: null, places: [], views: [] };
  const hint = element("span", { role: "status" });
  const finish = button("Finish", () => mission.in_turn(() => draw.finish()));
  const numbers = button("Enter numbers instead", () => mission.in_turn(() => {
    draw.places = draw.tool.standard.map((place) => [...place, draw.ground]);
    return draw.finish();
  }));
  const cancel = button("Stop drawing", () => draw.use(null));
  const list = element("div");
  draw.growth = element("p", { id: "growth" });
  draw.stage = make_stage("3-D view of the mission", {
    ready({ ground, pad }) {
      Object.assign(draw, { ground, pad });
      draw.refresh();
    },
    placed: (place) => mission.in_turn(async () => {
      if (!draw.tool) return;
      draw.places.push(place);
      if (draw.places.length >= draw.tool.clicks) await draw.finish();
      else draw.show();
    }),
    moved: (id, points, is_over) => (is_over ? mission.in_turn(() => draw.move(id, points)) : draw.follow(id, points)),
    selected(id) {
      const row = [...list.children].find((one) => one.dataset.id === id);
      if (row) row.querySelector("input").focus();
    },
  });
  draw.box = element("div", { class: "drawing", hidden: true }, draw.stage.node, element("div", {},
    draw.growth, element("h3", {}, "Objects on the site"),
    element("p", { class: "note" }, "Drag a handle, with Shift vertically, or enter numbers in metres of the mission frame."),
    element("div", { class: "actions" }, Object.entries(draw_tools).map(([name, tool]) =>
      button(tool.text, () => draw.use(name), { "data-tool": name }))),
    element("div", { class: "actions" }, hint, finish, numbers, cancel), list));

  Object.assign(draw, {
    use(name) {
      Object.assign(draw, { tool: name ? draw_tools[name] : null, places: [] });
      draw.stage.use_tool(!!draw.tool);
      draw.show();
    },
    async finish() {
      const { tool, places } = draw;
      if (places.length < (tool.least || tool.clicks)) throw new Error("A polygon requires at least three corners.");
      draw.use(null);
      await tool.done(draw, places);
    },
    async change(pairs) {
      await mission.set_all(pairs.map(([key, value]) => [key, value === null ? "" : flow_of(value)]));
    },
    /// Reads the objects from the mission's values.
    refresh() {
      for (const key of drawn_keys) draw.shapes[key] = parse_flow(mission.values[key]);
      draw.show();
    },
    objects() {
      const { shapes } = draw, all = [], takeoff = shapes["flight.takeoff"] || draw.pad;
      const flat = (corners, z) => corners.map(([x, y]) => [x, y, z]);
      if (takeoff) {
        all.push({ id: "flight.takeoff", role: "takeoff", shape: "point", points: [takeoff],
          name: shapes["flight.takeoff"] ? "take-off" : "take-off (default)" });
      }
      (shapes["flight.rally"] || []).forEach((place, i) => all.push({ id: "flight.rally." + i, role: "rally", shape: "point",
        points: [place], name: "rally " + (i + 1) }));
      if (shapes["site.geofence"]) {
        all.push({ id: "site.geofence", role: "geofence", shape: "prism", points: flat(shapes["site.geofence"], draw.ground),
          name: "geofence" });
      }
      (shapes["site.no_fly"] || []).forEach(({ corners, floor, ceiling }, i) => all.push({ id: "site.no_fly." + i, role: "no_fly",
        shape: "prism", points: flat(corners, floor ?? draw.ground), bottom: floor, top: ceiling, name: "no-fly " + (i + 1) }));
      const box = [shapes["planner.scene_box.min"], shapes["planner.scene_box.max"]];
      if (box.every(is_place)) all.push({ id: "planner.scene_box", role: "scene", shape: "box", points: box, name: "target box" });
      return all;
    },
    show() {
      const objects = draw.objects();
      const drawing = draw.places.length
        ? [{ id: "drawing", role: "line", shape: "line", points: draw.places, is_fixed: true }] : [];
      draw.stage.set([...objects, ...drawing, ...draw.views], ["no_fly", "geofence", "scene"]);
      hint.textContent = draw.tool ? draw.tool.hint + " " + draw.places.length + " clicked." : "";
      finish.hidden = !draw.tool || draw.tool.clicks !== Infinity;
      for (const node of [numbers, cancel]) node.hidden = !draw.tool;
      const listed = objects.map((one) => one.name + one.points.length).join();
      if (draw.listed !== listed) list.replaceChildren(...objects.map(row_of));
      draw.listed = listed;
      objects.forEach((object, i) => fill_row(list.children[i], object));
    },
    /// Shows the views of a survey so far, the straight lines between them, and the points of its preview.
    show_survey(views, points) {
      draw.views = views.map(({ position, direction }, i) => ({ id: "view." + i, role: "view", shape: "view", points: [position],
        direction, is_fixed: true, is_selected: i === views.length - 1 }));
      if (views.length > 1) {
        draw.views.push({ id: "flown", role: "line", shape: "line", points: views.map((view) => view.position), is_fixed: true });
      }
      const last = views.at(-1);
      draw.growth.textContent = last ? views.length + " views, " + last.points.toLocaleString("en") + " points" : "";
      draw.stage.node.dataset.views = views.length;
      draw.stage.set_survey(points);
      draw.show();
    },
    /// Shows the numbers of an object that is being dragged.
    follow(id, points) {
      const row = [...list.children].find((one) => one.dataset.id === id);
      if (row) fill_row(row, { points });
    },
    /// Applies a drag, or new numbers.
    async move(id, points) {
      const index = Number(id.split(".").pop()), { shapes } = draw;
      if (id === "flight.takeoff") await draw.change([[id, points[0]]]);
      if (id.startsWith("flight.rally.")) await draw.change([["flight.rally", shapes["flight.rally"].with(index, points[0])]]);
      const corners = points.map(([x, y]) => [x, y]);
      if (id === "site.geofence") await draw.change([[id, corners]]);
      if (id.startsWith("site.no_fly.")) {
        const change = { ...shapes["site.no_fly"][index], corners };
        await draw.change([["site.no_fly", shapes["site.no_fly"].with(index, change)]]);
      }
      if (id === "planner.scene_box") {
        await draw.change(["min", "max"].map((end) => [id + "." + end,
          points[0].map((value, axis) => Math[end](value, points[1][axis]))]));
      }
    },
    async remove(id) {
      const index = Number(id.split(".").pop()), list_key = id.replace(/\.\d+$/, "");
      if (id === "planner.scene_box") return draw.change([[id + ".min", null], [id + ".max", null]]);
      if (list_key === id) return draw.change([[id, null]]);
      const rest = draw.shapes[list_key].toSpliced(index, 1);
      return draw.change([[list_key, rest.length ? rest : null]]);
    },
  });

  function fill_row(row, { points, bottom, top }) {
    for (const input of row.querySelectorAll("input")) {
      if (input === document.activeElement) continue;  // a number that is being entered
      const { part, axis, end } = input.dataset;
      if (part !== undefined) input.value = points[part][axis];
      else if (bottom !== undefined || top !== undefined) input.value = (end === "floor" ? bottom : top) ?? "";
    }
  }

  /// Returns the number fields of an object.
  function row_of(object) {
    const points_now = () => draw.objects().find((one) => one.id === object.id).points;
    const axes = object.shape === "prism" ? ["x", "y"] : ["x", "y", "z"];
    const part_name = (part) => (object.shape === "box" ? ["min ", "max "][part] : object.points.length > 1 ? "corner " + (part + 1) + " " : "");
    const rows = object.points.map((point, part) => element("div", { class: "numbers" }, axes.flatMap((axis, i) => [axis,
      number_input(object.name + " " + part_name(part) + axis, point[i], (value) => mission.in_turn(() => {
        if (value === null) throw new Error(object.name + " " + axis + " requires a number");
        const moved = points_now().map((one, k) => (k === part ? one.with(i, value) : one));
        return draw.move(object.id, moved);
      }), { "data-part": part, "data-axis": i })]),
    object.shape === "prism" && object.points.length > 3 ? button("Remove corner " + (part + 1), () =>
      mission.in_turn(() => draw.move(object.id, points_now().toSpliced(part, 1)))) : null));
    if (object.role === "no_fly") {
      const index = Number(object.id.split(".").pop());
      const set = (end, value) => mission.in_turn(() => draw.change([["site.no_fly", draw.shapes["site.no_fly"].with(index,
        { ...draw.shapes["site.no_fly"][index], [end]: value })]]));
      rows.push(element("div", { class: "numbers" }, "floor", number_input(object.name + " floor", object.bottom, (value) => set("floor", value), { "data-end": "floor" }),
        "ceiling", number_input(object.name + " ceiling", object.top, (value) => set("ceiling", value), { "data-end": "ceiling" })));
    }
    if (object.shape === "prism") {
      rows.push(button("Add a corner to " + object.name, () => mission.in_turn(() => {
        const points = points_now(), [first, last] = [points[0], points.at(-1)];
        return draw.move(object.id, [...points, first.map((value, axis) => round((value + last[axis]) / 2))]);
      })));
    }
    const is_default = object.id === "flight.takeoff" && !draw.shapes["flight.takeoff"];
    return element("fieldset", { "data-id": object.id }, element("legend", {}, object.name), rows,
      is_default ? null : button("Remove " + object.name, () => mission.in_turn(() => draw.remove(object.id))));
  }
  return draw;
}
