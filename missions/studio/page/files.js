// Step 1: the files of the folder.

const kind_texts = { mission: "mission", map: "map, tile or terrain", model: "model or mesh", cloud: "point cloud",
  package: "results" };

/// Opens a file in the step for its kind.
async function open_file(file) {
  if (file.kind === "mission") {
    await studio.steps.mission.open(file.path);
    go_to("mission");
  } else if (file.kind === "package") {
    go_to("results");
    await studio.steps.results.open(file.path);
  } else if (file.kind === "cloud") {
    go_to("site");
    await studio.steps.site.view_cloud(file.path);
  } else {
    go_to("site");
    await studio.steps.site.open(file.path);
  }
}

studio.steps.files = {
  build(section) {
    this.rows = element("tbody");
    this.note = element("p", { class: "note" });
    section.append(element("h2", {}, "Files"), this.note, element("div", { class: "actions" },
      button("Read the folder again", refresh_files)),
    element("table", {}, element("thead", {}, element("tr", {},
      ["File", "Kind", "Size"].map((text) => element("th", { scope: "col" }, text)))), this.rows));
  },
  refresh() {
    this.note.textContent = studio.listing.length === 0
      ? "The folder contains no mission, map, model or cloud. Copy a file into it and read the folder again."
      : studio.is_complete ? "" : "The folder contains too many files; not all are listed.";
    this.rows.replaceChildren(...studio.listing.map((file) => element("tr", {},
      element("td", {}, button(file.path, () => open_file(file))),
      element("td", {}, kind_texts[file.kind]),
      element("td", {}, file.kind === "package" ? "" : bytes_text(file.bytes)))));
  },
};
