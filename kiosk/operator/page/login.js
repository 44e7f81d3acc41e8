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
    note.textContent = why.charAt(0).toUpperCase() + why.slice(1) + ".";
  } catch {
    note.textContent = "The operator page does not answer. See that this phone or computer is on the museum's network.";
  }
  button.disabled = false;
  pin.select();
});
