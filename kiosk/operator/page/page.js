// SPDX-License-Identifier: Apache-2.0
"use strict";

const byId = (id) => document.getElementById(id);
const make = (tag, text, className) => {
  const element = document.createElement(tag);
  if (text !== undefined) element.textContent = text;
  if (className) element.className = className;
  return element;
};

// ---- Numbers in words ----
const isNumber = (x) => typeof x === "number" && Number.isFinite(x);
const fixed = (x, digits) => (isNumber(x) ? x.toFixed(digits) : "–");
const milliseconds = (x) => (!isNumber(x) ? "–" : x < 10 ? x.toFixed(1) : Math.round(x).toString());
const bytes = (x) => (!isNumber(x) ? "–" : x >= 1e6 ? (x / 1e6).toFixed(1) + " MB" : Math.round(x / 1e3) + " kB");
const large = (x) => (!isNumber(x) ? "–" : x >= 1e6 ? (x / 1e6).toFixed(1) + " M" : x >= 1e4 ? Math.round(x / 1e3) + " k" : String(x));
const figure = (id, number, unit) => {
  const element = byId(id);
  element.textContent = number;
  if (unit && number !== "–") element.append(" ", make("small", unit));
};

// ---- Pictures: each asks for its next one when the last has come, while it can be seen ----
class LivePicture {
  constructor(element) {
    this.frame = element.querySelector(".frame");
    this.image = element.querySelector("img");
    this.missing = element.querySelector(".missing");
    this.address = null;
    this.visible = true;
    new IntersectionObserver((entries) => { this.visible = entries[entries.length - 1].isIntersecting; }, { rootMargin: "200px" })
      .observe(element);
    this.run();
  }
  show(process, name) {
    this.address = `/picture/${encodeURIComponent(process)}/${encodeURIComponent(name)}.jpg`;
  }
  explain(text) {
    this.missing.textContent = text;
    this.image.classList.toggle("stale", text !== "");
  }
  async run() {
    for (;;) {
      const begun = performance.now();
      let pause = 120;
      if (this.address && this.visible && !document.hidden) {
        try {
          await this.load();
          this.explain("");
        } catch (problem) {
          this.explain(problem.message);
          pause = 1000;
        }
      }
      await new Promise((done) => setTimeout(done, Math.max(20, pause - (performance.now() - begun))));
    }
  }
  async load() {
    let answer;
    try {
      answer = await fetch(this.address, { signal: AbortSignal.timeout(5000) });
    } catch {
      throw new Error("The operator page does not answer.");
    }
    if (answer.status === 404) throw new Error("There is no picture yet.");
    if (!answer.ok) throw new Error("The part that makes this picture is away.");
    const address = URL.createObjectURL(await answer.blob());
    const old = this.image.src;
    this.image.src = address;
    try {
      await this.image.decode();
    } finally {
      if (old.startsWith("blob:")) URL.revokeObjectURL(old);
    }
    this.image.hidden = false;
    this.frame.classList.add("live");
  }
}
const pictures = { wall: new LivePicture(byId("wall")), panorama: new LivePicture(byId("panorama")), camera: new LivePicture(byId("camera")) };
const projectors = new Map();

function showProjector(process, name) {
  const key = process + "/" + name;
  if (projectors.has(key)) return;
  const figureElement = make("figure");
  const frame = make("div", undefined, "frame");
  const image = make("img");
  image.alt = `What the projector “${name.slice("projector/".length)}” shows`;
  image.hidden = true;
  frame.append(image, make("p", "", "missing"));
  figureElement.append(frame, make("figcaption", "Projector “" + name.slice("projector/".length) + "”"));
  byId("projectors").append(figureElement);
  const picture = new LivePicture(figureElement);
  picture.show(process, name);
  projectors.set(key, picture);
}

function findPictures(processes) {
  // Only a simulated room can look at the wall; a museum's people see it themselves.
  byId("wall").hidden = !processes.some((process) => process.name === "simulated-room");
  const order = ["left", "middle", "centre", "center", "right"];
  const rank = (name) => { const at = order.indexOf(name.split("/").pop()); return at < 0 ? order.length : at; };
  const found = { wall: "The simulated room is not watched, or has no picture of the wall yet.",
                  panorama: "The display has no picture yet.", camera: "The tracker has no picture yet." };
  for (const process of processes) {
    for (const name of process.pictures.slice().sort((a, b) => rank(a) - rank(b))) {
      if (name.startsWith("projector/")) showProjector(process.name, name);
      else if (name in found && found[name] !== null) {
        pictures[name].show(process.name, name);
        found[name] = null;
      }
    }
  }
  for (const [name, why] of Object.entries(found)) {
    if (why !== null && !pictures[name].address) pictures[name].explain(why);
  }
}

