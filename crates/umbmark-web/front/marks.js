// @ts-check
// What is pointed at, and what is chosen: one mark for the drive and all figures.

/**
 * A place of a run, by how far its wheels had rolled [m]: Infinity is its end, null means the run as a whole. The drive adds the number of
 * the place among the measured ones, because a robot that stands still does not roll.
 * @typedef {{ run: string, rolled: number | null, index?: number }} Mark
 */

/** @param {Mark} a @param {Mark} b */
const same = (a, b) => a.run === b.run && a.rolled === b.rolled && (a.index === undefined || b.index === undefined || a.index === b.index);

/**
 * Keeps the mark. What is pointed at is shown before what is chosen.
 * @param {(mark: Mark | null, isChosen: boolean) => void} show
 */
export function marksFor(show) {
  /** @type {Mark | null} */ let pointed = null;
  /** @type {Mark | null} */ let chosen = null;
  const tell = () => {
    const mark = pointed ?? chosen;
    show(mark, mark !== null && chosen !== null && same(mark, chosen));
  };
  return {
    /** @param {Mark | null} mark */
    point(mark) { pointed = mark; tell(); },
    /** Chooses a mark; the same mark again clears it. @param {Mark} mark */
    toggle(mark) { chosen = chosen && same(mark, chosen) ? null : mark; tell(); },
    /** @param {Mark | null} mark */
    choose(mark) { [pointed, chosen] = [null, mark]; tell(); },
    tell,
  };
}

/**
 * The number of the place that is nearest to where the wheels had rolled so far; -1 if there is none.
 * @param {(number | null)[]} rolled [m]
 * @param {number} at [m]
 * @param {(index: number) => boolean} [counts] whether a place is looked at
 */
export function nearest(rolled, at, counts = () => true) {
  let [best, least] = [-1, Infinity];
  rolled.forEach((own, index) => {
    if (own === null || !counts(index)) return;
    const far = Number.isFinite(at) ? Math.abs(own - at) : -own;
    if (best < 0 || far < least) [best, least] = [index, far];
  });
  return best;
}
