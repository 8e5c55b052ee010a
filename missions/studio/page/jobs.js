// Commands that run on the server. They continue when the page is closed.

const jobs = new Map();

/// Returns the remaining time of a command from its last progress line, such as "view 3 of at most 20" or "40%".
function remaining_text({ lines = [], seconds }) {
  const line = [...lines].reverse().find((one) => /^\[\d+ s\] .*?(\d+ of (at most )?\d+|\d+%)/.test(one)) || "";
  const [, done, most, all] = /(\d+) of (at most )?(\d+)/.exec(line) || [];
  const [, percent] = /(\d+)%/.exec(line) || [];
  const share = all ? done / all : percent / 100;
  if (!(share > 0 && share < 1)) return "";
  return (most ? ", at most about " : ", about ") + Math.ceil(seconds * (1 - share) / share) + " s left";
}

function state_text(job) {
  if (job.running) return "running, " + Math.round(job.seconds) + " s" + remaining_text(job);
  const texts = { 0: "finished", 1: "finished with a negative result (exit code 1)", 2: "not possible (exit code 2)" };
  return (texts[job.exit_code] || "ended with exit code " + job.exit_code) + ", " + job.seconds.toFixed(1) + " s";
}

/// Adds the parts of a job to the page.
function show_job(job) {
  const view = { ...job, lines: [], parts: {}, listeners: [] };
  view.parts.state = element("span", { class: "state" });
  view.parts.cancel = button("Cancel", () => request("jobs/" + job.id + "/cancel", {}));
  view.parts.log = element("pre", { tabindex: "0", role: "log", "aria-label": "Output of command " + job.id });
  view.parts.box = element("div", { class: "job", "data-job": job.id },
    element("code", { class: "command" }, job.title),
    element("div", { class: "actions" }, view.parts.state, view.parts.cancel), view.parts.log);
  by_id("jobs").prepend(view.parts.box);
  jobs.set(job.id, view);
  update_job(view, job);
  return view;
}

function update_job(view, job) {
  const from = job.from || 0;
  (job.lines || []).forEach((line, i) => {
    if (from + i < view.lines.length) return;  // repeated after a reconnection
    view.lines[from + i] = line;
    view.parts.log.append(line + "\n");
    view.parts.log.scrollTop = view.parts.log.scrollHeight;
  });
  Object.assign(view, { running: job.running, exit_code: job.exit_code, seconds: job.seconds });
  view.parts.state.textContent = state_text(view);
  view.parts.state.className = "state " + (view.running ? "" : view.exit_code === 0 ? "good" : "bad");
  view.parts.cancel.hidden = !view.running;
  view.parts.box.dataset.running = view.running;
  view.listeners.forEach((listener) => listener(view));
}

/// Calls `on_change` with each state of a job. Ends with the job.
function follow_states(id, on_change) {
  return new Promise((resolve) => {
    const events = new EventSource("api/jobs/" + id + "/events");
    events.onmessage = (event) => {
      const state = JSON.parse(event.data);
      on_change(state);
      if (state.running) return;
      events.close();
      resolve(state);
    };
  });
}

/// Follows a job until its end.
async function follow_job(view, on_change) {
  await follow_states(view.id, (state) => {
    update_job(view, state);
    if (on_change) on_change(view);
  });
  return view;
}

/// Starts a command and returns its job when it has ended. `on_change` is called with the job at
/// the start and with each change.
async function run_command(command, options, on_change, draft) {
  const view = show_job(await request("jobs", { command, options, draft }));
  if (on_change) on_change(view);
  return follow_job(view, on_change);
}

/// Runs a command that is not shown in the step Run, such as a check while typing.
async function run_quietly(command, options, draft) {
  const job = await request("jobs", { command, options, draft });
  const lines = [];
  const end = await follow_states(job.id, (state) => {
    (state.lines || []).forEach((line, i) => { lines[state.from + i] = line; });
  });
  return { ...end, lines };
}

/// Output of a command with its state and a button to cancel it, for the page of a step.
function make_output(label) {
  const command = element("code", { class: "command" });
  const state = element("span", { role: "status" });
  const log = element("pre", { tabindex: "0", "aria-label": label });
  const box = element("div", { hidden: true }, command, element("div", { class: "actions" }, state), log);
  const show = (view) => {
    box.hidden = false;
    command.textContent = view.title;
    state.textContent = state_text(view);
    state.className = view.running ? "" : view.exit_code === 0 ? "good" : "bad";
    log.textContent = view.lines.join("\n");
    log.scrollTop = log.scrollHeight;
    box.dataset.running = view.running;
    box.dataset.exit = view.exit_code;
  };
  return { box, show };
}

studio.steps.run = {
  title: "Run",
  build(section) {
    section.append(element("h2", {}, "Run"),
      element("p", { class: "note" }, "Commands continue when this page is closed, and end with skycap studio. " +
        "Cancel saves the results so far where the command can resume."),
      element("div", { id: "jobs" }));
  },
  /// Finds the commands that were started before the page was opened.
  async open_jobs() {
    for (const job of studio.state.jobs) {
      const view = show_job(job);
      follow_job(view).then(refresh_files);
    }
  },
};
