// @ts-check
// The figures of the report, of the model that is looked at. A run that is pointed at in one is marked in all.

import { colours, h } from "./elements.js";
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

/** @param {{ mark: (name: string | null) => void, catalogue: any }} page */
export function figuresPart(page) {
  const names = page.catalogue.figures;
  const root = h("div", { class: "two" });
  /** @type {Set<string>} */ let hidden = new Set();
  const cards = ["residuals_along", "return_errors", "residuals_by_move", "parameters"].map((name, index) => {
    const choice = h("select", { id: `figure-${index}` }, names.map((/** @type {any} */ f) => h("option", { value: f.name, selected: f.name === name }, f.about)));
    const plot = h("div", { class: "plot", role: "group", "aria-label": "No figure yet" });
    const says = h("p", {});
    const legend = h("ul", { class: "legend" });
    const table = h("details", {});
    const card = { choice, plot, says, legend, table, told: /** @type {any} */ (null), key: "" };
    choice.addEventListener("change", () => load(card));
    root.append(h("section", { class: "card" }, h("label", { class: "small", for: choice.id }, "Figure "), choice, h("div", { class: "scroll" }, plot), legend, says, table));
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
      card.plot.replaceChildren();
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
      plot.on("plotly_hover", (/** @type {any} */ event) => mark(card.told?.runs[event.points[0]?.customdata] ?? null));
      plot.on("plotly_unhover", () => mark(null));
    }
    card.says.textContent = told.told.says;
    card.legend.replaceChildren(...told.legend.map((/** @type {string[]} */ [words, tone, form]) => h("li", {}, h("span", { class: `mark ${form}`, style: `--tone: var(--${tone})` }), words)));
    card.table.replaceChildren(h("summary", {}, "As numbers"), h("p", { class: "small" }, told.told.shows), h("p", { class: "small" }, `Good: ${told.told.good}`), h("div", { class: "scroll" }, h("table", {},
      h("thead", {}, h("tr", {}, told.table.header.map((/** @type {string} */ w) => h("th", { scope: "col" }, w)))), h("tbody", {}, told.table.rows.map((/** @type {string[]} */ row) => h("tr", {}, row.map((cell) => h("td", {}, cell))))))));
  }

  const isDark = () => {
    const theme = document.documentElement.dataset.theme;
    return theme ? theme === "dark" : matchMedia("(prefers-color-scheme: dark)").matches;
  };

  /** Marks a run in every figure. @param {string | null} name */
  async function mark(name) {
    page.mark(name);
    const Plotly = await plotly();
    for (const card of cards.filter((one) => one.told)) {
      const changed = card.told.plot.data.map((/** @type {any} */ trace, /** @type {number} */ i) => ({ trace, i })).filter((/** @type {any} */ { trace }) => trace.customdata && trace.mode === "markers" && trace.marker);
      for (const { trace, i } of changed) {
        const size = trace.customdata.map((/** @type {number} */ run) => (card.told.runs[run] === name ? 2 : 1) * trace.marker.size);
        Plotly.restyle(card.plot, { "marker.size": [name === null ? trace.marker.size : size] }, [i]);
      }
    }
  }

  return {
    root,
    mark,
    /** @param {string} model @param {string[]} gone */
    show(model, gone) {
      const fresh = key !== model;
      const other = gone.join("\n") !== [...hidden].join("\n");
      hidden = new Set(gone);
      key = model;
      if (!visible) return;
      for (const card of cards) if (fresh || card.key !== `${key} ${card.choice.value}`) load(card); else if (other) draw(card);
    },
    /** @param {boolean} now */
    seen(now) {
      visible = now;
      if (now && key) for (const card of cards) if (card.key !== `${key} ${card.choice.value}`) load(card);
    },
    redraw() { if (visible) cards.forEach(draw); },
  };
}
