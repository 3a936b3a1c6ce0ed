// @ts-check
// The drive as measured, as the robot believed it, and as the model has it; and the error over time.

import { colours, h, mm, rem, sheet, ticks } from "./elements.js";

/** @typedef {{ x: number[], y: number[], heading: number[] }} Poses */
/** @typedef {{ name: string, direction: string | null, time: number[], computed: Poses, measured: { x: number[], y: number[], place: number[] }, dense: boolean }} Run */

const NAMES = ["cw", "ccw", "measured", "computed", "model", "quiet", "ink", "soft", "grid", "paper"];

/**
 * @param {{ hide: (names: string[]) => void }} page
 */
export function drivePart(page) {
  const plan = h("canvas", { role: "img", "aria-label": "The drive from above", id: "plan", tabindex: "0" });
  const strip = h("canvas", { role: "img", "aria-label": "Error over time", id: "strip" });
  const moment = h("input", { type: "range", id: "moment", min: "0", max: "1000", value: "1000", step: "1" });
  const momentOut = h("output", { for: "moment" });
  const enlarge = h("input", { type: "range", id: "enlarge", min: "0", max: "3", step: "0.05", value: "1" });
  const enlargeOut = h("output", { for: "enlarge" });
  const play = h("button", { type: "button", id: "play" }, "Play");
  const runsBox = h("div", { class: "runs" });
  const legend = h("ul", { class: "legend" });
  const says = h("p", { class: "small", id: "drive-says", "aria-live": "polite" });
  const root = h("section", { class: "card", "aria-label": "The drive" },
    h("h2", {}, "The drive"), plan, legend,
    h("div", { class: "controls" },
      h("label", { for: "moment" }, "time"), moment, momentOut,
      h("label", { for: "enlarge" }, "error × "), enlarge, enlargeOut),
    h("div", { class: "buttons" }, play, h("span", { class: "hint" }, "Distances from the believed path are drawn so many times larger.")),
    h("h3", {}, "Distance of the measured from the modelled place"), strip, says,
    h("details", {}, h("summary", {}, "Runs"), h("p", { class: "hint" }, "Hiding a run changes the drawing only; all runs are fitted."), h("div", { class: "buttons" },
      h("button", { type: "button", onclick: () => show([]) }, "all"), h("button", { type: "button", onclick: () => show(runs.map((run) => run.name)) }, "none")), runsBox));

  /** @type {Run[]} */ let runs = [];
  /** @type {Poses[]} */ let modelled = [];
  /** @type {Set<string>} */ let hidden = new Set();
  /** @type {string | null} */ let marked = null;
  /** @type {{ run: number, index: number } | null} */ let pointed = null;
  let recorded = true;
  let playing = 0;

  /** @param {string[]} names */
  function show(names) {
    hidden = new Set(names);
    page.hide(names);
    boxes();
    draw();
  }

  function boxes() {
    runsBox.replaceChildren(...runs.map((run) => h("label", {}, h("input", { type: "checkbox", checked: !hidden.has(run.name), onchange: (/** @type {any} */ e) => {
      if (e.target.checked) hidden.delete(run.name); else hidden.add(run.name);
      page.hide([...hidden]);
      draw();
    } }), ` ${run.name}`)));
  }

  const last = () => Math.max(1e-9, ...runs.map((run) => run.time.at(-1) ?? 0));
  const share = () => Number(moment.value) / 1000;
  /** The place of a run at the moment. @param {Run} run */
  const placeAt = (run) => {
    if (!run.time.length) return Math.round(share() * (run.computed.x.length - 1));
    const at = share() * last();
    let low = 0;
    let high = run.time.length - 1;
    while (low < high) { const middle = (low + high + 1) >> 1; if (run.time[middle] <= at) low = middle; else high = middle - 1; }
    return low;
  };
  const factor = () => 10 ** Number(enlarge.value);

  /** @param {number} k @param {number} index */
  const error = (k, index) => {
    const run = runs[k];
    const place = run.measured.place[index];
    const model = modelled[k] ?? run.computed;
    return Math.hypot(run.measured.x[index] - model.x[place], run.measured.y[index] - model.y[place]);
  };

  let asked = 0;
  function draw() {
    if (asked) return;
    asked = requestAnimationFrame(() => { asked = 0; paint(); });
  }

  function paint() {
    const c = colours(NAMES);
    const by = factor();
    momentOut.textContent = runs.some((run) => run.time.length) ? `${(share() * last()).toFixed(1)} s` : `${Math.round(100 * share())} %`;
    enlargeOut.textContent = by < 10 ? by.toFixed(1) : String(Math.round(by));
    const shown = runs.map((run, k) => /** @type {[Run, number]} */ ([run, k])).filter(([run]) => !hidden.has(run.name));
    paintPlan(c, by, shown);
    paintStrip(c, shown);
  }

  /** @param {Record<string, string>} c @param {number} by @param {[Run, number][]} shown */
  function paintPlan(c, by, shown) {
    const wide = plan.clientWidth || 300;
    const { pen, width, height, size } = sheet(plan, Math.min(0.75 * wide, 26 * rem()));
    let [left, right, low, high] = [Infinity, -Infinity, Infinity, -Infinity];
    const wider = (/** @type {number} */ x, /** @type {number} */ y) => { left = Math.min(left, x); right = Math.max(right, x); low = Math.min(low, y); high = Math.max(high, y); };
    for (const run of runs) for (let i = 0; i < run.computed.x.length; i += 4) wider(run.computed.x[i], run.computed.y[i]);
    if (!(right > left)) [left, right] = [left - 1 || -1, right + 1 || 1];
    if (!(high > low)) [low, high] = [low - 1 || -1, high + 1 || 1];
    const room = 2.6 * size;
    const scale = Math.min((width - 2 * room) / (right - left) , (height - 2 * room) / (high - low)) * 0.86;
    const [cx, cy] = [(left + right) / 2, (low + high) / 2];
    const X = (/** @type {number} */ x) => width / 2 + (x - cx) * scale;
    const Y = (/** @type {number} */ y) => height / 2 - (y - cy) * scale;
    pen.strokeStyle = c.grid;
    pen.fillStyle = c.soft;
    pen.lineWidth = 1;
    for (const x of ticks(cx - width / 2 / scale, cx + width / 2 / scale, width / 90)) { pen.beginPath(); pen.moveTo(X(x), 0); pen.lineTo(X(x), height); pen.stroke(); pen.textAlign = "center"; pen.fillText(`${x} m`, X(x), height - 4); }
    for (const y of ticks(cy - height / 2 / scale, cy + height / 2 / scale, height / 70)) { pen.beginPath(); pen.moveTo(0, Y(y)); pen.lineTo(width, Y(y)); pen.stroke(); pen.textAlign = "left"; if (Y(y) < height - 2 * size) pen.fillText(`${y} m`, 4, Y(y) - 3); }
    for (const [run, k] of shown) {
      const at = placeAt(run);
      const bold = marked === run.name;
      const tone = run.direction === "cw" ? c.cw : run.direction === "ccw" ? c.ccw : c.measured;
      pen.lineJoin = "round";
      pen.lineWidth = bold ? 2.5 : 1.2;
      const line = (/** @type {string} */ colour, /** @type {number[]} */ dash, /** @type {(i: number) => [number, number]} */ of, /** @type {number} */ n) => {
        pen.strokeStyle = colour;
        pen.setLineDash(dash);
        pen.beginPath();
        for (let i = 0; i < n; i += 1) { const [x, y] = of(i); if (i) pen.lineTo(X(x), Y(y)); else pen.moveTo(X(x), Y(y)); }
        pen.stroke();
        pen.setLineDash([]);
      };
      line(c.computed, [5, 4], (i) => [run.computed.x[i], run.computed.y[i]], at + 1);
      const model = modelled[k];
      const far = (/** @type {number} */ i, /** @type {number} */ x, /** @type {number} */ y) => /** @type {[number, number]} */ ([run.computed.x[i] + by * (x - run.computed.x[i]), run.computed.y[i] + by * (y - run.computed.y[i])]);
      if (model) { pen.globalAlpha = marked && !bold ? 0.35 : 1; line(c.model, [], (i) => far(i, model.x[i], model.y[i]), at + 1); pen.globalAlpha = 1; }
      const seen = run.measured.place.filter((place) => place <= at).length;
      const measuredAt = (/** @type {number} */ j) => far(run.measured.place[j], run.measured.x[j], run.measured.y[j]);
      pen.globalAlpha = marked && !bold ? 0.35 : 1;
      if (run.dense) line(tone, [], measuredAt, seen);
      else {
        pen.fillStyle = tone;
        for (let j = 0; j < seen; j += 1) { const [x, y] = measuredAt(j); pen.beginPath(); if (run.direction === "ccw") pen.rect(X(x) - 3.5, Y(y) - 3.5, 7, 7); else pen.arc(X(x), Y(y), 3.8, 0, 7); pen.fill(); }
      }
      pen.globalAlpha = 1;
      if (pointed?.run === k) { const [x, y] = measuredAt(pointed.index); pen.strokeStyle = c.ink; pen.lineWidth = 2; pen.beginPath(); pen.arc(X(x), Y(y), 9, 0, 7); pen.stroke(); }
    }
    // The robot of the run that is marked, or of the first one.
    const robot = shown.find(([run]) => run.name === marked) ?? shown[0];
    if (robot) {
      const [run, k] = robot;
      const at = placeAt(run);
      const draw = (/** @type {number} */ x, /** @type {number} */ y, /** @type {number} */ heading, /** @type {string} */ colour) => {
        const [px, py, r] = [X(x), Y(y), 11];
        const tip = (/** @type {number} */ turn, /** @type {number} */ far) => /** @type {[number, number]} */ ([px + far * Math.cos(heading + turn), py - far * Math.sin(heading + turn)]);
        pen.fillStyle = colour; pen.strokeStyle = c.paper; pen.lineWidth = 1.5;
        pen.beginPath(); pen.moveTo(...tip(0, r)); pen.lineTo(...tip(2.5, r * 0.85)); pen.lineTo(...tip(-2.5, r * 0.85)); pen.closePath(); pen.fill(); pen.stroke();
      };
      draw(run.computed.x[at], run.computed.y[at], run.computed.heading[at], c.computed);
      const model = modelled[k];
      if (model) draw(run.computed.x[at] + by * (model.x[at] - run.computed.x[at]), run.computed.y[at] + by * (model.y[at] - run.computed.y[at]), model.heading[at], c.model);
    }
  }

  /** Where the pointer of the strip is looked up. @type {{ left: number, right: number, most: number, height: number } | null} */
  let axes = null;

  /** @param {Record<string, string>} c @param {[Run, number][]} shown */
  function paintStrip(c, shown) {
    const { pen, width, height, size } = sheet(strip, 11 * rem());
    const timed = runs.some((run) => run.time.length > 0 && run.measured.place.length > 1);
    const [left, bottom] = [5.2 * size, height - 1.7 * size];
    let most = 1e-4;
    for (const [run, k] of shown) for (let j = 0; j < run.measured.place.length; j += 1) most = Math.max(most, error(k, j));
    const end = timed ? last() : Math.max(1, shown.length);
    const X = (/** @type {number} */ x) => left + (x / end) * (width - left - 8);
    const Y = (/** @type {number} */ y) => bottom - (y / most) * (bottom - 8);
    axes = timed ? { left, right: width - 8, most: end, height: bottom } : null;
    pen.strokeStyle = c.grid; pen.fillStyle = c.soft; pen.lineWidth = 1; pen.textAlign = "right";
    for (const y of ticks(0, 1e3 * most, 4)) { pen.beginPath(); pen.moveTo(left, Y(y / 1e3)); pen.lineTo(width - 8, Y(y / 1e3)); pen.stroke(); pen.fillText(`${y} mm`, left - 5, Y(y / 1e3) + size / 3); }
    pen.textAlign = "center";
    if (timed) for (const x of ticks(0, end, width / 90)) pen.fillText(`${x} s`, Math.min(X(x), width - 14), height - 4);
    /** @type {number[]} */ const ends = [];
    shown.forEach(([run, k], n) => {
      const tone = run.direction === "cw" ? c.cw : run.direction === "ccw" ? c.ccw : c.measured;
      const bold = marked === run.name;
      const count = run.measured.place.length;
      if (!count) return;
      ends.push(error(k, count - 1));
      pen.globalAlpha = marked && !bold ? 0.3 : 1;
      if (!timed) {
        const y = Y(error(k, count - 1));
        pen.fillStyle = tone;
        pen.fillRect(X(n + 0.15), y, X(n + 0.85) - X(n + 0.15), bottom - y);
      } else {
        pen.strokeStyle = tone; pen.lineWidth = bold ? 2.6 : 1.2; pen.setLineDash(run.direction === "ccw" ? [7, 3] : []);
        pen.beginPath();
        for (let j = 0; j < count; j += 1) { const x = X(run.time[run.measured.place[j]]); const y = Y(error(k, j)); if (j) pen.lineTo(x, y); else pen.moveTo(x, y); }
        pen.stroke(); pen.setLineDash([]);
      }
      pen.globalAlpha = 1;
    });
    if (timed) { pen.strokeStyle = c.soft; pen.lineWidth = 1; const x = X(share() * end); pen.beginPath(); pen.moveTo(x, 4); pen.lineTo(x, bottom); pen.stroke(); }
    if (pointed && runs[pointed.run]) {
      const run = runs[pointed.run];
      says.textContent = `${run.name}, ${run.time.length ? `${run.time[run.measured.place[pointed.index]].toFixed(1)} s: ` : ""}${mm(error(pointed.run, pointed.index))}`;
    } else if (ends.length) {
      says.textContent = `At the end: ${mm(Math.min(...ends))} to ${mm(Math.max(...ends))} in ${ends.length} runs.`;
    } else says.textContent = "No run is shown.";
    strip.setAttribute("aria-label", `Error over time. ${says.textContent}`);
    plan.setAttribute("aria-label", `The drive from above: measured, believed and modelled paths of ${shown.length} runs. ${says.textContent}`);
  }

  strip.addEventListener("pointermove", (/** @type {PointerEvent} */ event) => {
    if (!axes) return;
    const box = strip.getBoundingClientRect();
    const at = ((event.clientX - box.left - axes.left) / (axes.right - axes.left)) * axes.most;
    const timeY = event.clientY - box.top;
    let best = Infinity;
    pointed = null;
    let most = 1e-4;
    runs.forEach((run, k) => { if (!hidden.has(run.name)) run.measured.place.forEach((_, j) => { most = Math.max(most, error(k, j)); }); });
    runs.forEach((run, k) => {
      if (hidden.has(run.name)) return;
      run.measured.place.forEach((place, index) => {
        const dx = ((run.time[place] - at) / /** @type {any} */ (axes).most) * (/** @type {any} */ (axes).right - /** @type {any} */ (axes).left);
        const dy = /** @type {any} */ (axes).height * (1 - error(k, index) / most) - timeY;
        const far = dx * dx + dy * dy;
        if (far < best) { best = far; pointed = { run: k, index }; }
      });
    });
    marked = pointed ? runs[/** @type {any} */ (pointed).run].name : null;
    draw();
  });
  strip.addEventListener("pointerleave", () => { pointed = null; marked = null; draw(); });
  moment.addEventListener("input", draw);
  enlarge.addEventListener("input", draw);
  play.addEventListener("click", () => {
    if (playing) { cancelAnimationFrame(playing); playing = 0; play.textContent = "Play"; return; }
    if (Number(moment.value) >= 1000) moment.value = "0";
    play.textContent = "Pause";
    let then = performance.now();
    const step = (/** @type {number} */ now) => {
      moment.value = String(Math.min(1000, Number(moment.value) + (now - then) / 8));
      then = now;
      paint();
      if (Number(moment.value) >= 1000) { playing = 0; play.textContent = "Play"; } else playing = requestAnimationFrame(step);
    };
    moment.step = "any";
    playing = requestAnimationFrame(step);
  });
  new ResizeObserver(draw).observe(root);

  return {
    root,
    /** @param {{ recorded: boolean, runs: Run[] }} paths */
    data(paths) {
      ({ runs, recorded } = paths);
      modelled = [];
      const far = Math.max(1e-6, ...runs.map((run) => Math.max(...run.measured.place.map((place, j) => Math.hypot(run.measured.x[j] - run.computed.x[place], run.measured.y[j] - run.computed.y[place])), 0)));
      const span = Math.max(...runs.map((run) => Math.max(...run.computed.x) - Math.min(...run.computed.x)), 0.1);
      enlarge.value = String(Math.max(0, Math.log10(Math.min(1000, (0.15 * span) / far))));
      const entry = (/** @type {string} */ name, /** @type {string} */ mark, /** @type {string} */ words) => h("li", {}, h("span", { class: `mark ${mark}`, style: `--tone: var(--${name})` }), words);
      const dense = runs.some((run) => run.dense);
      legend.replaceChildren(entry("cw", dense ? "line" : "dots", "measured, cw"), entry("ccw", dense ? "line" : "bars", "measured, ccw"), entry("computed", "dashes", recorded ? "as the robot believed" : "as commanded"), entry("model", "line", "as the model has it"));
      boxes();
      draw();
    },
    /** @param {Poses[]} poses */
    model(poses) { modelled = poses; draw(); },
    /** @param {string[]} names */
    hide(names) { hidden = new Set(names); boxes(); draw(); },
    /** @param {string | null} name */
    mark(name) { marked = name; draw(); },
    draw,
  };
}
