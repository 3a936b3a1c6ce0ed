// @ts-check
// Elements of the page. Words of data become text, never markup.

/**
 * @param {string} tag
 * @param {Record<string, any>} [attributes] functions become listeners
 * @param {...any} inside
 * @returns {any}
 */
export function h(tag, attributes = {}, ...inside) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (value === null || value === undefined || value === false) continue;
    if (typeof value === "function") element.addEventListener(name.slice(2), value);
    else if (name === "value") /** @type {any} */ (element).value = value;
    else if (name === "checked") /** @type {any} */ (element).checked = value;
    else element.setAttribute(name, value === true ? "" : String(value));
  }
  element.append(...inside.flat(3).filter((one) => one !== null && one !== undefined && one !== false));
  return element;
}

/** A name of an effect, that may break after its underscores. @param {string} name */
export const breaks = (name) => name.split("_").flatMap((part, index) => (index ? ["_", document.createElement("wbr"), part] : [part]));

/** @param {string} id @returns {any} */
export const by = (id) => document.getElementById(id);

/** @param {number | null | undefined} metres */
export const mm = (metres) => (metres === null || metres === undefined ? "–" : `${(1e3 * metres).toFixed(1)} mm`);

/** @param {number | null | undefined} radians */
export const degrees = (radians) => (radians === null || radians === undefined ? "" : `${((radians * 180) / Math.PI).toFixed(2)} deg`);

/** @param {number | null | undefined} p */
export const pText = (p) => (p === null || p === undefined ? "" : p < 0.001 ? "p < 0.001" : `p = ${p.toFixed(3)}`);

/** @param {number} value */
export const plain = (value) => String(Number(value.toPrecision(7)));

/**
 * What the words of the drawing need: its size in pixels of the screen.
 * @param {HTMLCanvasElement} canvas
 * @param {number} height [CSS pixels]
 */
export function sheet(canvas, height) {
  const width = canvas.clientWidth || 300;
  const scale = window.devicePixelRatio || 1;
  const [w, t] = [Math.round(width * scale), Math.round(height * scale)];
  if (canvas.width !== w || canvas.height !== t) [canvas.width, canvas.height] = [w, t];
  canvas.style.height = `${height}px`;
  const pen = /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d"));
  pen.setTransform(scale, 0, 0, scale, 0, 0);
  pen.clearRect(0, 0, width, height);
  const size = Math.max(11, 0.78 * rem());
  pen.font = `${size}px Roboto, system-ui, sans-serif`;
  return { pen, width, height, size };
}

/** The size of the letters [CSS pixels]. */
export const rem = () => parseFloat(getComputedStyle(document.documentElement).fontSize);

/** The colours of the page now. @param {string[]} names */
export function colours(names) {
  const style = getComputedStyle(document.documentElement);
  return Object.fromEntries(names.map((name) => [name, style.getPropertyValue(`--${name}`).trim()]));
}

/** Round steps for an axis. @param {number} low @param {number} high @param {number} most */
export function ticks(low, high, most) {
  const rough = (high - low) / Math.max(1, most);
  if (!(rough > 0)) return [low];
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((n) => n * power).find((n) => n >= rough) ?? rough;
  const found = [];
  for (let at = Math.ceil(low / step) * step; at <= high + 1e-9 * step; at += step) found.push(Number(at.toPrecision(10)));
  return found;
}