// ---- Shutter to photon: one row per step, each beginning where the one before ended ----
const stageNames = { capture: "capture", detect: "detect the tag", pose: "pose", steer: "steer", farm_round_trip: "farm and network",
  farm: "farm", queue: "wait for a turn", plan: "plan", fan_out: "fan out", render: "ray trace", encode: "encode", decode: "decode", wait: "wait for refresh", draw: "draw",
  heading_to_photon: "heading to photon", shutter_to_photon: "shutter to photon" };

function flowRows(flow) {
  const known = flow.filter((stage) => stage.where !== "other" && stage.count > 0);
  const begins = new Map();
  const insides = new Map();
  let at = 0;
  let farmBegin = 0;
  const rows = known.map((stage) => {
    let begin = at;
    if (stage.name === "farm_round_trip") farmBegin = at;
    if (stage.where === "whole") begin = 0;
    else if (stage.name === "decode") {
      // Tiles are decoded while the farm still traces others, so the step ends soon after the farm's.
      begin = Math.max(farmBegin, at - stage.p50_ms);
      at = begin + Math.max(stage.p50_ms, at - begin);
    } else if (stage.inside && begins.has(stage.inside)) {
      begin = begins.get(stage.inside) + (insides.get(stage.inside) || 0);
      insides.set(stage.inside, (insides.get(stage.inside) || 0) + stage.p50_ms);
    } else at += stage.p50_ms;
    begins.set(stage.name, begin);
    const depth = !stage.inside ? 0 : stage.inside === "farm" ? 2 : 1;
    return { stage, begin, depth };
  });
  return rows;
}

function bar(row, whole) {
  const svg = document.createElementNS("http://www.w3.org/2000/svg", "svg");
  svg.setAttribute("viewBox", "0 0 1000 10");
  svg.setAttribute("preserveAspectRatio", "none");
  svg.setAttribute("role", "img");
  svg.setAttribute("aria-label", `${milliseconds(row.stage.p50_ms)} ms, 95 of 100 within ${milliseconds(row.stage.p95_ms)} ms`);
  const colour = `var(--${row.stage.where})`;
  for (const [ms, opacity] of [[row.stage.p99_ms, 0.2], [row.stage.p95_ms, 0.45], [row.stage.p50_ms, 1]]) {
    const rect = document.createElementNS("http://www.w3.org/2000/svg", "rect");
    rect.setAttribute("x", (1000 * row.begin) / whole);
    rect.setAttribute("y", row.depth === 0 ? 1 : 3);
    rect.setAttribute("width", Math.max(1.5, (1000 * ms) / whole));
    rect.setAttribute("height", row.depth === 0 ? 8 : 4);
    rect.style.fill = colour;
    rect.style.opacity = opacity;
    svg.append(rect);
  }
  return svg;
}

function showFlow(flow) {
  const rows = flowRows(flow);
  if (rows.length === 0) return;
  // The scale ends at the 95th percentile: a rare hiccup must not flatten everything else.
  const whole = Math.max(...rows.map((row) => row.begin + row.stage.p95_ms)) * 1.04;
  const table = make("table");
  const head = make("tr");
  head.append(make("td"), make("td"), make("td", "ms p50"), make("td", "p95", "p95-number"), make("td", "p99"));
  const thead = make("thead");
  thead.append(head);
  const body = make("tbody");
  for (const row of rows) {
    const line = make("tr", undefined, row.stage.where === "whole" ? "whole" : "");
    const name = make("th", stageNames[row.stage.name] || row.stage.name, ["", "inside", "inside2"][row.depth]);
    name.scope = "row";
    name.title = `${row.stage.where}: ${row.stage.count} measured`;
    const barCell = make("td", undefined, "bar");
    barCell.append(bar(row, whole));
    line.append(name, barCell, make("td", milliseconds(row.stage.p50_ms), "number"),
      make("td", milliseconds(row.stage.p95_ms), "number p95-number"), make("td", milliseconds(row.stage.p99_ms), "number"));
    body.append(line);
  }
  table.append(thead, body);
  byId("flow").replaceChildren(table);
}

