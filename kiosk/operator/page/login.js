// SPDX-License-Identifier: Apache-2.0
import { byId, get, make, pause, post } from "./helpers.js";
import { tr } from "./texts.js";

const pin = byId("pin");
const note = byId("note");
const button = document.querySelector("#form button");

// The QR code on the wall adds the certificate's fingerprint, and a code which proves that somebody has seen the wall.
const fromWall = new URLSearchParams(location.hash.slice(1));
addEventListener("hashchange", () => location.reload());
const fingerprint = fromWall.get("sha256") || "";
if (/^[0-9A-F]{64}$/.test(fingerprint)) {
  byId("print-value").textContent = fingerprint.match(/../g).join(":");
  byId("print").hidden = false;
}

byId("form").addEventListener("submit", async (event) => {
  event.preventDefault();
  button.disabled = true;
  note.textContent = "";
  try {
    const answer = await post("/login", { pin: pin.value, wall: fromWall.get("wall") || "" }, 15000);
    if (answer.ok) {
      location.replace(fromWall.get("next") === "install" ? "/install.html" : "/");
      return;
    }
    const why = (await answer.json()).error;
    note.textContent = why.charAt(0).toUpperCase() + why.slice(1) + (/[.。]$/.test(why) ? "" : ".");
    watchTheDoor();
  } catch {
    note.textContent = tr(
      "The operator page does not answer. Check that this phone or computer is on the museum's network.",
    );
  }
  button.disabled = false;
  pin.select();
});

// ---- The first PIN: for somebody who has scanned the wall's code, which proves that they stand before it ----
byId("first").addEventListener("submit", async (event) => {
  event.preventDefault();
  const chosen = byId("first-pin").value;
  const firstNote = byId("first-note");
  if (chosen !== byId("first-again").value) {
    firstNote.textContent = tr("The two are not the same.");
    return;
  }
  const submit = byId("first").querySelector("button");
  submit.disabled = true;
  try {
    const answer = await post("/first-pin", { pin: chosen, wall: fromWall.get("wall") || "" }, 15000);
    if (!answer.ok) throw new Error((await answer.json()).error);
    firstNote.textContent = tr("It is checked with all settings; that takes some seconds.");
    for (let i = 0; i < 240; ++i) {
      await pause(500);
      const login = await post("/login", { pin: chosen, wall: fromWall.get("wall") || "" }, 15000);
      if (login.ok) {
        location.replace("/install.html");
        return;
      }
    }
    throw new Error(tr("the PIN did not come into use; the reason is above"));
  } catch (problem) {
    firstNote.textContent = tr("That did not work: {why}", { why: problem.message });
  }
  submit.disabled = false;
});

// While no PIN is in use, the page shows everybody the reason, and polls until a USB stick has brought one.
let isWatching = false;
async function watchTheDoor() {
  if (isWatching) return;
  isWatching = true;
  for (let told = true; told;) {
    try {
      const answer = await get("/door", 10000);
      const { checks } = await answer.json();
      told = checks.length > 0;
      byId("door").hidden = !told;
      byId("form").hidden = told;
      byId("first").hidden = !told || !fromWall.get("wall");
      byId("told").replaceChildren(
        ...checks.map((check) => {
          const item = make("li", "", check.level);
          item.append(make("h2", check.title), make("p", check.sentence));
          if (check.remedy) item.append(make("p", check.remedy, "remedy"));
          return item;
        }),
      );
      if (!told) pin.focus();
    } catch {
      // Ignored: an attempt to log in reports that the page does not answer.
    }
    if (told) await pause(3000);
  }
  isWatching = false;
}
watchTheDoor();
