// Assembles the page.

function go_to(step) {
  for (const node of document.querySelectorAll("main > section")) node.hidden = node.id !== step;
  for (const node of document.querySelectorAll("nav button")) {
    if (node.dataset.step === step) node.setAttribute("aria-current", "step");
    else node.removeAttribute("aria-current");
  }
  location.hash = step;
}

async function main() {
  for (const [name, step] of Object.entries(studio.steps)) step.build(by_id(name));
  for (const node of document.querySelectorAll("nav button")) node.addEventListener("click", () => go_to(node.dataset.step));
  studio.state = await request("state");
  by_id("folder").textContent = "Skycap " + studio.state.version + ", commands run in " + studio.state.folder;
  await studio.steps.run.open_jobs();
  await refresh_files();
  const step = location.hash.slice(1);
  go_to(studio.steps[step] ? step : "files");
  const opened = studio.listing.find((file) => file.path === studio.state.opened);
  if (opened && !studio.steps[step]) await open_file(opened);
}

main().then(() => { document.body.dataset.ready = "true"; }, (failure) => say(failure.message));
