// @ts-check
// The drive as measured, as the robot computed it, and as the model has it; and the error over time.

import { colours, h, mm, rem, sheet, ticks } from "./elements.js";
import { nearest } from "./marks.js";

/** @typedef {{ x: number[], y: number[], heading: number[] }} Poses */
/** @typedef {import("./marks.js").Mark} Mark */
/** @typedef {{ run: number, index: number }} Place a run and one of its measured places, by their numbers */
/** @typedef {{ name: string, direction: string | null, time: number[], rolled: number[], computed: Poses, measured: { x: number[], y: number[], place: number[] }, dense: boolean }} Run */

const NAMES = ["cw", "ccw", "measured", "computed", "model", "quiet", "ink", "soft", "grid", "paper"];

/**
 * @param {{ hide: (names: string[]) => void, point: (mark: Mark | null) => void, toggle: (mark: Mark) => void, choose: (mark: Mark | null) => void }} page
 */
export function drivePart(page) {
  const plan = h("canvas", { role: "img", "aria-label": "The drive from above", id: "plan", tabindex: "0" });
  const strip = h("canvas", { role: "slider", "aria-label": "Error over time", "aria-valuemin": "0", "aria-valuemax": "0", "aria-valuenow": "0", id: "strip", tabindex: "0" });
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
    h("div", { class: "buttons" }, play, h("span", { class: "hint" }, "The slider says how many times larger distances from the computed path are drawn.")),
    h("h3", {}, "Distance of the measured from the modelled place"), strip, says,
    h("p", { class: "hint" }, "Point at a place here or above: it is marked in all figures. A click keeps the mark, Escape or a second click clears it. Arrow keys move it along the run, and to the next run."),
    h("details", {}, h("summary", {}, "Runs"), h("p", { class: "hint" }, "Hiding a run changes the drawing only; all runs are fitted."), h("div", { class: "buttons" },
      h("button", { type: "button", onclick: () => show([]) }, "all"), h("button", { type: "button", onclick: () => show(runs.map((run) => run.name)) }, "none")), runsBox));

  /** @type {Run[]} */ let runs = [];
  /** @type {Poses[]} */ let modelled = [];
  /** @type {Set<string>} */ let hidden = new Set();
  /** @type {string | null} */ let marked = null;
  /** @type {Place | null} */ let pointed = null;
  let kept = false;
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

  /** Where a place is drawn, its distance from the computed one magnified. @param {Run} run @param {number} i @param {number} x @param {number} y @returns {[number, number]} */
  const enlarged = (run, i, x, y) => [run.computed.x[i] + factor() * (x - run.computed.x[i]), run.computed.y[i] + factor() * (y - run.computed.y[i])];
  /** @param {Run} run @param {number} index */
  const measuredAt = (run, index) => enlarged(run, run.measured.place[index], run.measured.x[index], run.measured.y[index]);
  /** Numbers of the runs that are drawn and were measured. */
  const drawn = () => runs.map((_, k) => k).filter((k) => !hidden.has(runs[k].name) && runs[k].measured.place.length > 0);
  const isTimed = () => runs.some((run) => run.time.length > 0 && run.measured.place.length > 1);

  /** @param {Place} place @returns {Mark} */
  const markOf = ({ run, index }) => ({ run: runs[run].name, rolled: runs[run].rolled[runs[run].measured.place[index]], index });
  /** The measured place of a mark; null where there is none. @param {Mark} mark @returns {Place | null} */
  const placeOf = (mark) => {
    const k = drawn().find((own) => runs[own].name === mark.run);
    if (k === undefined || mark.rolled === null) return null;
    const { rolled, measured } = runs[k];
    const index = mark.index ?? nearest(measured.place.map((place) => rolled[place]), mark.rolled);
    return { run: k, index: Math.min(index, measured.place.length - 1) };
  };
  /** A place in words. @param {Place} place */
  const inWords = ({ run: k, index }) => {
    const run = runs[k];
    const place = run.measured.place[index];
    const parts = [run.name, run.time.length ? `${run.time[place].toFixed(1)} s` : "", `${run.rolled[place].toFixed(2)} m`];
    return `${parts.filter(Boolean).join(", ")}: ${mm(error(k, index))}`;
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
    paintPlan(c, shown);
    paintStrip(c, shown);
  }

  /** Where things stand on the plan. @type {{ X: (x: number) => number, Y: (y: number) => number } | null} */
  let view = null;

  /** @param {Record<string, string>} c @param {[Run, number][]} shown */
  function paintPlan(c, shown) {
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
    view = { X, Y };
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
      if (model) { pen.globalAlpha = marked && !bold ? 0.35 : 1; line(c.model, [], (i) => enlarged(run, i, model.x[i], model.y[i]), at + 1); pen.globalAlpha = 1; }
      const seen = run.measured.place.filter((place) => place <= at).length;
      pen.globalAlpha = marked && !bold ? 0.35 : 1;
      if (run.dense) line(tone, [], (j) => measuredAt(run, j), seen);
      else {
        pen.fillStyle = tone;
        for (let j = 0; j < seen; j += 1) { const [x, y] = measuredAt(run, j); pen.beginPath(); if (run.direction === "ccw") pen.rect(X(x) - 3.5, Y(y) - 3.5, 7, 7); else pen.arc(X(x), Y(y), 3.8, 0, 7); pen.fill(); }
      }
      pen.globalAlpha = 1;
      if (pointed?.run === k) ring(pen, c, ...place(X, Y, measuredAt(run, pointed.index)));
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
      if (model) draw(...enlarged(run, at, model.x[at], model.y[at]), model.heading[at], c.model);
    }
  }

  /** @param {(x: number) => number} X @param {(y: number) => number} Y @param {[number, number]} at @returns {[number, number]} */
  const place = (X, Y, [x, y]) => [X(x), Y(y)];
  /** Marks a place, twice where it is chosen. @param {CanvasRenderingContext2D} pen @param {Record<string, string>} c @param {number} x @param {number} y */
  function ring(pen, c, x, y) {
    pen.strokeStyle = c.ink;
    pen.lineWidth = 2;
    for (const radius of kept ? [9, 5] : [9]) { pen.beginPath(); pen.arc(x, y, radius, 0, 7); pen.stroke(); }
  }

  /** Where things stand on the strip: over time, or a bar for each run. @type {{ timed: boolean, X: (x: number) => number, Y: (y: number) => number } | null} */
  let axes = null;

  /** @param {Record<string, string>} c @param {[Run, number][]} shown */
  function paintStrip(c, shown) {
    const { pen, width, height, size } = sheet(strip, 11 * rem());
    const timed = isTimed();
    const [left, bottom] = [5.2 * size, height - 1.7 * size];
    let most = 1e-4;
    for (const [run, k] of shown) for (let j = 0; j < run.measured.place.length; j += 1) most = Math.max(most, error(k, j));
    const end = timed ? last() : Math.max(1, shown.length);
    const X = (/** @type {number} */ x) => left + (x / end) * (width - left - 8);
    const Y = (/** @type {number} */ y) => bottom - (y / most) * (bottom - 8);
    axes = { timed, X, Y };
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
    const n = pointed ? shown.findIndex(([, k]) => k === pointed?.run) : -1;
    if (pointed && n >= 0) {
      const [run, k] = shown[n];
      const x = timed ? run.time[run.measured.place[pointed.index]] : n + 0.5;
      ring(pen, c, X(x), Y(error(k, pointed.index)));
      says.textContent = inWords(pointed) + (kept ? " (chosen)" : "");
    } else if (ends.length) {
      says.textContent = `At the end: ${mm(Math.min(...ends))} to ${mm(Math.max(...ends))} in ${ends.length} runs.`;
    } else says.textContent = "No run is shown.";
    strip.setAttribute("aria-valuemax", String(Math.max(0, (pointed ? runs[pointed.run].measured.place.length : 1) - 1)));
    strip.setAttribute("aria-valuenow", String(pointed?.index ?? 0));
    strip.setAttribute("aria-valuetext", says.textContent ?? "");
    plan.setAttribute("aria-label", `The drive from above: measured, computed and modelled paths of ${shown.length} runs. ${says.textContent}`);
  }

  /**
   * The measured place that is drawn nearest to the pointer, within so many pixels.
   * @param {HTMLCanvasElement} canvas @param {PointerEvent | MouseEvent} event @param {number} reach
   * @param {(k: number, index: number) => [number, number] | null} at where a place is drawn
   */
  function under(canvas, event, reach, at) {
    const box = canvas.getBoundingClientRect();
    const [px, py] = [event.clientX - box.left, event.clientY - box.top];
    /** @type {Place | null} */ let found = null;
    let least = reach * reach;
    for (const k of drawn()) {
      runs[k].measured.place.forEach((_, index) => {
        const there = at(k, index);
        const far = there ? (there[0] - px) ** 2 + (there[1] - py) ** 2 : Infinity;
        if (far < least) { least = far; found = { run: k, index }; }
      });
    }
    return /** @type {Place | null} */ (found);
  }

  /** @param {PointerEvent | MouseEvent} event */
  const onPlan = (event) => {
    const now = view;
    if (!now) return null;
    return under(plan, event, 30, (k, index) => (runs[k].measured.place[index] <= placeAt(runs[k]) ? place(now.X, now.Y, measuredAt(runs[k], index)) : null));
  };
  /** @param {PointerEvent | MouseEvent} event */
  const onStrip = (event) => {
    const now = axes;
    if (!now) return null;
    if (now.timed) return under(strip, event, Infinity, (k, index) => [now.X(runs[k].time[runs[k].measured.place[index]]), now.Y(error(k, index))]);
    const x = event.clientX - strip.getBoundingClientRect().left;
    const names = runs.map((_, k) => k).filter((k) => !hidden.has(runs[k].name));
    const k = names.find((_, n) => x >= now.X(n) && x < now.X(n + 1));
    return k !== undefined && runs[k].measured.place.length ? { run: k, index: runs[k].measured.place.length - 1 } : null;
  };
  for (const [canvas, of] of /** @type {[HTMLCanvasElement, (event: PointerEvent | MouseEvent) => Place | null][]} */ ([[plan, onPlan], [strip, onStrip]])) {
    canvas.addEventListener("pointermove", (event) => { const found = of(event); page.point(found && markOf(found)); });
    canvas.addEventListener("pointerleave", () => page.point(null));
    canvas.addEventListener("click", (event) => { const found = of(event); if (found) page.toggle(markOf(found)); });
  }
  strip.addEventListener("keydown", (/** @type {KeyboardEvent} */ event) => {
    const all = drawn();
    if (!all.length || event.ctrlKey || event.metaKey || event.altKey) return;
    const from = pointed ?? { run: all[0], index: 0 };
    const last = (/** @type {number} */ k) => runs[k].measured.place.length - 1;
    /** Another run, at about the same way. @param {number} by @returns {Place} */
    const run = (by) => {
      const k = all[Math.min(all.length - 1, Math.max(0, all.indexOf(from.run) + by))];
      return placeOf({ run: runs[k].name, rolled: markOf(from).rolled }) ?? from;
    };
    /** @param {number} by @returns {Place} */
    const along = (by) => (isTimed() ? { run: from.run, index: Math.min(last(from.run), Math.max(0, from.index + by)) } : run(Math.sign(by)));
    /** @type {Record<string, () => Place>} */
    const moves = {
      ArrowRight: () => along(1), ArrowLeft: () => along(-1), PageUp: () => along(10), PageDown: () => along(-10), ArrowDown: () => run(1), ArrowUp: () => run(-1),
      Home: () => (isTimed() ? { run: from.run, index: 0 } : run(-all.length)), End: () => (isTimed() ? { run: from.run, index: last(from.run) } : run(all.length)),
    };
    const move = moves[event.key];
    if (!move) return;
    event.preventDefault();
    page.choose(markOf(pointed ? move() : from));
  });
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
      legend.replaceChildren(entry("cw", dense ? "line" : "dots", "measured, cw"), entry("ccw", dense ? "line" : "bars", "measured, ccw"), entry("computed", "dashes", recorded ? "as the robot computed it" : "as commanded"), entry("model", "line", "as the model has it"));
      boxes();
      draw();
    },
    /** @param {Poses[]} poses */
    model(poses) { modelled = poses; draw(); },
    /** @param {string[]} names */
    hide(names) { hidden = new Set(names); boxes(); draw(); },
    /** Marks a run and a place of it, and says it in words. @param {Mark | null} mark @param {boolean} chosen */
    mark(mark, chosen) {
      marked = mark && !hidden.has(mark.run) ? mark.run : null;
      pointed = mark && placeOf(mark);
      kept = chosen;
      draw();
      return pointed ? inWords(pointed) : marked ?? "";
    },
    draw,
  };
}
