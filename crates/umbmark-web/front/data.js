// @ts-check
// The data: dropped files, typed returns, the plate of the robot, and what inspect finds.

import { h } from "./elements.js";
import { get, post, query, send } from "./server.js";

/** @param {any} entry @param {string} path @returns {Promise<[string, File][]>} */
async function walk(entry, path) {
  if (entry.isFile) {
    const file = await new Promise((take, fail) => entry.file(take, fail));
    return [[path + entry.name, file]];
  }
  const reader = entry.createReader();
  const found = [];
  for (;;) {
    const some = await new Promise((take, fail) => reader.readEntries(take, fail));
    if (!some.length) break;
    for (const one of some) found.push(...(await walk(one, `${path}${entry.name}/`)));
  }
  return found;
}

/**
 * @param {{ say: (words: string) => void, fail: (error: Error) => void, refresh: () => Promise<void>, work: () => void, catalogue: any }} page
 */
export function dataPart(page) {
  const area = h("div", { class: "drop", id: "drop" },
    h("p", {}, "Drop a log or a folder of logs here: CSV, MCAP, a bag of ROS 1 or 2, a return sheet, or a dataset folder."),
    h("div", { class: "buttons", style: "justify-content: center" },
      h("label", { class: "small" }, "Files ", h("input", { type: "file", multiple: true, id: "files", onchange: (/** @type {any} */ e) => take([...e.target.files].map((f) => [f.name, f])) })),
      h("label", { class: "small" }, "Folder ", h("input", { type: "file", webkitdirectory: true, id: "folder", onchange: (/** @type {any} */ e) => take([...e.target.files].map((f) => [f.webkitRelativePath, f])) }))),
    h("p", { class: "hint" }, "They stay on this machine: the server runs here and answers this page only."));
  const plate = h("div", { id: "plate" });
  const found = h("div", { id: "inspection" });
  const typed = h("div", {});
  const root = h("div", { class: "two" }, h("div", {}, h("section", { class: "card" }, h("h2", {}, "Open data"), area, plate), typed), found);

  area.addEventListener("dragover", (/** @type {DragEvent} */ event) => { event.preventDefault(); area.classList.add("over"); });
  area.addEventListener("dragleave", () => area.classList.remove("over"));
  area.addEventListener("drop", async (/** @type {DragEvent} */ event) => {
    event.preventDefault();
    area.classList.remove("over");
    const entries = [...(event.dataTransfer?.items ?? [])].map((item) => /** @type {any} */ (item).webkitGetAsEntry?.()).filter(Boolean);
    try {
      if (entries.length) take((await Promise.all(entries.map((entry) => walk(entry, "")))).flat());
      else take([...(event.dataTransfer?.files ?? [])].map((file) => [file.name, file]));
    } catch (error) {
      page.fail(/** @type {Error} */ (error));
    }
  });

  /** @param {[string, File][]} files */
  async function take(files) {
    const seen = files.filter(([name]) => !name.split("/").some((part) => part.startsWith(".")));
    if (!seen.length) return;
    try {
      const first = seen[0][0].split("/")[0].replace(/[\\:*?"<>|]/g, "_");
      const { folder } = await post(`api/drop?${query({ name: first.replace(/\.[^.]*$/, "") || "drop" })}`);
      for (const [index, [name, file]] of seen.entries()) {
        page.say(`Reading ${index + 1} of ${seen.length}: ${name}`);
        await send(`api/file?${query({ to: folder, name })}`, file);
      }
      page.say("Opening");
      await opened(await post(`api/open?${query({ folder })}`));
    } catch (error) {
      page.fail(/** @type {Error} */ (error));
    }
  }

  /** @param {any} told */
  async function opened(told) {
    plate.replaceChildren();
    if (told.waiting) {
      page.say("");
      ask(told.waiting);
      return;
    }
    page.say("");
    await page.refresh();
    page.work();
  }

  /** The plate of the robot of logs that say nothing of it. @param {any} waiting */
  function ask(waiting) {
    const inputs = waiting.numbers.map((/** @type {any} */ number) => ({
      number,
      input: h("input", { id: `plate-${number.name}`, inputmode: "decimal", value: number.value ?? "" }),
    }));
    const says = h("p", { class: "mistake", role: "alert" });
    plate.replaceChildren(
      h("h3", {}, "The plate of the robot"),
      h("p", { class: "hint" }, "These logs say how the wheels turned, and not what the robot is. Type the values that its own software uses."),
      h("ul", { class: "small" }, waiting.logs.map((/** @type {any} */ log) => h("li", {}, `${log.file}: `, log.wheels ? `wheels by ${log.wheels.source}` : "no wheels", log.reference ? `, poses by ${log.reference.source}` : ", no poses"))),
      inputs.map((/** @type {any} */ { number, input }) => h("div", { class: "controls" }, h("label", { for: input.id }, number.name), input, h("span", { class: "small" }, number.unit),
        h("p", { class: "hint", style: "grid-column: 1 / -1" }, number.meaning, number.source ? `; ${number.source}` : ""))),
      says,
      h("button", { type: "button", class: "main", onclick: async () => {
        const numbers = [];
        for (const { number, input } of inputs) {
          const text = input.value.trim().replace(",", ".");
          input.removeAttribute("aria-invalid");
          if (text === "") continue;
          if (!Number.isFinite(Number(text))) {
            input.setAttribute("aria-invalid", "true");
            says.textContent = `${number.name}: "${text}" is no number`;
            return;
          }
          numbers.push([number.name, Number(text)]);
        }
        try {
          await opened(await post("api/plate", { numbers }));
        } catch (error) {
          says.textContent = /** @type {Error} */ (error).message;
        }
      } }, "Open with this robot"));
  }

  table(typed);

  /** @param {any} root */
  function table(root) {
    const numbers = [...page.catalogue.plate.filter((/** @type {any} */ p) => p.name !== "encoder_rate_hz"), { name: "side_m", unit: "m", meaning: "side of the square", usual: 4 }];
    const plateInputs = numbers.map((p) => h("input", { id: `typed-${p.name}`, inputmode: "decimal", value: p.usual ?? "" }));
    const rows = Array.from({ length: 10 }, (_, i) => [
      h("select", { "aria-label": `direction of return ${i + 1}` }, ["cw", "ccw"].map((d) => h("option", { value: d, selected: (i < 5 ? "cw" : "ccw") === d }, d))),
      ...["x in mm", "y in mm", "heading in degrees"].map((what) => h("input", { inputmode: "decimal", "aria-label": `${what} of return ${i + 1}` })),
    ]);
    const cell = (/** @type {any} */ input) => h("td", {}, input);
    const body = rows.map((row, i) => h("tr", {}, h("th", { scope: "row" }, i + 1), row.map(cell)));
    const name = h("input", { id: "typed-name", value: "my robot" });
    root.replaceChildren(h("details", { class: "card", id: "typed" }, h("summary", {}, "Type ten returns from a tape"),
      h("p", { class: "hint" }, "Drive the square five times each way. Measure where the robot stands, from where its odometry says it is: x along its heading at START, y to the left, heading counter-clockwise. A heading may be left empty."),
      h("div", { class: "controls" }, h("label", { for: "typed-name" }, "name"), name, ""),
      numbers.map((p, i) => h("div", { class: "controls" }, h("label", { for: `typed-${p.name}`, title: p.meaning }, p.name), h("div", {}, plateInputs[i]), h("span", { class: "small" }, p.unit))),
      h("div", { class: "scroll" }, h("table", { id: "returns" }, h("thead", {}, h("tr", {}, ["return", "direction", "x [mm]", "y [mm]", "heading [deg]"].map((word) => h("th", { scope: "col" }, word)))), h("tbody", {}, body))),
      h("div", { class: "buttons" }, h("button", { type: "button", class: "main", id: "open-typed", onclick: async () => {
        root.querySelectorAll(".mistake").forEach((/** @type {any} */ m) => m.remove());
        root.querySelectorAll("[aria-invalid]").forEach((/** @type {any} */ m) => { m.removeAttribute("aria-invalid"); m.removeAttribute("aria-describedby"); });
        try {
          const told = await post("api/table", { name: name.value, plate: numbers.map((p, i) => [p.name, plateInputs[i].value]), rows: rows.map((row) => row.map((input) => input.value)) });
          if (!told.mistakes) return await opened(told);
          told.mistakes.forEach((/** @type {any} */ mistake, /** @type {number} */ n) => {
            const input = mistake.table === "plate" ? plateInputs[mistake.row] : rows[mistake.row]?.[mistake.column];
            if (!input) return;
            input.setAttribute("aria-invalid", "true");
            input.setAttribute("aria-describedby", `mistake-${n}`);
            input.after(h("span", { class: "mistake", id: `mistake-${n}` }, mistake.says));
            if (n === 0) input.focus();
          });
        } catch (error) {
          page.fail(/** @type {Error} */ (error));
        }
      } }, "Open these returns"))));
  }

  /** @param {boolean} open */
  async function inspect(open) {
    const told = open ? await get("api/inspection").catch(() => null) : null;
    if (!told) {
      found.replaceChildren(h("section", { class: "card" }, h("h2", {}, "What the data hold"), h("p", { class: "hint" }, "No data are open.")));
      return;
    }
    const robot = told.robot ? Object.entries(told.robot).filter(([, value]) => value !== null) : [];
    const setup = told.setup ?? {};
    const faults = (setup.faults ?? []).map((/** @type {any} */ fault) => h("li", { class: "look" }, fault.sentence ?? fault.says ?? JSON.stringify(fault)));
    found.replaceChildren(h("section", { class: "card" },
      h("h2", {}, "What the data hold"),
      faults.length ? [h("h3", {}, "Fix these first"), h("ul", {}, faults)] : null,
      h("h3", {}, "Robot"), h("div", { class: "scroll" }, h("table", { id: "plate-table" }, robot.map(([key, value]) => h("tr", {}, h("th", { scope: "row" }, key), h("td", {}, String(value)))))),
      told.path ? h("p", {}, `Path: ${told.path.shape}, ${Object.entries(told.path.sizes ?? {}).map(([k, v]) => `${k} ${Array.isArray(v) ? "…" : v}`).join(", ")}`) : h("p", {}, "The path is not known."),
      h("h3", {}, "Runs"), h("div", { class: "scroll" }, h("table", {}, h("thead", {}, h("tr", {}, ["test", "direction", "runs", "returns", "headings", "logs"].map((w) => h("th", { scope: "col" }, w)))),
        h("tbody", {}, told.groups.map((/** @type {any} */ g) => h("tr", {}, [g.test, g.direction ?? "none", g.runs, g.returns, g.headings, g.logs].map((v) => h("td", {}, String(v)))))))),
      h("h3", {}, "Is the data good?"), h("ul", {}, told.checks.map((/** @type {any} */ check) => h("li", {}, h("span", { class: check.ok ? "ok" : "look" }, check.ok ? "ok " : "LOOK "), `${check.name}: ${check.found}`, h("span", { class: "hint" }, ` (good: ${check.good})`)))),
      h("h3", {}, "What can it determine?"), h("ul", {}, told.determined.map((/** @type {any} */ d) => h("li", {}, h("span", { class: d.yes ? "ok" : "look" }, d.yes ? "yes " : "no "), `${d.quantity}: ${d.because}`))),
      told.warnings.length ? [h("h3", {}, "Noticed while reading"), h("ul", {}, told.warnings.map((/** @type {string} */ w) => h("li", {}, w)))] : null));
  }
  return { root, inspect };
}
