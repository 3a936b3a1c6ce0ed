// @ts-check
// The workbench: its parts, what they share, and the server's word on everything.

import { cloudPart } from "./cloud.js";
import { dataPart } from "./data.js";
import { drivePart } from "./drive.js";
import { by, h } from "./elements.js";
import { figuresPart } from "./figures.js";
import { marksFor } from "./marks.js";
import { modelPart } from "./model.js";
import { Silent, get, latest, post, query } from "./server.js";
import { storyPart } from "./story.js";

const WORDS = /** @type {Record<string, string>} */ ({ fit: "Fitting", diagnose: "Testing every effect of the catalogue", learn: "Learning: fit, diagnose, add, until nothing is missing", report: "Making the report" });
const catalogue = await get("api/catalogue");

/** @type {any} */ let bench = null;
let key = "";
/** @type {any} */ let job = { running: false, number: 0 };
/** The number of the last job whose end was seen: a short one may end before it is seen to run. @type {number | null} */ let done = null;
let placed = "";
let silent = false;

/** @param {string} words */
function say(words) { by("notice").textContent = words; by("notice").hidden = !words; }
/** @param {Error} error */
function fail(error) {
  if (error instanceof Silent) { lost(true); return; }
  say("");
  by("alert").textContent = error.message;
  by("alert").hidden = false;
}
function clear() { if (!silent) by("alert").hidden = true; }

/** @param {boolean} now */
function lost(now) {
  if (silent === now) return;
  silent = now;
  by("alert").hidden = !now;
  by("alert").textContent = now ? `The server does not answer. Your work up to the last change is saved${bench ? ` in ${bench.file}` : ""}. Start umbmark open again, and open the address that it prints.` : "";
}

/** @param {any} act */
async function act(act) {
  clear();
  try {
    await take(await post("api/act", act));
  } catch (error) {
    fail(/** @type {Error} */ (error));
    await refresh();
  }
}

/** @param {string} kind @param {any} [what] */
async function begin(kind, what) {
  clear();
  try {
    await post(`api/job?${query({ kind })}`, what);
    await refresh();
  } catch (error) {
    fail(/** @type {Error} */ (error));
  }
}

const marks = marksFor((mark, isChosen) => figures.mark(mark, drive.mark(mark, isChosen) || (mark?.run ?? ""), isChosen));
const drive = drivePart({ hide: (runs) => act({ act: "hide", runs }), ...marks });
const story = storyPart({ act });
const drag = latest((values) => post("api/predict", values), (told, values) => { drive.model(told.runs); if (Object.keys(values).length) model.error(told.errors?.rmse_m); }, fail);
const model = modelPart({ act, job: begin, drag, fail, catalogue });
const figures = figuresPart({ ...marks, catalogue });
const cloud = cloudPart({ fail, catalogue });
const data = dataPart({ say, fail, refresh, work: () => choose("work"), catalogue });

// The tour.
const TOUR = /** @type {[string, (bench: any) => boolean][]} */ ([
  ["Open examples/hidden: drop the folder on the page Data, or start umbmark open examples/hidden.", (b) => Boolean(b)],
  ["Look at the drive. Drag the time: the robot computed the grey path and was measured on the coloured one. The nominal robot is off by about 50 mm.", (b) => Boolean(b)],
  ["Add wheels and wheelbase, then Fit, then Accept. The cross-validated error falls, but not to zero.", (b) => b?.state.steps.some((/** @type {any} */ s) => s.effects.includes("wheelbase"))],
  ["Before you ask: look at the figures. On which figure does the error repeat? Which effect would do that?", (b) => b?.state.steps.some((/** @type {any} */ s) => s.effects.includes("wheelbase"))],
  ["Ask: What is missing? Compare the first suggestions: their p, and what each would leave.", (b) => Boolean(b?.found) || b?.state.steps.some((/** @type {any} */ s) => s.effects.length > 3)],
  ["Add the suggestion that you trust, Fit it, and Accept it if the error falls. Does it fall below 10 mm?", (b) => b?.state.steps.some((/** @type {any} */ s) => (s.errors.heldout_rmse_m ?? 1) < 0.01)],
  ["Try a wrong one: add another effect, Fit, see that the cross-validated error does not fall, and Undo.", () => false],
  ["Let Learn do the same, and compare its story with yours.", (b) => b?.state.steps.some((/** @type {any} */ s) => s.learnt)],
  ["Take the model away, with the commands that repeat it.", () => false],
]);
const tourList = h("ol", {});
const tour = h("details", { class: "card tour", id: "tour" }, h("summary", {}, "A tour of ten minutes: find the hidden effect"), h("p", { class: "hint" }, "A robot drove five squares each way. Something other than its wheels bends its paths. Find out what."), tourList);

