// Step 1: the files of the folder.

const kind_texts = { mission: "mission", map: "map, tile or terrain", model: "model or mesh", cloud: "point cloud",
  package: "results", live: "live survey" };

/// Select of an image of the site for 3-D views, and the options of skycap view with it.
function background_select() {
  const node = select([]);
  return { node, refresh: () => fill(node, files_of("map").map((file) => file.path).filter((name) => /\.(tiff?|jp2)$/i.test(name)), "none"),
    options: () => (node.value ? { "--background": node.value } : {}) };
}

/// Opens a file in the step for its kind.
async function open_file(file) {
  if (file.kind === "mission") {
    await studio.steps.mission.open(file.path);
    go_to("mission");
  } else if (file.kind === "package") {
    go_to("results");
    await studio.steps.results.open(file.path);
  } else if (file.kind === "live") {
    go_to("live");
    await studio.steps.live.open(file.path);
  } else if (file.kind === "cloud") {
    go_to("site");
    await studio.steps.site.view_cloud(file.path);
  } else {
    go_to("site");
    await studio.steps.site.open(file.path);
  }
}

/// Sends a file into the folder in pieces. An existing file is replaced only if `replaces` is true or
/// the user agrees. Returns whether it was sent. `on_progress` is called with the sent fraction.
async function send_file(file, replaces = false, on_progress = () => {}) {
  const piece = 1 << 20, start = (replace) => request("uploads", { name: file.name, bytes: file.size, replace });
  const ask = () => confirm_choice("A file named " + file.name + " exists.", "Replace it", "Keep it");
  let upload = await start(replaces);
  if (upload.conflict) {
    if (!await ask()) return false;
    upload = await start(true);
  }
  try {
    for (let at = 0; at < file.size; at += piece) {
      await request("uploads/" + upload.id + "?offset=" + at, file.slice(at, at + piece));
      on_progress(Math.min(1, (at + piece) / file.size));
    }
    const end = await request("uploads/" + upload.id + "/end", {});
    if (end.conflict) return await ask() && await send_file(file, true, on_progress);
  } catch (failure) {
    await request("uploads/" + upload.id + "/cancel", {});
    throw failure;
  }
  return true;
}

/// Asks a question in the page. Returns true for the first answer.
function confirm_choice(question, yes, no) {
  const dialog = element("dialog", { "aria-labelledby": "question" }, element("p", { id: "question" }, question));
  return new Promise((resolve) => {
    const answer = (value) => { dialog.remove(); resolve(value); };
    dialog.append(element("div", { class: "actions" }, button(yes, () => answer(true)), button(no, () => answer(false))));
    dialog.addEventListener("cancel", () => answer(false));
    document.body.append(dialog);
    dialog.showModal();
    dialog.querySelectorAll("button")[1].focus();
  });
}

studio.steps.files = {
  async add(files) {
    const sent = [];
    for (const file of files) {
      this.progress.textContent = "Sending " + file.name;
      const is_sent = await send_file(file, false, (share) => {
        this.progress.textContent = "Sending " + file.name + ": " + Math.round(100 * share) + "%";
      });
      if (is_sent) sent.push(file.name);
    }
    this.progress.textContent = sent.length ? "Added " + sent.join(", ") + "." : "No file added.";
    await refresh_files();
  },
  build(section) {
    this.progress = element("span", { role: "status", id: "sent" });
    this.chooser = element("input", { type: "file", multiple: true, id: "chooser" });
    const add = (files) => this.add([...files]).catch((failure) => {
      this.progress.textContent = "";
      say(failure.message);
    });
    this.chooser.addEventListener("change", () => add(this.chooser.files).then(() => { this.chooser.value = ""; }));
    const area = element("div", { class: "drop", id: "drop" }, ...field("Add files to the folder", this.chooser,
      "Choose files, or drop them here. At most 4 GiB each; existing files are not replaced without a question."));
    // A file that misses the area must not replace the page.
    for (const name of ["dragover", "drop"]) addEventListener(name, (event) => event.preventDefault());
    section.addEventListener("dragover", () => area.classList.add("over"));
    section.addEventListener("dragleave", () => area.classList.remove("over"));
    section.addEventListener("drop", (event) => {
      area.classList.remove("over");
      if (event.dataTransfer.files.length) add(event.dataTransfer.files);
    });
    this.rows = element("tbody");
    this.note = element("p", { class: "note" });
    section.append(element("h2", {}, "Files"), this.note, element("div", { class: "actions" },
      button("Read the folder again", refresh_files)), area, this.progress,
    element("table", {}, element("thead", {}, element("tr", {},
      ["File", "Kind", "Size"].map((text) => element("th", { scope: "col" }, text)))), this.rows));
  },
  refresh() {
    this.note.textContent = studio.listing.length === 0
      ? "The folder contains no mission, map, model or cloud. Add a file."
      : studio.is_complete ? "" : "The folder contains too many files; not all are listed.";
    this.rows.replaceChildren(...studio.listing.map((file) => element("tr", {},
      element("td", {}, button(file.path, () => open_file(file))),
      element("td", {}, kind_texts[file.kind]),
      element("td", {}, ["package", "live"].includes(file.kind) ? "" : bytes_text(file.bytes)))));
  },
};
