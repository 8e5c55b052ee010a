// Helpers: elements, requests and messages.

/// Creates an element. Children are nodes or strings; strings are never parsed as HTML.
function element(name, attributes = {}, ...children) {
  const node = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (value === null || value === undefined || value === false) continue;
    if (typeof value === "function") node.addEventListener(key, value);
    else node.setAttribute(key, value === true ? "" : value);
  }
  node.append(...children.flat().filter((child) => child !== null && child !== undefined));
  return node;
}

const by_id = (id) => document.getElementById(id);

function say(text) {
  const line = by_id("message");
  line.textContent = text || "";
  line.hidden = !text;
}

/// Requests JSON from the studio. The content is JSON, or a piece of a file. Throws an Error with the program's message. A conflict (409) is
/// returned.
async function request(path, content) {
  const is_piece = content instanceof Blob;
  const options = content === undefined ? {} : { method: "POST", body: is_piece ? content : JSON.stringify(content),
    headers: { "Content-Type": is_piece ? "application/octet-stream" : "application/json" } };
  let answer;
  try {
    answer = await fetch("api/" + path, options);
  } catch (failure) {
    throw new Error("The studio does not answer. Restart skycap studio and open its new address.");
  }
  const kind = answer.headers.get("Content-Type") || "";
  const json = kind.startsWith("application/json") ? await answer.json() : { error: await answer.text() };
  if (!answer.ok && answer.status !== 409) throw new Error(json.error || "error " + answer.status);
  return json;
}

/// Runs an action of a button: errors are shown, and the button is disabled meanwhile.
function button(text, action, attributes = {}) {
  const node = element("button", { type: "button", ...attributes }, text);
  node.addEventListener("click", async () => {
    say("");
    node.disabled = true;
    try {
      await action();
    } catch (failure) {
      say(failure.message);
    } finally {
      node.disabled = false;
    }
  });
  return node;
}

let field_count = 0;

/// Returns a label and an input, for a grid of fields.
function field(text, input, note) {
  if (!input.id) input.id = "field" + ++field_count;
  const parts = [element("label", { for: input.id }, text), input];
  if (note) {
    const line = element("p", { class: "note", id: input.id + "-note" }, note);
    input.setAttribute("aria-describedby", line.id);
    parts.push(line);
  }
  return parts;
}

function select(values, attributes = {}) {
  return element("select", attributes, values.map((value) => {
    const [name, text] = Array.isArray(value) ? value : [value, value];
    return element("option", { value: name }, text);
  }));
}

function bytes_text(bytes) {
  if (bytes < 1e3) return bytes + " B";
  if (bytes < 1e6) return (bytes / 1e3).toFixed(1) + " kB";
  return bytes < 1e9 ? (bytes / 1e6).toFixed(1) + " MB" : (bytes / 1e9).toFixed(2) + " GB";
}

/// Address of a file in the work folder.
function file_address(path, query = "") {
  return "/" + studio.state.files + "/" + path.split("/").map(encodeURIComponent).join("/") + query;
}

/// Frame for an HTML file of the folder. Its scripts have no access to this page.
function frame(title) {
  return element("iframe", { title, sandbox: "allow-scripts allow-downloads allow-modals" });
}

/// Shows a file in a frame. The number prevents that an older version is shown.
function show_in(node, path) {
  node.src = file_address(path, "?at=" + Date.now());
  node.hidden = false;
}

/// State of the page. Files are the truth; nothing here is needed after a reload.
const studio = { state: null, listing: [], presets: null, steps: {} };

function files_of(...kinds) {
  return studio.listing.filter((file) => kinds.includes(file.kind));
}

async function refresh_files() {
  const answer = await request("files");
  studio.listing = answer.files;
  studio.is_complete = answer.complete;
  for (const step of Object.values(studio.steps)) if (step.refresh) step.refresh();
}

/// Fills a select with file names and keeps the selection.
function fill(node, names, first) {
  const before = node.value;
  node.replaceChildren(...(first ? [element("option", { value: "" }, first)] : []),
    ...names.map((name) => element("option", { value: name }, name)));
  if (names.includes(before)) node.value = before;
}

function free_name(stem, ending) {
  const taken = new Set(studio.listing.map((file) => file.path));
  let name = stem + ending;
  for (let i = 2; taken.has(name); ++i) name = stem + "_" + i + ending;
  return name;
}

/// Name of a file without its folder and endings.
function stem_of(path) {
  return path.split("/").pop().replace(/\.[^.]*$/, "").replace(/[^A-Za-z0-9_-]/g, "_") || "mission";
}