// Take away.
const report = h("div", { class: "buttons" });
const commands = h("pre", { id: "commands", tabindex: "0" });
const target = h("select", { id: "target" }, catalogue.targets.map((/** @type {any} */ t) => h("option", { value: t.name, title: t.about }, `${t.name}: ${t.about}`)));
const away = h("div", { class: "two" },
  h("section", { class: "card" }, h("h2", {}, "The model"),
    h("div", { class: "buttons" }, h("button", { type: "button", class: "main", id: "take-model", onclick: () => save("api/model.toml", "model.toml") }, "model.toml")),
    h("h3", {}, h("label", { for: "target" }, "For another program")), h("div", { class: "buttons" }, target, h("button", { type: "button", id: "take-export", onclick: () => save(`api/export?${query({ to: target.value })}`, `${target.value}.txt`) }, "Export")),
    h("h3", {}, "The report"), h("div", { class: "buttons" }, h("button", { type: "button", id: "make-report", onclick: () => begin("report") }, "Make the report")), report),
  h("section", { class: "card" }, h("h2", {}, "The commands that repeat it"), commands,
    h("div", { class: "buttons" }, h("button", { type: "button", onclick: () => navigator.clipboard.writeText(commands.textContent ?? "").then(() => say("Copied."), () => say("The browser does not let the page copy; select the text.")) }, "Copy")),
    h("p", { class: "hint", id: "saved" })));

/** @param {string} path @param {string} name */
async function save(path, name) {
  clear();
  try {
    const response = await fetch(path, { credentials: "omit" });
    if (!response.ok) throw new Error((await response.json()).error);
    const place = URL.createObjectURL(await response.blob());
    h("a", { href: place, download: name }).click();
    setTimeout(() => URL.revokeObjectURL(place), 10000);
  } catch (error) {
    fail(/** @type {Error} */ (error));
  }
}

// The parts, each behind a tab.
const work = h("div", {}, tour, h("div", { class: "work" }, story.root, drive.root, model.root));
const empty = h("section", { class: "card" }, h("p", {}, "No data are open. Begin with the part Data."), h("button", { type: "button", class: "main", onclick: () => choose("data") }, "Open data"));
const PARTS = /** @type {[string, string, any][]} */ ([["data", "Data", data.root], ["work", "Compare and try", h("div", {}, empty, work)], ["figures", "Figures", figures.root], ["away", "Take away", away], ["cloud", "Monte Carlo", cloud.root]]);
const tabs = PARTS.map(([name, words]) => h("button", { type: "button", role: "tab", id: `tab-${name}`, "aria-controls": `part-${name}`, onclick: () => choose(name) }, words));
const panels = PARTS.map(([name, , inside]) => h("div", { role: "tabpanel", id: `part-${name}`, "aria-labelledby": `tab-${name}`, hidden: true }, inside));
by("tabs").append(...tabs);
by("main").append(...panels);
by("tabs").addEventListener("keydown", (/** @type {KeyboardEvent} */ event) => {
  const now = tabs.findIndex((tab) => tab.getAttribute("aria-selected") === "true");
  const to = /** @type {Record<string, number>} */ ({ ArrowRight: now + 1, ArrowLeft: now - 1, Home: 0, End: tabs.length - 1 })[event.key];
  if (to === undefined) return;
  event.preventDefault();
  const [name] = PARTS[(to + tabs.length) % tabs.length];
  choose(name);
  by(`tab-${name}`).focus();
});

/** @param {string} name */
function choose(name) {
  PARTS.forEach(([own], index) => {
    tabs[index].setAttribute("aria-selected", String(own === name));
    tabs[index].tabIndex = own === name ? 0 : -1;
    panels[index].hidden = own !== name;
  });
  figures.seen(name === "figures" && Boolean(bench));
  if (name === "cloud") cloud.seen();
  if (name === "work") drive.draw();
}