// ---- Every part ----
const partNames = { tour: "Tour", display: "Display", tracker: "Tracker", calibrator: "Calibrator", hand: "Hand controls",
                    projectors: "Projectors' power", head: "Farm", "simulated-room": "Simulated room" };
const openParts = new Set();

function showParts(processes) {
  byId("parts").replaceChildren(...processes.map((process) => {
    const item = make("li", undefined, process.healthy ? "well" : process.asked ? "wrong" : "");
    const heading = make("h3", partNames[process.name] || process.name);
    heading.append(make("b", process.away ? (process.asked ? "away" : "asking") : process.healthy ? "well" : "needs you"));
    item.append(heading, make("p", process.state));
    const uptime = !process.away && isNumber(process.uptime_s) ? `, up ${duration(process.uptime_s)}` : "";
    item.append(make("p", process.address + uptime, "where"));
    const names = Object.keys(process.gauges).filter((name) => !name.startsWith("dropped: "));
    if (names.length > 0) {
      const details = make("details");
      details.open = openParts.has(process.name);
      details.addEventListener("toggle", () => { if (details.open) openParts.add(process.name); else openParts.delete(process.name); });
      const list = make("dl");
      for (const name of names) {
        const value = process.gauges[name];
        list.append(make("dt", name.replaceAll("_", " ")), make("dd", isNumber(value) ? String(Math.round(value * 1000) / 1000) : "–"));
      }
      details.append(make("summary", `${names.length} numbers`), list);
      item.append(details);
    }
    return item;
  }));
}
const duration = (s) => (s < 120 ? `${Math.round(s)} s` : s < 7200 ? `${Math.round(s / 60)} min` : s < 172800 ? `${Math.round(s / 3600)} h` : `${Math.round(s / 86400)} days`);

function showDrops(gauges) {
  const drops = Object.entries(gauges).filter(([name, value]) => name.startsWith("dropped: ") && value > 0);
  byId("drops-section").hidden = drops.length === 0;
  byId("drops").replaceChildren(...drops.map(([name, value]) => {
    const item = make("li");
    item.append(make("b", String(value)), name.slice("dropped: ".length));
    return item;
  }));
}

function showVisit(status) {
  const tour = status.processes.find((process) => process.name === "tour");
  const wrong = status.processes.filter((process) => process.asked && !process.healthy);
  const state = byId("state");
  state.classList.toggle("wrong", wrong.length > 0);
  const main = wrong.find((process) => process.name === "tour") || wrong[0];
  state.textContent = main ? `${partNames[main.name] || main.name}: ${main.state}` : tour ? tour.state : "All watched parts are well.";
  showFlow(status.flow);
  if (!tour) return;
  const gauges = tour.away ? {} : tour.gauges;
  const photon = status.flow.find((stage) => stage.name === "shutter_to_photon");
  byId("title").textContent = tour.facts.title || "No visit yet";
  document.title = tour.facts.title ? `${tour.facts.title} · Cyclorama` : "Cyclorama";
  byId("credits").textContent = tour.facts.credits || "";
  figure("fps", fixed(gauges.frames_per_second, 1));
  figure("latency", tour.away || !photon ? "–" : milliseconds(photon.p50_ms), "ms");
  figure("bytes", bytes(gauges.bytes_per_frame));
  figure("balance", isNumber(gauges.balance_efficiency) ? Math.round(100 * gauges.balance_efficiency).toString() : "–", "%");
  figure("triangles", large(Number(tour.facts.triangles || NaN)));
  byId("steered-by").textContent = tour.away ? "–" : tour.facts.steered_by || "–";
  byId("heading").textContent = isNumber(gauges.heading_deg) ? `${fixed(gauges.heading_deg, 0)}°` : "–";
  byId("place").textContent = isNumber(gauges.eye_x_m) ? `${fixed(gauges.eye_x_m, 2)}, ${fixed(gauges.eye_z_m, 2)} m` : "–";
  byId("speed").textContent = isNumber(gauges.forward_m_per_s) ? `${fixed(Math.hypot(gauges.forward_m_per_s, gauges.sideways_m_per_s), 2)} m/s` : "–";
  showDrops(tour.gauges);
}

