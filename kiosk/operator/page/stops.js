// SPDX-License-Identifier: Apache-2.0
// The card of the tour's stops: the list, and the buttons that lead to them or change them.
import { byId, get, make } from "./helpers.js";
import { ask } from "./requests.js";
import { tr } from "./texts.js";

const kEvery = 2000; // Milliseconds between two looks at the list.

async function request(body, done) {
  const note = byId("stops-note");
  note.classList.remove("wrong");
  try {
    const answer = await ask("/stops", body);
    note.textContent = done(answer);
  } catch (problem) {
    note.textContent = tr("That did not work: {why}", { why: problem.message });
    note.classList.add("wrong");
  }
  await showStops();
}

function line(stop, isHere) {
  const item = make("li");
  const button = make("button", stop.title || stop.name);
  button.title = stop.text || stop.name;
  button.classList.toggle("held", isHere);
  button.addEventListener("click", () => request({ do: "go", name: stop.name }, () => ""));
  item.append(button);
  if (stop.is_kept) item.append(make("span", tr("kept for the farm's absence"), "figures-line"));
  return item;
}

// Fills a list of languages, unless somebody is choosing.
function fill(id, languages, chosen) {
  const list = byId(id);
  if (document.activeElement === list) return;
  const options = ["", ...languages].map((tag) => {
    const option = make("option", tag || "–");
    option.value = tag;
    return option;
  });
  list.replaceChildren(...options);
  list.value = chosen || "";
}

function chooseCaptions() {
  const languages = ["captions-first", "captions-second"].map((id) => byId(id).value).filter((tag) => tag);
  request({ do: "captions", languages: [...new Set(languages)] }, () => "");
}

async function showStops() {
  const answer = await get("/stops").catch(() => null);
  byId("stops").hidden = !answer || !answer.ok;
  if (byId("stops").hidden) return;
  const list = await answer.json();
  byId("stops-title").textContent = list.title ? tr("Stops: {title}", { title: list.title }) : tr("Stops");
  byId("stops-list").replaceChildren(...list.stops.map((stop, i) => line(stop, i === list.at)));
  byId("captions").hidden = !list.captions;
  if (list.captions) {
    fill("captions-first", list.languages, list.captions[0]);
    fill("captions-second", list.languages, list.captions[1]);
  }
  if (list.problem) byId("stops-note").textContent = tr("The newest tour is refused: {why}", { why: list.problem });
}

byId("stop-previous").addEventListener("click", () => request({ do: "previous" }, () => ""));
byId("stop-next").addEventListener("click", () => request({ do: "next" }, () => ""));
byId("stop-here").addEventListener("click", () => request({ do: "stop-here" }, (added) => tr("Added {name}.", added)));
for (const id of ["captions-first", "captions-second"]) byId(id).addEventListener("change", chooseCaptions);
byId("stop-undo").addEventListener("click", () => request({ do: "undo" }, () => tr("Undone.")));

showStops();
setInterval(showStops, kEvery);
