// SPDX-License-Identifier: Apache-2.0
// Helpers that the operator page and the farm's page share. project_page() embeds this file in both programs.

export const byId = (id) => document.getElementById(id);

export function make(tag, text, className) {
  const element = document.createElement(tag);
  if (text !== undefined) element.textContent = text;
  if (className) element.className = className;
  return element;
}

export function makeSvg(tag, attributes) {
  const element = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  return element;
}

// ---- Numbers in words: a dash for what is not known ----
export const isNumber = (x) => typeof x === "number" && Number.isFinite(x);
export const fixed = (x, digits) => (isNumber(x) ? x.toFixed(digits) : "–");
export const large = (x) => (!isNumber(x) ? "–" : x >= 1e9 ? fixed(x / 1e9, 2) + " G" : x >= 1e6 ? fixed(x / 1e6, 1) + " M"
  : x >= 1e4 ? fixed(x / 1e3, 0) + " k" : fixed(x, 0));
export const duration = (s) => (s < 120 ? `${Math.round(s)} s` : s < 7200 ? `${Math.round(s / 60)} min`
  : s < 172800 ? `${Math.round(s / 3600)} h` : `${Math.round(s / 86400)} days`);

// ---- Time ----
export const pause = (ms) => new Promise((done) => setTimeout(done, ms));
// Throws after so many milliseconds without an answer.
export const get = (address, timeout = 5000) => fetch(address, { signal: AbortSignal.timeout(timeout) });
export const post = (address, body, timeout) => fetch(address, { method: "POST", headers: { "Content-Type": "application/json" },
  body: JSON.stringify(body), signal: AbortSignal.timeout(timeout) });

// Calls `look` again and again while the page is visible, until it returns false; `hide` instead while it is not.
export async function repeat(ms, look, hide = () => {}) {
  for (;;) {
    if (document.hidden) hide();
    else if (await look() === false) return;
    await pause(ms);
  }
}
