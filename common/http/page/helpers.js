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

// ---- Numbers as the page's language writes them: a dash for what is not known ----
const language = () => document.documentElement.lang || "en";
const number = (x, options) => new Intl.NumberFormat(language(), options).format(x);
export const isNumber = (x) => typeof x === "number" && Number.isFinite(x);
export const fixed = (x, digits) =>
  isNumber(x) ? number(x, { minimumFractionDigits: digits, maximumFractionDigits: digits, useGrouping: false }) : "–";
export function large(x) {
  if (!isNumber(x)) return "–";
  if (x >= 1e9) return fixed(x / 1e9, 2) + " G";
  if (x >= 1e6) return fixed(x / 1e6, 1) + " M";
  return x >= 1e4 ? fixed(x / 1e3, 0) + " k" : fixed(x, 0);
}
const withUnit = (x, unit) =>
  number(x, { style: "unit", unit, unitDisplay: "short", maximumFractionDigits: 0, useGrouping: false });
export function duration(s) {
  if (s < 120) return withUnit(s, "second");
  if (s < 7200) return withUnit(s / 60, "minute");
  return s < 172800 ? withUnit(s / 3600, "hour") : withUnit(s / 86400, "day");
}
// The same for a time that is over: "3 min. ago".
export function ago(s) {
  const [value, unit] = s < 90 ? [s, "second"] : s < 5400 ? [s / 60, "minute"] : [s / 3600, "hour"];
  return new Intl.RelativeTimeFormat(language(), { style: "short" }).format(-Math.round(value), unit);
}

// ---- Time ----
export const pause = (ms) => new Promise((done) => setTimeout(done, ms));
// Both functions throw after `timeout` milliseconds without an answer.
export const get = (address, timeout = 5000) =>
  fetch(address, { headers: { "Accept-Language": language() }, signal: AbortSignal.timeout(timeout) });
export const post = (address, body, timeout) =>
  fetch(address, {
    method: "POST",
    headers: { "Content-Type": "application/json", "Accept-Language": language() },
    body: JSON.stringify(body),
    signal: AbortSignal.timeout(timeout),
  });

// Calls `look` repeatedly while the page is visible, until it returns false; calls `hide` while the page is not
// visible.
export async function repeat(ms, look, hide = () => {}) {
  for (;;) {
    if (document.hidden) hide();
    else if ((await look()) === false) return;
    await pause(ms);
  }
}
