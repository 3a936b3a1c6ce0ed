// @ts-check
// The figures of the report, of the model that is looked at. What is pointed at in one is marked in all: its run, and its place.

import { colours, h } from "./elements.js";
import { nearest } from "./marks.js";
import { get, query } from "./server.js";

/** @type {Promise<any> | null} */
let library = null;
const plotly = () => {
  library ??= new Promise((take, fail) => {
    const script = document.createElement("script");
    script.src = "plotly.js";
    script.onload = () => take(/** @type {any} */ (window).Plotly);
    script.onerror = () => fail(new Error("The drawing library could not be loaded."));
    document.head.append(script);
  });
  return library;
};

/** @typedef {import("./marks.js").Mark} Mark */

const HINT = "Point at a place of a run: it is marked in all figures and in the drive. A click keeps the mark, Escape or a second click clears it.";

/** @param {{ point: (mark: Mark | null) => void, toggle: (mark: Mark) => void, catalogue: any }} page */
export function figuresPart(page) {
  const names = page.catalogue.figures;
  const grid = h("div", { class: "two" });
  const marked = h("p", { class: "hint", id: "marked", role: "status" }, HINT);
  const root = h("div", {}, marked, grid);
  /** @type {Set<string>} */ let hidden = new Set();
  const cards = ["residuals_along", "return_errors", "residuals_by_move", "parameters"].map((name, index) => {
    const choice = h("select", { id: `figure-${index}` }, names.map((/** @type {any} */ f) => h("option", { value: f.name, selected: f.name === name }, f.about)));
    const plot = h("div", { class: "plot", role: "group", "aria-label": "No figure yet" });
    const rings = h("div", { class: "rings", "aria-hidden": "true" });
    const says = h("p", {});
    const legend = h("ul", { class: "legend" });
    const table = h("details", {});
    const card = { choice, plot, rings, says, legend, table, told: /** @type {any} */ (null), key: "" };
    choice.addEventListener("change", () => load(card));
    grid.append(h("section", { class: "card" }, h("label", { class: "small", for: choice.id }, "Figure "), choice, h("div", { class: "scroll" }, h("div", { class: "frame" }, plot, rings)), legend, says, table));
    return card;
  });
  let key = "";
  let visible = false;

  /** @param {any} card */
  async function load(card) {
    const name = card.choice.value;
    card.key = `${key} ${name}`;
    const own = card.key;
    card.says.textContent = "Working it out…";
    try {
      const told = await get(`api/figure?${query({ name })}`);
      if (card.key !== own) return;
      if (told.absent) throw new Error(told.absent);
      card.told = told;
      await draw(card);
    } catch (error) {
      if (card.key !== own) return;
      card.told = null;
      drop(card);
      card.legend.replaceChildren();
      card.table.replaceChildren();
      card.says.textContent = /** @type {Error} */ (error).message;
    }
  }

  /** @param {any} card */
  async function draw(card) {
    if (!card.told) return;
    const Plotly = await plotly();
    const { told, plot } = card;
    const c = colours(["ink", "grid", "soft", "raised", ...new Set(told.plot.data.map((/** @type {any} */ t) => t.meta.tone))]);
    const traces = told.plot.data.map((/** @type {any} */ trace) => {
      const copy = { ...trace };
      const colour = c[trace.meta.tone];
      if (copy.line) copy.line = { ...copy.line, color: colour };
      if (copy.marker) copy.marker = { ...copy.marker, color: trace.meta[isDark() ? "dark" : "light"] ?? colour, ...(copy.marker.line?.color ? { line: { ...copy.marker.line, color: colour } } : {}) };
      if (copy.error_x) copy.error_x = { ...copy.error_x, color: colour };
      if (copy.customdata) {
        const gone = (/** @type {number} */ run) => hidden.has(told.runs[run]);
        copy.y = copy.y.map((/** @type {any} */ y, /** @type {number} */ i) => (gone(copy.customdata[i]) ? null : y));
        copy.text ??= copy.customdata.map((/** @type {number} */ run) => told.runs[run]);
        copy.hovertemplate ??= "%{text}<extra></extra>";
      }
      return copy;
    });
    const size = Math.max(11, 0.78 * parseFloat(getComputedStyle(document.documentElement).fontSize));
    const layout = { ...told.plot.layout, font: { ...told.plot.layout.font, color: c.ink, size }, modebar: { bgcolor: "rgba(0,0,0,0)", color: c.soft, activecolor: c.ink }, hoverlabel: { bgcolor: c.raised, font: { color: c.ink, size } } };
    // Figures grow with their letters; in narrow ones there is no room for a title beside the buttons.
    const grown = size / told.plot.layout.font.size;
    const above = plot.clientWidth < 480 && layout.annotations.length ? 2 * size : 0;
    layout.height = layout.height * grown + above;
    layout.margin = Object.fromEntries(Object.entries(layout.margin).map(([side, room]) => [side, room * grown + (side === "t" ? above : 0)]));
    for (const axis of Object.keys(layout).filter((name) => /^[xy]axis/.test(name))) layout[axis] = { ...layout[axis], gridcolor: c.grid, linecolor: c.soft };
    plot.style.height = `${layout.height}px`;
    plot.setAttribute("aria-label", `${told.title}: ${told.told.says}`);
    await Plotly.react(plot, traces, layout, { responsive: true, displaylogo: false, modeBarButtons: [["toImage", "zoom2d", "pan2d", "resetScale2d"]], toImageButtonOptions: { format: "svg" } });
    if (!plot.dataset.bound) {
      plot.dataset.bound = "1";
      plot.on("plotly_hover", (/** @type {any} */ event) => page.point(markOf(card, event)));
      plot.on("plotly_unhover", () => page.point(null));
      plot.on("plotly_click", (/** @type {any} */ event) => { const found = markOf(card, event); if (found) page.toggle(found); });
      plot.on("plotly_afterplot", () => ring(card));
      plot.on("plotly_relayout", () => ring(card));
    }
    grow(card);
    ring(card);
    card.says.textContent = told.told.says;
    card.legend.replaceChildren(...told.legend.map((/** @type {string[]} */ [words, tone, form]) => h("li", {}, h("span", { class: `mark ${form}`, style: `--tone: var(--${tone})` }), words)));
    card.table.replaceChildren(h("summary", {}, "As numbers"), h("p", { class: "small" }, told.told.shows), h("p", { class: "small" }, `Good: ${told.told.good}`), h("div", { class: "scroll" }, h("table", {},
      h("thead", {}, h("tr", {}, told.table.header.map((/** @type {string} */ w) => h("th", { scope: "col" }, w)))), h("tbody", {}, told.table.rows.map((/** @type {string[]} */ row) => h("tr", {}, row.map((cell) => h("td", {}, cell))))))));
  }

  const isDark = () => {
    const theme = document.documentElement.dataset.theme;
    return theme ? theme === "dark" : matchMedia("(prefers-color-scheme: dark)").matches;
  };

  /** @type {Mark | null} */ let now = null;

  /** What an event of a figure points at. @param {any} card @param {any} event @returns {Mark | null} */
  function markOf(card, event) {
    const point = event.points[0];
    const run = card.told?.runs[point?.customdata];
    if (run === undefined) return null;
    // The points of a figure without places are the ends of runs.
    const rolled = card.told.rolled[point.curveNumber];
    return { run, rolled: rolled.length ? rolled[point.pointNumber] : Infinity };
  }

  /** Draws the dots of the run that is marked larger. @param {any} card */
  async function grow(card) {
    const Plotly = await plotly();
    if (!card.told) return;
    card.told.plot.data.forEach((/** @type {any} */ trace, /** @type {number} */ i) => {
      if (!trace.customdata || trace.mode !== "markers" || !trace.marker) return;
      const sizes = trace.customdata.map((/** @type {number} */ run) => (card.told.runs[run] === now?.run ? 2 : 1) * trace.marker.size);
      Plotly.restyle(card.plot, { "marker.size": [sizes.some((/** @type {number} */ size) => size !== trace.marker.size) ? sizes : trace.marker.size] }, [i]);
    });
  }

  /** Puts a ring about the nearest place of each trace that has places of the marked run. @param {any} card */
  function ring(card) {
    const axes = card.plot._fullLayout;
    const at = now?.rolled ?? null;
    /** @type {any[]} */ const rings = [];
    if (now && card.told && axes && at !== null && !hidden.has(now.run)) {
      const run = card.told.runs.indexOf(now.run);
      card.told.plot.data.forEach((/** @type {any} */ trace, /** @type {number} */ i) => {
        const index = nearest(card.told.rolled[i], at, (k) => trace.customdata[k] === run && trace.x[k] !== null && trace.y[k] !== null);
        if (index < 0) return;
        const [x, y] = ["x", "y"].map((name) => {
          const axis = axes[name + "axis" + (trace[name + "axis"] ?? name).slice(1)];
          const along = axis.l2p(trace[name][index]);
          return along >= 0 && along <= axis._length ? axis._offset + along : NaN;
        });
        if (Number.isFinite(x + y)) rings.push(h("span", { class: "ring", style: `left: ${x}px; top: ${y}px`, "data-trace": i, "data-place": index }));
      });
    }
    card.rings.replaceChildren(...rings);
  }

  /** Takes a figure away. @param {any} card */
  function drop(card) {
    /** @type {any} */ (window).Plotly?.purge(card.plot);
    delete card.plot.dataset.bound;
    card.plot.replaceChildren();
    card.plot.style.height = "";
    card.plot.setAttribute("aria-label", "No figure");
    card.rings.replaceChildren();
  }

  /** Marks a run and a place of it in every figure. @param {Mark | null} mark @param {string} words @param {boolean} chosen */
  function show(mark, words, chosen) {
    const other = mark?.run !== now?.run;
    now = mark;
    const told = chosen ? `Chosen: ${words}. A second click or Escape clears it.` : mark ? `${words}. A click keeps the mark.` : HINT;
    if (marked.textContent !== told) marked.textContent = told;
    if (!visible) return;
    for (const card of cards) { if (other) grow(card); ring(card); }
  }

  return {
    root,
    mark: show,
    /** @param {string} model @param {string[]} gone */
    show(model, gone) {
      const fresh = key !== model;
      const other = gone.join("\n") !== [...hidden].join("\n");
      hidden = new Set(gone);
      key = model;
      if (!visible) return;
      for (const card of cards) if (fresh || card.key !== `${key} ${card.choice.value}`) load(card); else if (other) draw(card);
    },
    /** @param {boolean} seen */
    seen(seen) {
      visible = seen;
      if (seen && key) for (const card of cards) if (card.key !== `${key} ${card.choice.value}`) load(card); else { grow(card); ring(card); }
    },
    redraw() { if (visible) cards.forEach(draw); },
  };
}