async function watchStatus() {
  for (;;) {
    if (!document.hidden) {
      try {
        const status = await (await fetch("/status", { signal: AbortSignal.timeout(5000) })).json();
        findPictures(status.processes);
        showVisit(status);
        showParts(status.processes);
      } catch (problem) {
        const state = byId("state");
        state.classList.add("wrong");
        state.textContent = "The operator page does not answer. See that cyclorama-operator runs; this page tries again by itself.";
      }
    }
    await new Promise((done) => setTimeout(done, 500));
  }
}
watchStatus();

// ---- Steering: what is held is sent ten times a second; the tour forgets it after 300 ms ----
const keyWishes = { ArrowUp: "forward+", KeyW: "forward+", ArrowDown: "forward-", KeyS: "forward-", KeyA: "right-", KeyD: "right+",
  ArrowLeft: "turn-", KeyQ: "turn-", ArrowRight: "turn+", KeyE: "turn+" };
const held = new Map();  // What is held (a key's or button's name) to its wish.
let steering = null;
let isSending = false;
let sendAgain = false;
const steerNote = byId("steer-note").textContent;

const buttonWish = (button) => {
  const [axis, value] = Object.entries(button.dataset)[0];
  return axis + (Number(value) > 0 ? "+" : "-");
};
function markHeld() {
  const wishes = new Set(held.values());
  for (const button of document.querySelectorAll(".pad button")) button.classList.toggle("held", wishes.has(buttonWish(button)));
}
// One request at a time, always with what is held now: an old wish never arrives after a newer one, and a tour that hangs
// does not take the browser's connections from the pictures.
async function sendWish() {
  if (isSending) {
    sendAgain = true;
    return;
  }
  isSending = true;
  const wish = { forward: 0, right: 0, turn: 0 };
  for (const name of new Set(held.values())) wish[name.slice(0, -1)] += name.endsWith("+") ? 1 : -1;
  const note = byId("steer-note");
  try {
    const answer = await fetch("/steer", { method: "POST", headers: { "Content-Type": "application/json" }, body: JSON.stringify(wish),
                                           signal: AbortSignal.timeout(2000) });
    if (!answer.ok) throw new Error((await answer.json()).error);
    note.classList.remove("wrong");
    note.textContent = steerNote;
  } catch (problem) {
    note.classList.add("wrong");
    note.textContent = `The tour was not reached, so nothing moves: ${problem.message}`;
  }
  isSending = false;
  if (!sendAgain) return;
  sendAgain = false;
  sendWish();
}
function hold(what, wish) {
  held.set(what, wish);
  markHeld();
  if (steering === null) {
    sendWish();
    steering = setInterval(sendWish, 100);
  }
}
function release(what) {
  if (!held.delete(what)) return;
  markHeld();
  if (held.size > 0) return;
  clearInterval(steering);
  steering = null;
  sendWish();
}
const releaseAll = () => { for (const what of [...held.keys()]) release(what); };

addEventListener("keydown", (event) => {
  if (event.ctrlKey || event.altKey || event.metaKey || !(event.code in keyWishes)) return;
  event.preventDefault();
  if (!event.repeat) hold(event.code, keyWishes[event.code]);
});
addEventListener("keyup", (event) => release(event.code));
addEventListener("blur", releaseAll);
document.addEventListener("visibilitychange", () => { if (document.hidden) releaseAll(); });
for (const button of document.querySelectorAll(".pad button")) {
  const name = "button " + buttonWish(button);
  button.addEventListener("pointerdown", (event) => {
    event.preventDefault();
    button.setPointerCapture(event.pointerId);
    hold(name, buttonWish(button));
  });
  for (const end of ["pointerup", "pointercancel", "lostpointercapture"]) button.addEventListener(end, () => release(name));
  button.addEventListener("contextmenu", (event) => event.preventDefault());
  // Space and Enter hold a focused button as a finger does.
  button.addEventListener("keydown", (event) => { if ((event.code === "Space" || event.code === "Enter") && !event.repeat) { event.preventDefault(); hold(name, buttonWish(button)); } });
  button.addEventListener("keyup", () => release(name));
  button.addEventListener("blur", () => release(name));
}
