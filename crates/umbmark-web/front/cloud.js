// @ts-check
// Monte Carlo: the cloud of returns of simulated tests, drawn anew while a slider is dragged.

import { colours, h, mm, plain, rem, sheet, ticks } from "./elements.js";
import { latest, post } from "./server.js";

const SLIDERS = /** @type {[string, string, number, number, number, number][]} */ ([
  ["e_d", "E_d, ratio of the wheel diameters", 0.99, 1.01, 0.0001, 1.002],
  ["e_b", "E_b, ratio of actual to nominal wheelbase", 0.96, 1.04, 0.0005, 1.01],
  ["noise", "noise of the wheels k [m^0.5]", 0, 0.004, 0.00005, 0.001],
  ["side", "side of the square [m]", 0.5, 10, 0.1, 4],
  ["runs", "runs each way", 1, 10, 1, 5],
]);

/** @param {{ fail: (error: Error) => void, catalogue: any }} page */
export function cloudPart(page) {
  const canvas = h("canvas", { role: "img", id: "cloud", "aria-label": "Cloud of returns" });
  const table = h("table", { id: "cloud-table" });
  const command = h("pre", { id: "cloud-command", tabindex: "0" });
  const tests = h("select", { id: "trials" }, [1000, 10000, 100000].map((n) => h("option", { value: n, selected: n === 10000 }, `${n} tests`)));
  const seed = h("input", { id: "seed", type: "number", min: 0, step: 1, value: 1 });
  const inputs = Object.fromEntries(SLIDERS.map(([name, , low, high, step, value]) => [name, h("input", { type: "range", id: `mc-${name}`, min: low, max: high, step, value })]));
  const outs = Object.fromEntries(SLIDERS.map(([name]) => [name, h("output", { for: `mc-${name}` })]));
  const published = h("p", { id: "published", "aria-live": "polite" });
  const robots = page.catalogue.paper.map((/** @type {any} */ own) => h("button", { type: "button", onclick: () => take(own) }, own.row));
  const root = h("div", { class: "two" },
    h("section", { class: "card", "aria-label": "Cloud of returns" }, h("h2", {}, "Where the robot comes back"), canvas,
      h("ul", { class: "legend" }, h("li", {}, h("span", { class: "mark dots", style: "--tone: var(--cw)" }), "clockwise"), h("li", {}, h("span", { class: "mark dots", style: "--tone: var(--ccw)" }), "counter-clockwise"), h("li", {}, "+ START")),
      h("p", { class: "hint" }, "A dot is the centre of the returns of one test each way. The robot is the paper's LabMate.")),
    h("section", { class: "card", "aria-label": "Robot and test" }, h("h2", {}, "Robot and test"),
      h("div", { role: "group", "aria-label": "Robots of the paper", class: "buttons" }, h("span", { class: "small" }, "The paper's Table I and Figure 10: "), robots),
      SLIDERS.map(([name, words]) => h("div", { class: "controls" }, h("label", { for: `mc-${name}`, style: "grid-column: 1 / -1" }, words), h("span"), inputs[name], outs[name])),
      h("div", { class: "controls" }, h("label", { for: "trials" }, "tests"), h("div", {}, tests), ""),
      h("div", { class: "controls" }, h("label", { for: "seed" }, "seed"), h("div", {}, seed), ""),
      h("div", { class: "scroll" }, table), published, h("p", { class: "small" }, "The same on a command line:"), command));

  /** @type {any} */ let cloud = null;
  /** Values between the steps of the sliders. @type {Record<string, number>} */ const exact = {};
  const value = (/** @type {string} */ name) => exact[name] ?? Number(inputs[name].value);
  const now = (/** @type {number} */ trials) => ({ ...Object.fromEntries(SLIDERS.map(([name]) => [name, value(name)])), trials, seed: Math.max(0, Math.trunc(Number(seed.value) || 0)) });
  const ask = latest((question) => post("api/cloud", question), (told) => { cloud = told; draw(); tell(); }, page.fail);
  const words = () => { for (const [name] of SLIDERS) outs[name].textContent = plain(value(name)); };
  const refresh = () => { words(); ask(now(Number(tests.value))); };
  /** One of the paper's robots, driven as it was. @param {any} own */
  const take = (own) => {
    Object.assign(exact, { e_d: own.e_d, e_b: own.e_b, noise: own.noise, side: 4, runs: 5 });
    for (const [name] of SLIDERS) inputs[name].value = String(exact[name]);
    published.textContent = `Published of ${own.row}: E_max,sys ${mm(own.e_max_sys_m)}, sigma ${mm(own.sigma_m)}. The noise is that of this sigma.`;
    refresh();
  };
  for (const [name] of SLIDERS) {
    // While it is dragged, at most 10 000 tests.
    inputs[name].addEventListener("input", () => { delete exact[name]; published.textContent = ""; words(); ask(now(Math.min(10000, Number(tests.value)))); });
    inputs[name].addEventListener("change", refresh);
  }
  tests.addEventListener("change", refresh);
  seed.addEventListener("change", refresh);

  function tell() {
    const names = /** @type {[string, string][]} */ ([["e_max_sys_m", "E_max,sys"], ["sigma_m", "sigma"]]);
    const cell = (/** @type {any} */ value) => h("td", {}, mm(value));
    const { metrics } = cloud.result;
    table.replaceChildren(h("thead", {}, h("tr", {}, ["metric", "mean", "5 %", "50 %", "95 %"].map((w) => h("th", { scope: "col" }, w)))), h("tbody", {}, names.filter(([key]) => metrics[key]).map(([key, title]) => h("tr", {}, h("th", { scope: "row" }, title), cell(metrics[key].mean), cell(metrics[key].quantiles["0.05"]), cell(metrics[key].quantiles["0.5"]), cell(metrics[key].quantiles["0.95"])))));
    command.textContent = cloud.command;
    canvas.setAttribute("aria-label", `Cloud of returns of ${cloud.result.n} tests; mean E_max,sys ${mm(metrics.e_max_sys_m?.mean)}.`);
    canvas.dataset.n = String(cloud.cw.x.length);
  }

  /** The reach of the axes [0.01 mm], which grows at once and shrinks only by half. */
  let reach = 1000;
  function draw() {
    if (!cloud) return;
    const c = colours(["cw", "ccw", "ink", "soft", "grid"]);
    const { pen, width, height, size } = sheet(canvas, Math.min(canvas.clientWidth || 300, 36 * rem()));
    let most = 100;
    for (const one of [cloud.cw, cloud.ccw]) for (const axis of ["x", "y"]) for (const value of one[axis]) { const far = Math.abs(value); if (far > most) most = far; }
    if (most > reach || most < reach / 2.2) reach = 1.15 * most;
    const scale = (Math.min(width, height) / 2 - size) / reach;
    const X = (/** @type {number} */ x) => width / 2 + x * scale;
    const Y = (/** @type {number} */ y) => height / 2 - y * scale;
    pen.strokeStyle = c.grid; pen.fillStyle = c.soft; pen.textAlign = "center";
    const across = width / 2 / scale / 100;
    for (const x of ticks(-across, across, width / 90)) { pen.beginPath(); pen.moveTo(X(100 * x), 0); pen.lineTo(X(100 * x), height); pen.stroke(); pen.fillText(`${x} mm`, X(100 * x), height - 4); }
    const up = height / 2 / scale / 100;
    pen.textAlign = "left";
    for (const y of ticks(-up, up, height / 70)) { pen.beginPath(); pen.moveTo(0, Y(100 * y)); pen.lineTo(width, Y(100 * y)); pen.stroke(); if (Y(100 * y) < height - 2 * size) pen.fillText(`${y} mm`, 4, Y(100 * y) - 3); }
    const count = cloud.cw.x.length;
    const dot = count > 20000 ? 1 : count > 3000 ? 1.6 : 2.6;
    pen.globalAlpha = count > 3000 ? 0.45 : 0.7;
    for (const name of ["cw", "ccw"]) {
      const { x, y } = cloud[name];
      pen.fillStyle = c[name];
      for (let i = 0; i < x.length; i += 1) pen.fillRect(X(x[i]) - dot / 2, Y(y[i]) - dot / 2, dot, dot);
    }
    pen.globalAlpha = 1;
    pen.strokeStyle = c.ink; pen.lineWidth = 2;
    pen.beginPath(); pen.moveTo(X(0) - 8, Y(0)); pen.lineTo(X(0) + 8, Y(0)); pen.moveTo(X(0), Y(0) - 8); pen.lineTo(X(0), Y(0) + 8); pen.stroke();
  }
  new ResizeObserver(draw).observe(canvas);
  return { root, draw, seen: () => { if (!cloud) refresh(); else draw(); } };
}