/** What goes on: a job, or the runs that are made ready for fits, of which no share is known. */
function working() {
  by("job").hidden = !job.running && !bench?.preparing;
  by("job-words").textContent = job.running ? (WORDS[job.kind] ?? job.kind) : "Making the runs ready for fits";
  by("cancel").hidden = !job.running;
  if (job.running) by("share").value = job.share;
  else by("share").removeAttribute("value");
}

/** @param {any} told */
async function take(told) {
  lost(false);
  job = told.job;
  done ??= job.running ? job.number - 1 : job.number;
  const ended = !job.running && job.number > /** @type {number} */ (done);
  if (ended) done = job.number;
  if (ended && job.error) fail(new Error(job.error));
  if (ended && job.kind === "report" && !job.error) report.replaceChildren(h("button", { type: "button", class: "main", id: "take-report", onclick: () => save("api/report.html", "report.html") }, "Save report.html"));
  if (ended && job.kind === "learn" && job.stopped && !job.error) say("Learn was cancelled; what it had found until then stands in the story.");
  const fresh = told.bench !== undefined && told.key !== key;
  if (told.bench !== undefined) bench = told.bench;
  if (told.key === "empty") bench = null;
  key = told.key;
  working();
  empty.hidden = Boolean(bench);
  work.hidden = !bench;
  by("place").textContent = bench ? bench.place : "";
  document.title = bench ? `${bench.place.split("/").pop()} – umbmark workbench` : "umbmark workbench";
  story.reached(job.running ? job.steps : []);
  if (!bench) { if (!placed) { placed = "none"; data.inspect(false); } return; }
  if (fresh || ended || told.bench !== undefined) await show();
}

let shown = "";
async function show() {
  if (placed !== bench.place) {
    placed = bench.place;
    shown = "";
    marks.choose(null);
    report.replaceChildren();
    data.inspect(true);
    try { drive.data(await get("api/paths")); } catch (error) { fail(/** @type {Error} */ (error)); }
  }
  const { state } = bench;
  story.show(state);
  model.show(bench, job.running || bench.preparing);
  drive.hide(state.hidden);
  marks.tell();
  const text = state.draft?.model ?? state.steps[state.at].model;
  if (text !== shown) {
    shown = text;
    drag({});
    report.replaceChildren();
    get("api/commands").then((told) => { commands.textContent = told.commands.join("\n"); }, fail);
  }
  figures.show(text, state.hidden);
  by("saved").textContent = bench.unsaved ? `The work could not be saved: ${bench.unsaved}` : `The work is saved in ${bench.file} after each change.`;
  if (bench.unsaved) fail(new Error(`The work could not be saved: ${bench.unsaved}`));
  tourList.replaceChildren(...TOUR.map(([words, done]) => h("li", { class: done(bench) ? "done" : "" }, done(bench) ? `✓ ${words}` : words)));
}

async function refresh() {
  try {
    await take(await get(`api/state?${query({ since: "" })}`));
  } catch (error) {
    fail(/** @type {Error} */ (error));
  }
}

/** Looks whether something has changed, also by another page. */
async function look() {
  try {
    const was = job.running;
    const told = await get(`api/state?${query({ since: key })}`);
    if (was && !told.job.running && told.bench === undefined) await refresh();
    await take(told);
  } catch (error) {
    if (error instanceof Silent) lost(true);
    else fail(/** @type {Error} */ (error));
  }
  setTimeout(look, job.running || bench?.preparing ? 150 : document.hidden ? 3000 : 700);
}

by("cancel").addEventListener("click", () => post("api/cancel").catch(fail));
by("theme").addEventListener("click", () => {
  const root = document.documentElement;
  const dark = root.dataset.theme ? root.dataset.theme === "dark" : matchMedia("(prefers-color-scheme: dark)").matches;
  root.dataset.theme = dark ? "light" : "dark";
  drive.draw();
  cloud.draw();
  figures.redraw();
});
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => { drive.draw(); cloud.draw(); figures.redraw(); });
document.addEventListener("keydown", (event) => {
  if (event.key === "Escape") marks.choose(null);
  if (!(event.ctrlKey || event.metaKey) || event.key !== "Enter" || !bench) return;
  event.preventDefault();
  const next = bench.state.draft?.fitted ? "accept" : "fit";
  if (!by(next)?.disabled) by(next)?.click();
});
for (const name of ["dragover", "drop"]) document.addEventListener(name, (event) => event.preventDefault());

await refresh();
choose(bench ? "work" : "data");
document.body.dataset.ready = "1";
setTimeout(look, 700);
