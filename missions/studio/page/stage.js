// 3-D view of a page in the work folder, with objects that can be placed and moved
// (missions/report/page/edit.js). The page is a file, so its messages are not trusted.

const is_place = (place) => Array.isArray(place) && place.length === 3 &&
  place.every((value) => Number.isFinite(value) && Math.abs(value) < 1e6);

/// Calls functions of `listeners`: ready({ground, pad}), placed(place), moved(id, points, is_over) and
/// selected(id).
function make_stage(title, listeners) {
  const node = frame(title);
  node.hidden = true;
  const stage = { node, path: "", is_ready: false, objects: [], hidden: [], has_tool: false, survey: null };
  const send = (message) => { if (stage.is_ready) node.contentWindow.postMessage(message, "*"); };
  addEventListener("message", (event) => {
    if (event.source !== node.contentWindow || typeof event.data !== "object" || !event.data) return;
    const { ready, placed, moved, selected } = event.data;
    const act = (action) => Promise.resolve(action).catch((failure) => say(failure.message));
    if (ready) {
      stage.is_ready = true;
      if (stage.is_new) send({ shows_view: true });
      stage.is_new = false;
      if (listeners.ready) {
        listeners.ready({ ground: Number.isFinite(ready.ground) ? ready.ground : 0, pad: is_place(ready.pad) ? ready.pad : null });
      }
      send({ objects: stage.objects, hidden: stage.hidden, tool: stage.has_tool, survey: stage.survey });
      if (stage.has_fit) send({ fits: true });
      node.dataset.ready = "true";
    }
    if (is_place(placed) && listeners.placed) act(listeners.placed(placed));
    if (typeof selected === "string" && listeners.selected) act(listeners.selected(selected));
    if (moved && listeners.moved && Array.isArray(moved.points) && moved.points.every(is_place)) {
      act(listeners.moved(String(moved.id), moved.points, moved.is_over === true));
    }
  });
  return Object.assign(stage, {
    /// Shows a page, with `scrolls` at its 3-D view.
    show(path, scrolls = false) {
      Object.assign(stage, { path, is_ready: false, is_new: scrolls, has_fit: false });
      delete node.dataset.ready;
      show_in(node, path);
    },
    set(objects, hidden = stage.hidden) {
      Object.assign(stage, { objects, hidden });
      node.dataset.objects = objects.length;
      send({ objects, hidden });
    },
    /// Shows the points of a running survey: coordinates in metres.
    set_survey(survey) {
      stage.survey = survey;
      node.dataset.points = survey.length / 3;
      send({ survey });
    },
    /// Shows all objects that can be moved.
    fit() {
      stage.has_fit = true;
      send({ fits: true });
    },
    use_tool(has_tool) {
      stage.has_tool = has_tool;
      send({ tool: has_tool });
    },
  });
}

/// Undo and redo of states that are never modified. `current` returns the state, and `apply` sets it.
function make_history(current, apply) {
  const history = { past: [], future: [] };
  const undo = button("Undo", () => step(history.past, history.future), { class: "undo" });
  const redo = button("Redo", () => step(history.future, history.past), { class: "redo" });
  const update = () => {
    for (const [node, states] of [[undo, history.past], [redo, history.future]]) {
      if (node.disabled !== (states.length === 0)) node.disabled = states.length === 0;
    }
  };
  async function step(from, to) {
    if (from.length === 0) return;
    to.push(current());
    await apply(from.pop());
  }
  // A button is enabled again after its action, so its state follows afterwards.
  for (const node of [undo, redo]) new MutationObserver(update).observe(node, { attributeFilter: ["disabled"] });
  update();
  return Object.assign(history, { undo, redo, update,
    add(state) {
      history.past = [...history.past.slice(-199), state];
      history.future = [];
      update();
    },
    clear() {
      history.past = [];
      history.future = [];
      update();
    },
  });
}

/// Returns an input for a number. `on_change` is called with the number, or null if it is empty.
function number_input(label, value, on_change, attributes = {}) {
  const input = element("input", { type: "number", step: "any", "aria-label": label, ...attributes });
  input.value = value ?? "";
  input.addEventListener("change", async () => {
    try {
      if (!input.checkValidity()) throw new Error(label + " must be a number");
      await on_change(input.value === "" ? null : Number(input.value));
      say("");
    } catch (failure) {
      say(failure.message);
    }
  });
  return input;
}
