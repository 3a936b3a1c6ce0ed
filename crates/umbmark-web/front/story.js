// @ts-check
// The story so far: each step with the error that it leaves out, and the way back to it.

import { breaks, degrees, h, mm, pText } from "./elements.js";

/** The error that counts: of held-out runs, once something was fitted. @param {any} errors */
export const leaves = (errors) => errors.heldout_rmse_m ?? errors.rmse_m;

/** @param {{ act: (act: any) => Promise<void> }} page */
export function storyPart(page) {
  const list = h("ol", { class: "steps", id: "story" });
  const says = h("p", { id: "falls", role: "status" });
  const far = h("ol", { class: "steps", id: "reached" });
  const so = h("div", { hidden: true, role: "status" }, h("h3", {}, "What Learn has found so far"), far);
  const root = h("section", { class: "card story", "aria-label": "The story so far" }, h("h2", {}, "The story so far"),
    h("p", { class: "hint" }, "The bar is the cross-validated error: the root mean square error in runs that were left out of the fit."), list, says, so);

  /** @param {any} state */
  function show(state) {
    const all = [...state.steps.map((/** @type {any} */ step) => step.errors), state.draft?.errors].filter(Boolean);
    const most = Math.max(1e-9, ...all.map((errors) => leaves(errors) ?? 0));
    const bar = (/** @type {any} */ errors) => h("span", { class: "bar", "aria-hidden": "true" }, h("span", { style: `width: ${(100 * (leaves(errors) ?? 0)) / most}%` }));
    const line = (/** @type {any} */ step) => [
      h("span", {}, breaks(step.words)),
      h("span", { class: "value", title: degrees(step.errors.heldout_heading_rmse_rad) }, mm(leaves(step.errors))),
      bar(step.errors),
      step.learnt || step.p_adjusted !== null ? h("span", { class: "hint" }, [step.learnt ? "by learn" : "", pText(step.p_adjusted)].filter(Boolean).join(", ")) : null,
    ];
    const rows = state.steps.map((/** @type {any} */ step, /** @type {number} */ index) => h("li", {}, h("button", {
      type: "button", "aria-current": index === state.at ? "step" : null, class: index > state.at ? "later" : "", "data-step": index,
      onclick: () => page.act({ act: "goto", step: index }),
    }, line(step))));
    if (state.draft) {
      const { draft } = state;
      const row = h("li", { class: "draft", id: "draft" }, h("span", {}, breaks(draft.words), h("span", { class: "hint" }, draft.fitted ? " fitted, not accepted" : " not fitted")), h("span", { class: "value" }, mm(leaves(draft.errors))), bar(draft.errors));
      rows.splice(state.at + 1, 0, row);
    }
    list.replaceChildren(...rows);
    says.className = "";
    says.textContent = "";
    const now = state.draft ?? (state.at > 0 ? state.steps[state.at] : null);
    const before = state.draft ? state.steps[state.at] : state.steps[state.at - 1];
    if (!now || !before) return;
    const [was, is] = [leaves(before.errors), leaves(now.errors)];
    if (state.draft && !state.draft.fitted) says.textContent = `With these values the error is ${mm(is)}. Fit finds the best values.`;
    else if (is < was) { says.className = "falls"; says.textContent = `▼ The cross-validated error falls from ${mm(was)} to ${mm(is)}.`; }
    else { says.className = "rises"; says.textContent = `▲ The cross-validated error does not fall: ${mm(was)} before, ${mm(is)} now.`; }
  }
  /** Steps that learn has reached and may still take back; its end makes them the story. @param {any[]} steps */
  function reached(steps) {
    const most = Math.max(1e-9, ...steps.map((step) => leaves(step)));
    so.hidden = !steps.length;
    far.replaceChildren(...steps.map((step) => h("li", { class: "draft" },
      h("span", {}, breaks(step.added ? `+ ${step.added}` : "nominal robot")), h("span", { class: "value" }, mm(leaves(step))),
      h("span", { class: "bar", "aria-hidden": "true" }, h("span", { style: `width: ${(100 * leaves(step)) / most}%` })),
      h("span", { class: "hint" }, pText(step.p_adjusted)))));
  }
  return { root, show, reached };
}
