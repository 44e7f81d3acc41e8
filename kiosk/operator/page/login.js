// SPDX-License-Identifier: Apache-2.0
"use strict";

const pin = document.getElementById("pin");
const note = document.getElementById("note");
const button = document.querySelector("button");

document.getElementById("form").addEventListener("submit", async (event) => {
  event.preventDefault();
  button.disabled = true;
  note.textContent = "";
  try {
    const answer = await fetch("/login", { method: "POST", headers: { "Content-Type": "application/json" },
                                           body: JSON.stringify({ pin: pin.value }), signal: AbortSignal.timeout(15000) });
    if (answer.ok) {
      location.replace("/");
      return;
    }
    const why = (await answer.json()).error;
    note.textContent = why.charAt(0).toUpperCase() + why.slice(1) + (why.endsWith(".") ? "" : ".");
    watchTheDoor();
  } catch {
    note.textContent = "The operator page does not answer. See that this phone or computer is on the museum's network.";
  }
  button.disabled = false;
  pin.select();
});

// While no PIN is in use the page tells everybody why, and looks again until a stick has brought one.
function make(name, text, kind) {
  const element = document.createElement(name);
  element.textContent = text;
  if (kind) element.className = kind;
  return element;
}

let isWatching = false;
async function watchTheDoor() {
  if (isWatching) return;
  isWatching = true;
  for (let told = true; told;) {
    try {
      const answer = await fetch("/door", { signal: AbortSignal.timeout(10000) });
      const { checks } = await answer.json();
      told = checks.length > 0;
      document.getElementById("door").hidden = !told;
      document.getElementById("form").hidden = told;
      document.getElementById("told").replaceChildren(...checks.map((check) => {
        const item = make("li", "", check.level);
        item.append(make("h2", check.title), make("p", check.sentence));
        if (check.remedy) item.append(make("p", check.remedy, "remedy"));
        return item;
      }));
      if (!told) pin.focus();
    } catch {
      // Whoever enters a PIN is told that the page does not answer.
    }
    if (told) await new Promise((done) => setTimeout(done, 3000));
  }
  isWatching = false;
}
watchTheDoor();
