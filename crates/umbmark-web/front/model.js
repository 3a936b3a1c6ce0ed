// @ts-check
// The model as a list, its numbers on sliders, what is suggested, the catalogue and laws of one's own.

import { breaks, h, mm, pText, plain } from "./elements.js";
import { leaves } from "./story.js";
import { post } from "./server.js";

const VERDICTS = /** @type {Record<string, string>} */ ({
  explained: "Explained: the model accounts for the measured error, and no test shows a further effect.",
  missing_effect: "The robot has an error source that the model lacks.",
  several_missing: "The robot has several error sources that the model lacks.",
  unlisted_effect: "The robot has an error source that no single effect of the catalogue explains.",
  not_explained: "Not explained: the model does not account for the measured error, but no single missing effect is certified.",
  not_enough_data: "Not enough data to test the model.",
});
/** Suggestions that are shown. */
const SHOWN = 8;

/**
 * @param {{ act: (act: any) => Promise<void>, job: (kind: string, what?: any) => Promise<void>, drag: (values: any) => void, fail: (error: Error) => void, catalogue: any }} page
 */
export function modelPart(page) {
  const list = h("div", { id: "parts" });
  const error = h("p", { id: "error", role: "status" });
  const button = (/** @type {string} */ id, /** @type {string} */ words, /** @type {() => any} */ does, main = false) => h("button", { type: "button", id, class: main ? "main" : "", onclick: does }, words);
  const first = button("first", "Add wheels and wheelbase", () => page.act({ act: "first" }), true);
  const fit = button("fit", "Fit", () => page.job("fit"));
  const accept = button("accept", "Accept", () => page.act({ act: "accept" }));
  const undo = button("undo", "Undo", () => page.act({ act: "undo" }));
  const ask = button("diagnose", "What is missing?", () => page.job("diagnose"));
  const learn = button("learn", "Learn", () => page.job("learn"));
  const others = h("input", { type: "checkbox", id: "fit-others", checked: true });
  const othersBox = h("p", { class: "small" }, h("label", {}, others, " Fit the other numbers when a slider is released"));
  const suggestions = h("div", { id: "suggestions" });
  const unfit = h("p", { class: "notice bad", hidden: true });

  const filter = h("input", { id: "effect", list: "effects", placeholder: "type a word" });
  const about = h("div", { id: "about" });
  const names = h("datalist", { id: "effects" }, page.catalogue.effects.map((/** @type {any} */ e) => h("option", { value: e.name }, e.title)));
  const chosen = () => page.catalogue.effects.find((/** @type {any} */ e) => e.name === filter.value.trim() || e.title === filter.value.trim());
  const add = h("button", { type: "button", id: "add", disabled: true, onclick: () => page.act({ act: "add", effect: chosen().name }) }, "Add");
  filter.addEventListener("input", () => {
    const effect = chosen();
    add.disabled = !effect;
    about.replaceChildren(...(effect ? [h("h3", {}, effect.title), h("p", {}, h("code", {}, effect.equation)), h("p", { class: "small" }, effect.physics), h("p", { class: "small" }, effect.signature)] : []));
  });

  const law = {
    name: h("input", { id: "law-name", value: "my_law" }),
    acts: h("select", { id: "law-acts" }, page.catalogue.acts_on.map((/** @type {string} */ name) => h("option", { value: name }, name))),
    text: h("input", { id: "law-text", list: "law-words", placeholder: "k * sin(heading)", autocomplete: "off", spellcheck: "false", "aria-describedby": "law-says" }),
    parameters: h("input", { id: "law-parameters", value: "k = 0", "aria-describedby": "law-says" }),
    says: h("p", { class: "small", id: "law-says", role: "status" }),
    add: h("button", { type: "button", id: "law-add", disabled: true, onclick: () => page.act({ act: "formula", ...lawNow() }) }, "Add the law"),
  };
  const words = h("datalist", { id: "law-words" });
  const functions = ["sin", "cos", "tan", "exp", "log", "sqrt", "abs", "sign", "min", "max", "tanh"];

  function lawNow() {
    /** @type {Record<string, number>} */ const parameters = {};
    for (const part of law.parameters.value.split(/[;,]/).filter((/** @type {string} */ p) => p.trim())) {
      const [name, value] = part.split("=").map((/** @type {string} */ word) => word.trim());
      parameters[name] = value === undefined || value === "" ? 0 : Number(value);
      if (!Number.isFinite(parameters[name])) throw new Error(`${name}: "${value}" is no number`);
    }
    return { name: law.name.value.trim(), acts_on: law.acts.value, formula: law.text.value, parameters };
  }
  let asked = 0;
  async function check() {
    const own = (asked += 1);
    const typed = law.text.value;
    const [, begun, part] = /^(.*?)([A-Za-z_]*)$/s.exec(typed) ?? [];
    const offered = [...page.catalogue.variables.map((/** @type {any} */ v) => v.name), ...functions.map((f) => `${f}(`)];
    words.replaceChildren(...offered.filter((word) => part && word.startsWith(part)).map((word) => h("option", { value: begun + word })));
    if (!typed.trim()) { law.says.textContent = ""; law.add.disabled = true; return; }
    try {
      await post("api/formula", lawNow());
      if (own !== asked) return;
      law.says.textContent = "The units agree; it can be added.";
      law.says.className = "small falls";
      law.text.removeAttribute("aria-invalid");
      law.add.disabled = false;
    } catch (wrong) {
      if (own !== asked) return;
      law.says.textContent = /** @type {Error} */ (wrong).message;
      law.says.className = "small rises";
      law.text.setAttribute("aria-invalid", "true");
      law.add.disabled = true;
    }
  }
  for (const input of [law.name, law.acts, law.text, law.parameters]) input.addEventListener("input", check);

  const root = h("div", {},
    h("section", { class: "card", "aria-label": "The model" }, h("h2", {}, "The model"), unfit, h("div", { class: "buttons" }, first, fit, accept, undo, ask, learn), error, othersBox, list),
    h("section", { class: "card", "aria-label": "What is missing" }, h("h2", {}, "What is missing?"), suggestions),
    h("section", { class: "card", "aria-label": "Add an effect" }, h("h2", {}, "Add an effect"),
      h("label", { for: "effect" }, "From the catalogue "), h("div", { class: "buttons" }, filter, add), names, about,
      h("details", { id: "own-law" }, h("summary", {}, "A law of my own"), h("div", { class: "formula" },
        h("label", {}, "name", law.name), h("label", {}, "acts on", law.acts), h("label", {}, "formula", law.text), h("label", {}, "parameters with start values", law.parameters), words, law.says, law.add,
        h("p", { class: "hint" }, `It may depend on: ${page.catalogue.variables.map((/** @type {any} */ v) => `${v.name}${v.unit ? ` [${v.unit}]` : ""}`).join(", ")}.`)))));

  /** @type {Record<string, Record<string, number>>} */ let values = {};
  /** What was shown last: the work, and whether something runs. @type {[any, boolean] | null} */ let last = null;
  /** Whether a slider is in the hand, or was just moved by a key: it must not be replaced then. */
  let [grasped, settling] = [false, 0];
  /** A number that was moved while something ran. @type {(() => void) | null} */ let waiting = null;
  list.addEventListener("pointerdown", (/** @type {any} */ event) => { grasped = event.target.type === "range"; });
  for (const name of ["pointerup", "pointercancel"]) window.addEventListener(name, () => { if (grasped) { grasped = false; setTimeout(again); } });
  function again() { if (last) show(...last); }

  /** Sets a number, and fits the others where that is wished and there are any. @param {string} effect @param {string} parameter @param {number} value */
  function moved(effect, parameter, value) {
    if (last?.[1]) { waiting = () => moved(effect, parameter, value); return; }
    // What the server refuses is drawn as it was.
    drawn = "";
    const free = (/** @type {any} */ part) => part.free && part.numbers.some((/** @type {any} */ n) => (!n.fixed || n.held) && !(part.effect === effect && n.name === parameter));
    if (others.checked && last?.[0].model.some(free)) page.job("hold", { effect, parameter, value });
    else page.act({ act: "set", effect, parameter, value });
  }

  /** @param {any} number @param {any} part */
  function slider(number, part) {
    const { effect } = part;
    const id = `n-${effect}-${number.name}`;
    const reach = 5 * (number.typical || 1);
    const clamp = (/** @type {number} */ v) => Math.min(number.bounds[1] ?? Infinity, Math.max(number.bounds[0] ?? -Infinity, v));
    const middle = number.default;
    const [low, high] = [clamp(Math.min(middle - reach, number.value - reach / 5)), clamp(Math.max(middle + reach, number.value + reach / 5))];
    const box = h("input", { id, type: "number", step: "any", value: plain(number.value), "data-effect": effect, "data-parameter": number.name });
    const range = h("input", { type: "range", id: `r-${effect}-${number.name}`, min: low, max: high, step: (high - low) / 1000, value: number.value, "aria-label": `${number.name} of ${effect}` });
    const dragged = (/** @type {number} */ value) => { values = { [effect]: { [number.name]: value } }; page.drag(values); };
    range.addEventListener("input", () => { box.value = plain(Number(range.value)); dragged(Number(range.value)); });
    let byKey = false;
    range.addEventListener("pointerdown", () => { byKey = false; });
    range.addEventListener("keydown", () => { byKey = true; });
    range.addEventListener("change", () => {
      // Keys move it step by step: the last one counts.
      clearTimeout(settling);
      const release = () => { settling = 0; moved(effect, number.name, Number(plain(Number(range.value)))); };
      if (byKey) settling = setTimeout(release, 400); else release();
    });
    box.addEventListener("change", () => {
      const value = Number(box.value);
      if (box.value === "" || !Number.isFinite(value)) { box.setAttribute("aria-invalid", "true"); return; }
      moved(effect, number.name, value);
    });
    // Of an effect with one number, "fit" says the same.
    const holds = part.numbers.length > 1 || (number.fixed && !number.held);
    const unit = number.unit ? ` [${number.unit}]` : "";
    const hold = h("label", { class: "small" }, h("input", { type: "checkbox", id: `h-${effect}-${number.name}`, "aria-label": `hold ${number.name} of ${effect}`, checked: number.fixed && !number.held, onchange: (/** @type {any} */ e) => page.act({ act: "hold", effect, parameter: number.name, hold: e.target.checked }) }), " hold");
    return h("div", { class: "number" }, h("label", { for: id, title: number.meaning }, breaks(number.name), unit), box, number.choices.length ? null : range,
      part.free && (holds || number.held) ? h("div", { class: "held" }, holds ? hold : null, number.held ? h("span", { class: "small" }, "held while the others were fitted") : null) : null);
  }

  /** What was drawn last, so that a slider in the hand is not taken away. */
  let drawn = "";

  /** @param {any} bench @param {boolean} busy */
  function show(bench, busy) {
    last = [bench, busy];
    if (!busy && waiting) { const next = waiting; waiting = null; next(); }
    const { state, model, found } = bench;
    unfit.hidden = !bench.unfit;
    unfit.textContent = bench.unfit ?? "";
    const now = state.draft ?? state.steps[state.at];
    error.textContent = state.draft && !state.draft.fitted ? `Error with these values: ${mm(now.errors.rmse_m)}` : `Error in the fitted runs: ${mm(now.errors.rmse_m)}; in runs left out of the fit: ${mm(now.errors.heldout_rmse_m)}`;
    first.hidden = model.length > 0;
    fit.disabled = busy || Boolean(bench.unfit) || !model.some((/** @type {any} */ part) => part.free);
    accept.disabled = busy || !state.draft;
    undo.disabled = busy || (!state.draft && state.at === 0);
    [ask, learn, first].forEach((one) => { one.disabled = busy || Boolean(bench.unfit); });
    fit.className = state.draft && !state.draft.fitted ? "main" : "";
    accept.className = state.draft?.fitted ? "main" : "";
    othersBox.hidden = !model.length;
    const key = JSON.stringify(model);
    if (key !== drawn && !grasped && !settling) {
      drawn = key;
      const focus = document.activeElement?.id;
      list.replaceChildren(...(model.length ? model.map((/** @type {any} */ part) => h("div", { class: "part", "data-part": part.effect },
        h("header", {}, h("strong", {}, breaks(part.effect)), h("span", {},
          h("label", { class: "small" }, h("input", { type: "checkbox", id: `f-${part.effect}`, "aria-label": `fit ${part.effect}`, checked: part.free, onchange: (/** @type {any} */ e) => page.act({ act: "free", effect: part.effect, free: e.target.checked }) }), " fit "),
          h("button", { type: "button", "aria-label": `Remove ${part.effect}`, onclick: () => page.act({ act: "remove", effect: part.effect }) }, "×"))),
        part.formula ? h("code", {}, `${part.formula.acts_on} = ${part.formula.text}`) : null,
        part.numbers.map((/** @type {any} */ number) => slider(number, part)),
        part.meaning ? h("p", { class: "small" }, part.meaning) : null)) : [h("p", { class: "hint" }, "The nominal robot: nothing is added, and the numbers of its software are used.")]));
      if (focus) document.getElementById(focus)?.focus();
    }
    suggest(found, now, busy);
  }

  /** @param {any} found @param {any} now @param {boolean} busy */
  function suggest(found, now, busy) {
    if (!found) {
      suggestions.replaceChildren(h("p", { class: "hint" }, "\"What is missing?\" tests every effect of the catalogue against this model."));
      return;
    }
    const { diagnosis, worth } = found;
    const row = (/** @type {any} */ suspect, /** @type {number} */ index) => {
      const left = worth[suspect.best]?.heldout_rmse_m;
      const values = Object.fromEntries(Object.entries(suspect.estimate));
      const certain = index < diagnosis.certified;
      return h("div", { class: "suggestion", "data-suspect": suspect.best },
        h("div", {}, h(certain ? "strong" : "span", {}, suspect.class.join(" or ")), h("div", { class: "small" }, `${pText(suspect.p_adjusted)}${certain ? ", certified" : ""}`, left !== undefined && left !== null ? `; would leave ${mm(left)} instead of ${mm(leaves(now.errors))}` : ""),
          suspect.meaning ? h("div", { class: "small" }, suspect.meaning) : null),
        h("button", { type: "button", disabled: busy, "aria-label": `Add ${suspect.best}`, onclick: () => page.act({ act: "add", effect: suspect.best, values, p: suspect.p_adjusted }) }, "Add"));
    };
    suggestions.replaceChildren(
      h("p", { id: "verdict", class: `notice ${diagnosis.verdict === "explained" ? "good" : ""}` }, VERDICTS[diagnosis.verdict] ?? diagnosis.verdict),
      ...(diagnosis.reasons ?? []).map((/** @type {any} */ reason) => h("p", { class: "small" }, typeof reason === "string" ? reason : reason.sentence ?? "")),
      ...diagnosis.ranking.slice(0, SHOWN).map(row));
  }

  return { root, show, error: (/** @type {number | null | undefined} */ metres) => { error.textContent = `Error with these values: ${mm(metres)}`; } };
}
