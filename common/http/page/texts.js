// SPDX-License-Identifier: Apache-2.0
// The page's texts in the reader's language: the one chosen here, else the museum's, else the browser's. Importing this
// file translates the page's HTML; scripts/texts collects what scripts say by tr() and ntr().
import { get } from "./helpers.js";

const kChosen = "cyclorama-language";
const chosen = localStorage.getItem(kChosen) || "";

async function catalogue() {
  try {
    const answer = await get(`/texts?language=${encodeURIComponent(chosen)}`);
    if (answer.ok) return await answer.json();
  } catch {
    // The page stays English; its scripts report that the page does not answer.
  }
  return { language: "en", languages: { en: "English" }, plural: "10", texts: [] };
}

const { language, languages, plural, texts } = await catalogue();
const forms = new Map(texts.map(([one, , ...translated]) => [one, translated]));

const filled = (text, values) => text.replace(/\{(\w+)\}/g, (place, name) => (name in values ? values[name] : place));

// Returns a text with its {places} filled.
export const tr = (english, values = {}) => filled(forms.get(english)?.[0] ?? english, values);

// The same for a count, which is the place {n}.
export function ntr(one, many, n, values = {}) {
  const rule = Number(plural[n < plural.length ? n : plural.length - 100 + (n % 100)] ?? 1);
  const text = forms.get(one)?.[rule] ?? (n === 1 ? one : many);
  return filled(text, { n, ...values });
}

// British English writes times as the settings do, up to 24 hours.
const locale = language === "en" ? "en-GB" : language;

// Returns a time zone that the browser knows: a computer without a named one calls its own "localtime".
function known(zone) {
  try {
    return new Intl.DateTimeFormat(locale, { timeZone: zone }).resolvedOptions().timeZone;
  } catch {
    return undefined;
  }
}

// A date and time in the museum's time zone, as the reader writes it.
export function dateText(iso, zone, withDay) {
  const options = withDay
    ? { weekday: "short", day: "numeric", month: "short", hour: "2-digit", minute: "2-digit" }
    : { hour: "2-digit", minute: "2-digit" };
  return new Intl.DateTimeFormat(locale, { ...options, timeZone: known(zone) }).format(new Date(iso));
}

// A date such as "2026-11-25".
export const dayText = (date) =>
  new Intl.DateTimeFormat(locale, { weekday: "short", day: "numeric", month: "short", timeZone: "UTC" }).format(
    new Date(date),
  );

// "Tue-Sun 10:00-18:00" with the reader's names of the days.
export function hoursText(line) {
  const days = ["Sun", "Mon", "Tue", "Wed", "Thu", "Fri", "Sat"];
  const name = (day) =>
    new Intl.DateTimeFormat(locale, { weekday: "short", timeZone: "UTC" }).format(Date.UTC(2026, 1, 1 + days.indexOf(day)));
  return line.replace(/\b(Sun|Mon|Tue|Wed|Thu|Fri|Sat)\b/g, name).replace(/\bclosed\b/g, tr("closed"));
}

// ---- The page's HTML ----
function translateElement(element) {
  for (const name of ["alt", "title", "aria-label", "placeholder"]) {
    if (element.hasAttribute(name)) element.setAttribute(name, tr(element.getAttribute(name)));
  }
  for (const node of element.childNodes) {
    if (node.nodeType !== Node.TEXT_NODE) continue;
    const english = node.textContent.trim().replace(/\s+/g, " ");
    if (forms.has(english)) node.textContent = node.textContent.replace(/\S[^]*\S|\S/, () => tr(english));
  }
}

function offerLanguages(select) {
  for (const [code, name] of Object.entries(languages)) {
    const option = document.createElement("option");
    option.value = code;
    option.lang = code;
    option.textContent = name;
    option.selected = code === language;
    select.append(option);
  }
  select.addEventListener("change", () => {
    localStorage.setItem(kChosen, select.value);
    location.reload();
  });
}

document.documentElement.lang = language;
for (const element of document.body.querySelectorAll("*")) translateElement(element);
for (const select of document.querySelectorAll("select.language")) offerLanguages(select);
