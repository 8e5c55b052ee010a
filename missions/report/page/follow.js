// Live page of a running survey. It reloads periodically and keeps the user's view.

const reading_period = 5;  // [s]
const memory_name = "skycap-page";

/// Returns the state of the page before it was reloaded, or null.
function remembered() {
  try {
    const text = storage() ? storage().getItem(memory_name) : window.name;
    if (storage()) storage().removeItem(memory_name);
    return text ? JSON.parse(text) : null;
  } catch (failure) {
    return null;
  }
}

/// The storage of the page, or null in frames of the studio and for local files in some browsers.
function storage() {
  try {
    return sessionStorage;
  } catch (failure) {
    return null;
  }
}

function remember(skycap) {
  const { panel } = skycap, state = { top: scrollY };
  if (panel) {
    const { camera, controls, layers } = panel.viewer;
    Object.assign(state, { position: camera.position.toArray(), target: controls.target.toArray(),
      colour: panel.viewer.mode,
      layers: Object.fromEntries(Object.entries(layers).map(([name, layer]) => [name, layer.visible])) });
  }
  if (storage()) storage().setItem(memory_name, JSON.stringify(state));
  else window.name = JSON.stringify(state);  // kept by the frame
}

function restore(skycap, state) {
  if (!state) return;
  const { panel } = skycap;
  if (panel && state.position) {
    panel.viewer.move_to(vector(state.position), vector(state.target), false);
    panel.set_colour(state.colour);
    // New layers have their default visibility.
    const is_shown = { ...state.layers };
    for (const [name, layer] of Object.entries(panel.viewer.layers)) is_shown[name] = is_shown[name] ?? layer.visible;
    panel.set_layers(Object.keys(is_shown).filter((name) => is_shown[name]));
  }
  scrollTo(0, state.top);
}

/// Reloads the page periodically, except while it is in use.
function follow(skycap, started) {
  const { data } = skycap;
  if (!data.live) return;
  restore(skycap, remembered());
  const period = Math.max(1000 * reading_period, 4 * (performance.now() - started));
  let touched = -Infinity, is_followed = true;
  for (const event of ["pointerdown", "wheel", "keydown", "touchmove"]) {
    addEventListener(event, () => { touched = performance.now(); }, { capture: true, passive: true });
  }
  const is_at_rest = () => !document.hidden && performance.now() - touched > period &&
    !(skycap.panel && skycap.panel.is_in_use());
  const button = element("button", { type: "button", id: "follow", class: "follow", onclick: () => {
    is_followed = !is_followed;
    say();
  } });
  const say = () => {
    button.textContent = is_followed ? "live: updated every " +
      Math.round(period / 1000) + " s – pause" : "paused – resume";
  };
  say();
  document.getElementById("head").append(button);
  setInterval(() => {
    if (!is_followed || !is_at_rest()) return;
    remember(skycap);
    location.reload();
  }, period);
}
