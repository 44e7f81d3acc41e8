// SPDX-License-Identifier: Apache-2.0
// The visit: pictures, numbers, every part, steering.
import { byId, duration, fixed, get, isNumber, large, make, makeSvg, pause, post, repeat } from "./helpers.js";
import { ntr, tr } from "./texts.js";

const milliseconds = (x) => (!isNumber(x) ? "–" : fixed(x, x < 10 ? 1 : 0));
const bytes = (x) => (!isNumber(x) ? "–" : x >= 1e6 ? fixed(x / 1e6, 1) + " MB" : Math.round(x / 1e3) + " kB");
const figure = (id, number, unit) => {
  const element = byId(id);
  element.textContent = number;
  if (unit && number !== "–") element.append(" ", make("small", unit));
};

// ---- Pictures: while one is visible, it requests the next picture when the last has arrived ----
class LivePicture {
  constructor(element) {
    this.frame = element.querySelector(".frame");
    this.image = element.querySelector("img");
    this.missing = element.querySelector(".missing");
    this.address = null;
    this.visible = true;
    new IntersectionObserver(
      (entries) => {
        this.visible = entries[entries.length - 1].isIntersecting;
      },
      { rootMargin: "200px" },
    ).observe(element);
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
      let interval = 120;
      if (this.address && this.visible && !document.hidden) {
        try {
          await this.load();
          this.explain("");
        } catch (problem) {
          this.explain(problem.message);
          interval = 1000;
        }
      }
      await pause(Math.max(20, interval - (performance.now() - begun)));
    }
  }
  async load() {
    let answer;
    try {
      answer = await get(this.address);
    } catch {
      throw new Error(tr("The operator page does not answer."));
    }
    if (answer.status === 404) throw new Error(tr("There is no picture yet."));
    if (!answer.ok) throw new Error(tr("The part that makes this picture does not answer."));
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
const pictures = {
  wall: new LivePicture(byId("wall")),
  panorama: new LivePicture(byId("panorama")),
  camera: new LivePicture(byId("camera")),
};
const projectors = new Map();

function showProjector(process, name) {
  const key = process + "/" + name;
  if (projectors.has(key)) return;
  const figureElement = make("figure");
  const frame = make("div", undefined, "frame");
  const image = make("img");
  const words = { name: name.slice("projector/".length) };
  image.alt = tr("What the projector “{name}” shows", words);
  image.hidden = true;
  frame.append(image, make("p", "", "missing"));
  figureElement.append(frame, make("figcaption", tr("Projector “{name}”", words)));
  byId("projectors").append(figureElement);
  const picture = new LivePicture(figureElement);
  picture.show(process, name);
  projectors.set(key, picture);
}

function findPictures(processes) {
  // Only a simulated room has a picture of the wall; a museum's people see the wall itself.
  byId("wall").hidden = !processes.some((process) => process.name === "simulated-room");
  const order = ["left", "middle", "centre", "center", "right"];
  const rank = (name) => {
    const at = order.indexOf(name.split("/").pop());
    return at < 0 ? order.length : at;
  };
  const found = {
    wall: tr("The simulated room is not watched or has no picture of the wall yet."),
    panorama: tr("The display has no picture yet."),
    camera: tr("The tracker has no picture yet."),
  };
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

export const projectorNames = () =>
  [...projectors.keys()].map((key) => key.slice(key.indexOf("/projector/") + "/projector/".length));

// ---- Shutter to photon: one row per step, each beginning where the previous one ended ----
const stageNames = {
  capture: tr("capture"),
  detect: tr("detect the tag"),
  pose: tr("pose"),
  steer: tr("steer"),
  farm_round_trip: tr("farm and network"),
  farm: tr("farm"),
  queue: tr("wait for a turn"),
  plan: tr("plan"),
  fan_out: tr("fan out"),
  render: tr("ray trace"),
  encode: tr("encode"),
  decode: tr("decode"),
  wait: tr("wait for refresh"),
  draw: tr("draw"),
  heading_to_photon: tr("heading to photon"),
  shutter_to_photon: tr("shutter to photon"),
};

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
      // Tiles are decoded while the farm still renders others, so this step ends soon after the farm's.
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
  const svg = makeSvg("svg", {
    viewBox: "0 0 1000 10",
    preserveAspectRatio: "none",
    role: "img",
    "aria-label": tr("{p50} ms, 95 of 100 within {p95} ms", {
      p50: milliseconds(row.stage.p50_ms),
      p95: milliseconds(row.stage.p95_ms),
    }),
  });
  const colour = `var(--${row.stage.where})`;
  for (const [ms, opacity] of [
    [row.stage.p99_ms, 0.2],
    [row.stage.p95_ms, 0.45],
    [row.stage.p50_ms, 1],
  ]) {
    const isOuter = row.depth === 0;
    const rect = makeSvg("rect", {
      x: (1000 * row.begin) / whole,
      y: isOuter ? 1 : 3,
      width: Math.max(1.5, (1000 * ms) / whole),
      height: isOuter ? 8 : 4,
    });
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
    name.title = ntr("{n} measurement", "{n} measurements", row.stage.count);
    const barCell = make("td", undefined, "bar");
    barCell.append(bar(row, whole));
    line.append(
      name,
      barCell,
      make("td", milliseconds(row.stage.p50_ms), "number"),
      make("td", milliseconds(row.stage.p95_ms), "number p95-number"),
      make("td", milliseconds(row.stage.p99_ms), "number"),
    );
    body.append(line);
  }
  table.append(thead, body);
  byId("flow").replaceChildren(table);
}

// ---- Every part ----
const partNames = {
  tour: tr("Tour"),
  display: tr("Display"),
  tracker: tr("Tracker"),
  calibrator: tr("Calibrator"),
  hand: tr("Hand controls"),
  projectors: tr("Projectors' power"),
  coordinator: tr("Farm"),
  "simulated-room": tr("Simulated room"),
};
const steeredBy = {
  tag: tr("the wand"),
  keys: tr("keys"),
  guide: tr("the guide"),
  nobody: tr("nobody"),
};
const openParts = new Set();

function showParts(processes) {
  byId("parts").replaceChildren(
    ...processes.map((process) => {
      const item = make("li", undefined, process.healthy ? "well" : process.asked ? "wrong" : "");
      const heading = make("h3", partNames[process.name] || process.name);
      heading.append(
        make(
          "b",
          process.away
            ? process.asked
              ? tr("no answer")
              : tr("connecting")
            : process.healthy
              ? tr("well")
              : tr("needs attention"),
        ),
      );
      item.append(heading, make("p", process.state));
      const uptime = !process.away && isNumber(process.uptime_s);
      const where = uptime
        ? tr("{address}, up {time}", { address: process.address, time: duration(process.uptime_s) })
        : process.address;
      item.append(make("p", where, "where"));
      const names = Object.keys(process.gauges).filter((name) => !name.startsWith("dropped: "));
      if (names.length > 0) {
        const details = make("details");
        details.open = openParts.has(process.name);
        details.addEventListener("toggle", () => {
          if (details.open) openParts.add(process.name);
          else openParts.delete(process.name);
        });
        const list = make("dl");
        for (const name of names) {
          const value = process.gauges[name];
          list.append(
            make("dt", name.replaceAll("_", " ")),
            make("dd", isNumber(value) ? String(Math.round(value * 1000) / 1000) : "–"),
          );
        }
        details.append(make("summary", ntr("{n} number", "{n} numbers", names.length)), list);
        item.append(details);
      }
      return item;
    }),
  );
}

function showDrops(gauges) {
  const drops = Object.entries(gauges).filter(([name, value]) => name.startsWith("dropped: ") && value > 0);
  byId("drops-section").hidden = drops.length === 0;
  byId("drops").replaceChildren(
    ...drops.map(([name, value]) => {
      const item = make("li");
      item.append(make("b", String(value)), name.slice("dropped: ".length));
      return item;
    }),
  );
}

function showVisit(status) {
  const tour = status.processes.find((process) => process.name === "tour");
  const wrong = status.processes.filter((process) => process.asked && !process.healthy);
  const state = byId("state");
  state.classList.toggle("wrong", wrong.length > 0);
  const main = wrong.find((process) => process.name === "tour") || wrong[0];
  state.textContent = main
    ? `${partNames[main.name] || main.name}: ${main.state}`
    : tour
      ? tour.state
      : tr("All watched parts are well.");
  showFlow(status.flow);
  if (!tour) return;
  const gauges = tour.away ? {} : tour.gauges;
  const photon = status.flow.find((stage) => stage.name === "shutter_to_photon");
  byId("title").textContent = tour.facts.title || tr("No visit yet");
  document.title = tour.facts.title ? `${tour.facts.title} · Cyclorama` : "Cyclorama";
  byId("credits").textContent = tour.facts.credits || "";
  figure("fps", fixed(gauges.frames_per_second, 1));
  const display = status.processes.find((process) => process.name === "display" && !process.away);
  figure("poses", fixed(display?.gauges.poses_per_second, 0));
  figure("latency", tour.away || !photon ? "–" : milliseconds(photon.p50_ms), "ms");
  figure("bytes", bytes(gauges.bytes_per_frame));
  figure(
    "balance",
    isNumber(gauges.balance_efficiency) ? Math.round(100 * gauges.balance_efficiency).toString() : "–",
    "%",
  );
  figure("triangles", large(Number(tour.facts.triangles || NaN)));
  byId("steered-by").textContent = tour.away || !tour.facts.steered_by ? "–" : (steeredBy[tour.facts.steered_by] ?? tour.facts.steered_by);
  byId("heading").textContent = isNumber(gauges.heading_deg) ? `${fixed(gauges.heading_deg, 0)}°` : "–";
  byId("position").textContent = isNumber(gauges.eye_x_m)
    ? `${fixed(gauges.eye_x_m, 2)}, ${fixed(gauges.eye_z_m, 2)} m`
    : "–";
  byId("speed").textContent = isNumber(gauges.forward_m_per_s)
    ? `${fixed(Math.hypot(gauges.forward_m_per_s, gauges.sideways_m_per_s), 2)} m/s`
    : "–";
  showDrops(tour.gauges);
}

repeat(500, async () => {
  try {
    const status = await (await get("/status")).json();
    findPictures(status.processes);
    showVisit(status);
    showParts(status.processes);
  } catch {
    const state = byId("state");
    state.classList.add("wrong");
    state.textContent = tr(
      "The operator page does not answer. Check that cyclorama-operator runs; this page tries again by itself.",
    );
  }
});

// ---- Steering: held keys and buttons are sent ten times a second; the tour forgets them after 300 ms ----
const keyCommands = {
  ArrowUp: "forward+",
  KeyW: "forward+",
  ArrowDown: "forward-",
  KeyS: "forward-",
  KeyA: "right-",
  KeyD: "right+",
  ArrowLeft: "turn-",
  KeyQ: "turn-",
  ArrowRight: "turn+",
  KeyE: "turn+",
};
const held = new Map(); // From the name of a held key or button to its steering command.
let steering = null;
let isSending = false;
let sendAgain = false;
const steerNote = byId("steer-note").textContent;

const buttonCommand = (button) => {
  const [axis, value] = Object.entries(button.dataset)[0];
  return axis + (Number(value) > 0 ? "+" : "-");
};
function markHeld() {
  const commands = new Set(held.values());
  for (const button of document.querySelectorAll("#steer-pad button"))
    button.classList.toggle("held", commands.has(buttonCommand(button)));
}
// Sends one request at a time, with what is held now: an old command never arrives after a newer one, and a tour that
// hangs does not occupy the browser's connections, which the pictures need.
async function sendCommand() {
  if (isSending) {
    sendAgain = true;
    return;
  }
  isSending = true;
  const command = { forward: 0, right: 0, turn: 0 };
  for (const name of new Set(held.values())) command[name.slice(0, -1)] += name.endsWith("+") ? 1 : -1;
  const note = byId("steer-note");
  try {
    const answer = await post("/steer", command, 2000);
    if (!answer.ok) throw new Error((await answer.json()).error);
    note.classList.remove("wrong");
    note.textContent = steerNote;
  } catch (problem) {
    note.classList.add("wrong");
    note.textContent = tr("The tour does not answer, so nothing moves: {why}", { why: problem.message });
  }
  isSending = false;
  if (!sendAgain) return;
  sendAgain = false;
  sendCommand();
}
function hold(name, command) {
  held.set(name, command);
  markHeld();
  if (steering === null) {
    sendCommand();
    steering = setInterval(sendCommand, 100);
  }
}
function release(name) {
  if (!held.delete(name)) return;
  markHeld();
  if (held.size > 0) return;
  clearInterval(steering);
  steering = null;
  sendCommand();
}
const releaseAll = () => {
  for (const name of [...held.keys()]) release(name);
};

addEventListener("keydown", (event) => {
  if (event.ctrlKey || event.altKey || event.metaKey || !(event.code in keyCommands)) return;
  event.preventDefault();
  if (!event.repeat) hold(event.code, keyCommands[event.code]);
});
addEventListener("keyup", (event) => release(event.code));
addEventListener("blur", releaseAll);
document.addEventListener("visibilitychange", () => {
  if (document.hidden) releaseAll();
});
for (const button of document.querySelectorAll("#steer-pad button")) {
  const name = "button " + buttonCommand(button);
  button.addEventListener("pointerdown", (event) => {
    event.preventDefault();
    button.setPointerCapture(event.pointerId);
    hold(name, buttonCommand(button));
  });
  for (const end of ["pointerup", "pointercancel", "lostpointercapture"])
    button.addEventListener(end, () => release(name));
  button.addEventListener("contextmenu", (event) => event.preventDefault());
  // Space and Enter hold a focused button as a finger would.
  button.addEventListener("keydown", (event) => {
    if ((event.code === "Space" || event.code === "Enter") && !event.repeat) {
      event.preventDefault();
      hold(name, buttonCommand(button));
    }
  });
  button.addEventListener("keyup", () => release(name));
  button.addEventListener("blur", () => release(name));
}
