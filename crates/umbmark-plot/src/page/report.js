"use strict";
(() => {
  const root = document.documentElement;
  root.classList.remove("no-js");
  const { figures, studies, tones } = JSON.parse(document.getElementById("data").textContent);
  const system = matchMedia("(prefers-color-scheme: dark)");
  const isDark = () => (root.dataset.theme ? root.dataset.theme === "dark" : system.matches);
  const hidden = studies.map(() => ({ directions: new Set(), runs: new Set() }));
  const words = (text) => text.replace(/&/g, "&amp;").replace(/</g, "&lt;").replace(/>/g, "&gt;");

  const isHidden = (study, run) => {
    const { directions, runs } = hidden[study];
    return runs.has(run) || directions.has(studies[study].runs[run].direction);
  };

  // Only these lists have one value a place.
  const perPlace = ["x", "y", "text", "customdata"];

  const filtered = (trace, study) => {
    if (hidden[study].directions.has(trace.meta.direction)) return { ...trace, visible: false };
    if (!trace.customdata) return trace;
    const kept = trace.customdata.flatMap((run, place) => (isHidden(study, run) ? [] : [place]));
    const copy = { ...trace };
    for (const list of perPlace) if (Array.isArray(trace[list])) copy[list] = kept.map((place) => trace[list][place]);
    return copy;
  };

  const named = (trace, study) => {
    if (!trace.customdata || trace.text) return trace;
    const text = trace.customdata.map((run) => words(studies[study].runs[run].name));
    return { ...trace, text, hovertemplate: "%{text}<br>%{x:.3~f}, %{y:.3~f}<extra>%{fullData.name}</extra>" };
  };

  const coloured = (trace) => {
    const dark = isDark();
    const colour = tones[trace.meta.tone][dark ? 1 : 0];
    const copy = { ...trace };
    if (copy.line) copy.line = { ...copy.line, color: colour };
    if (copy.marker) {
      const shades = trace.meta[dark ? "dark" : "light"];
      copy.marker = { ...copy.marker, color: shades ?? colour };
      if (copy.marker.line?.color) copy.marker.line = { ...copy.marker.line, color: colour };
    }
    if (copy.error_x) copy.error_x = { ...copy.error_x, color: colour };
    return copy;
  };

  const layoutOf = (figure, width) => {
    const style = getComputedStyle(root);
    const [ink, grid, soft, raised] = ["--ink", "--grid", "--soft", "--raised"].map((name) => style.getPropertyValue(name).trim());
    const size = Math.max(11, 0.78 * parseFloat(style.fontSize));
    const layout = { ...figure.layout, font: { ...figure.layout.font, color: ink, size } };
    // Figures grow with their letters.
    const grown = size / figure.layout.font.size;
    layout.height *= grown;
    layout.margin = Object.fromEntries(Object.entries(layout.margin).map(([side, room]) => [side, room * grown]));
    // In narrow figures there is no room for a title beside the buttons.
    const above = width < 480 && layout.annotations.length ? 2 * size : 0;
    layout.height += above;
    layout.margin.t += above;
    for (const axis of Object.keys(layout).filter((key) => /^[xy]axis/.test(key))) {
      layout[axis] = { ...layout[axis], gridcolor: grid, linecolor: soft };
    }
    layout.modebar = { bgcolor: "rgba(0,0,0,0)", color: soft, activecolor: ink };
    layout.hoverlabel = { bgcolor: raised, bordercolor: soft, font: { color: ink, size } };
    return layout;
  };

  const config = {
    responsive: true,
    displaylogo: false,
    // A closed list: some of the others send the data elsewhere.
    modeBarButtons: [["toImage", "zoom2d", "pan2d", "resetScale2d"]],
    toImageButtonOptions: { format: "svg" },
  };

  const draw = (plot) => {
    const figure = figures[plot.id];
    const layout = layoutOf(figure, plot.clientWidth);
    plot.style.height = `${layout.height}px`;
    const traces = figure.data.map((trace) => coloured(filtered(named(trace, figure.study), figure.study)));
    return Plotly.react(plot, traces, layout, config).then(() => { plot.dataset.drawn = "1"; });
  };

  const redraw = () => document.querySelectorAll(".plot[data-drawn]").forEach(draw);

  // A figure is drawn when it comes near.
  const near = new IntersectionObserver((entries) => {
    for (const entry of entries.filter((entry) => entry.isIntersecting)) {
      near.unobserve(entry.target);
      draw(entry.target);
    }
  }, { rootMargin: "600px" });
  document.querySelectorAll(".plot").forEach((plot) => near.observe(plot));

  for (const fieldset of document.querySelectorAll("fieldset[data-study]")) {
    const own = hidden[Number(fieldset.dataset.study)];
    fieldset.addEventListener("change", (event) => {
      const { name, value, checked } = event.target;
      const set = name === "direction" ? own.directions : own.runs;
      const key = name === "direction" ? value : Number(value);
      if (checked) set.delete(key); else set.add(key);
      redraw();
    });
    for (const button of fieldset.querySelectorAll("button[data-all]")) {
      button.addEventListener("click", () => {
        own.runs.clear();
        for (const box of fieldset.querySelectorAll("input[name=run]")) {
          box.checked = Boolean(button.dataset.all);
          if (!box.checked) own.runs.add(Number(box.value));
        }
        redraw();
      });
    }
  }
  document.getElementById("theme").addEventListener("click", () => {
    root.dataset.theme = isDark() ? "light" : "dark";
    redraw();
  });
  system.addEventListener("change", redraw);
})();
