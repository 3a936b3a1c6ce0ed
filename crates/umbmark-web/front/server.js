// @ts-check
// Questions to the server that sent this page; no other place is ever asked.

/** The server does not answer. */
export class Silent extends Error {}

/**
 * @param {string} path
 * @param {RequestInit} [options]
 * @returns {Promise<any>}
 */
async function ask(path, options) {
  let response;
  try {
    response = await fetch(path, { credentials: "omit", cache: "no-store", ...options });
  } catch (error) {
    if (options?.signal?.aborted) throw error;
    throw new Silent("The server does not answer.");
  }
  const told = await response.json().catch(() => ({ error: `The server answered with ${response.status}.` }));
  if (!response.ok) throw new Error(told.error ?? `The server answered with ${response.status}.`);
  return told;
}

/** @param {string} path */
export const get = (path) => ask(path);

/**
 * @param {string} path
 * @param {unknown} [body]
 */
export const post = (path, body = {}) => ask(path, { method: "POST", body: JSON.stringify(body) });

/**
 * @param {string} path
 * @param {Blob} body
 */
export const send = (path, body) => ask(path, { method: "POST", body });

/** @param {Record<string, string>} words */
export const query = (words) => Object.entries(words).map(([name, value]) => `${name}=${encodeURIComponent(value)}`).join("&");

/**
 * Asks again and again while something is dragged: never two questions at once, and always the last one.
 * @template Q, A
 * @param {(question: Q) => Promise<A>} answer
 * @param {(answer: A, question: Q) => void} show
 * @param {(error: Error) => void} failed
 * @returns {(question: Q) => void}
 */
export function latest(answer, show, failed) {
  let busy = false;
  /** @type {{ question: Q } | null} */
  let next = null;
  const run = async () => {
    busy = true;
    while (next) {
      const { question } = next;
      next = null;
      try {
        const told = await answer(question);
        show(told, question);
      } catch (error) {
        failed(/** @type {Error} */ (error));
      }
    }
    busy = false;
  };
  return (question) => {
    next = { question };
    if (!busy) run();
  };
}
