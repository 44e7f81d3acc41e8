// SPDX-License-Identifier: Apache-2.0
import { byId, duration, fixed, get, large, make, makeSvg, repeat } from "./helpers.js";

// ---- Tables: a column is [heading, text of a row, class of all cells, class of a row's cell] ----
const loadBar = (share) => {
  const svg = makeSvg("svg", {
    class: "load",
    viewBox: "0 0 100 10",
    preserveAspectRatio: "none",
    role: "img",
    "aria-label": `${Math.round(100 * share)} % of the largest load`,
  });
  svg.append(makeSvg("rect", { width: Math.min(100, 100 * share), height: 10 }));
  return svg;
};
const sessionColumns = [
  ["museum", (v) => v.museum || "(unnamed)"],
  ["scene", (v) => v.scene],
  ["frames/s", (v) => fixed(v.frames_per_second, 1), "number"],
  ["frame ms", (v) => fixed(v.frame_ms, 0), "number"],
  ["budget ms", (v) => (v.budget_ms > 0 ? fixed(v.budget_ms, 0) : "–"), "number"],
  ["samples", (v) => fixed(v.samples_per_pixel, 0), "number"],
  ["scale", (v) => fixed(v.scale, 2), "number"],
  ["kB a frame", (v) => fixed(v.bytes_per_frame / 1e3, 0), "number"],
  ["balance", (v) => fixed(v.balance_efficiency, 2), "number"],
  ["frames", (v) => large(v.frames), "number"],
  ["late", (v) => fixed(v.late_frames, 0), "number", (v) => (v.late_frames > 0 ? "wrong" : "")],
  ["given up", (v) => fixed(v.given_up_frames, 0), "number", (v) => (v.given_up_frames > 0 ? "wrong" : "")],
  ["light", (v) => v.light || "", "", () => "quiet"],
];
const stateClass = (n) => (n.state === "ready" ? "well" : n.state === "loading" ? "quiet" : "wrong");
const nodeColumns = [
  ['node', (n) => n.name],
  ['state', (n) => n.state, '', stateClass],
  ['load', (n) => loadBar(n.load_share)],
  ['threads', (n) => fixed(n.threads, 0), 'number'],
  ['speed', (n) => fixed(n.speed, 2), 'number'],
  ['blocks', (n) => fixed(n.blocks, 0), 'number'],
  ['memory', (n) => (n.memory_bytes > 0 ? large(n.memory_bytes) + 'B' : '–'), 'number'],
  ['scenes', (n) => n.scenes, '', () => 'quiet'],
  ['light', (n) => n.light || '', '', () => 'quiet'],
];
// The farm's goals, in milliseconds at the 99th percentile.
const goals = { plan: 1, fan_out: 1, relay: 1, overhead: 5 };
const stageNames = {
  queue: "wait for a turn",
  plan: "plan",
  fan_out: "fan out",
  render: "ray trace",
  encode: "encode",
  relay: "relay a tile",
  overhead: "all but the rays",
  farm: "whole frame",
};
const stageColumns = [
  ["", (s) => stageNames[s.name] || s.name],
  ["p50 ms", (s) => fixed(s.p50_ms, 2), "number"],
  ["p95 ms", (s) => fixed(s.p95_ms, 2), "number"],
  [
    "p99 ms",
    (s) => fixed(s.p99_ms, 2),
    "number",
    (s) => (s.name in goals ? (s.p99_ms <= goals[s.name] ? "well" : "wrong") : ""),
  ],
  ["goal", (s) => (s.name in goals ? "≤ " + goals[s.name] : ""), "number", () => "quiet"],
];

function showTable(id, columns, rows, none, decorate) {
  const table = byId(id);
  const focused =
    document.activeElement && table.contains(document.activeElement) ? document.activeElement.dataset.id : undefined;
  const head = make("tr");
  for (const [heading, , kind] of columns) head.append(make("th", heading, kind || ""));
  const thead = make("thead");
  thead.append(head);
  const body = make("tbody");
  for (const row of rows) {
    const line = make("tr");
    for (const [, show, kind, look] of columns) {
      const value = show(row);
      const cell = make(
        "td",
        value instanceof Element ? undefined : value,
        [kind, look && look(row)].filter(Boolean).join(" "),
      );
      if (value instanceof Element) cell.append(value);
      else cell.title = value;
      line.append(cell);
    }
    if (decorate) decorate(line, row);
    body.append(line);
  }
  if (rows.length === 0) {
    const cell = make("td", none, "none");
    cell.colSpan = columns.length;
    const line = make("tr");
    line.append(cell);
    body.append(line);
  }
  table.replaceChildren(thead, body);
  if (focused) for (const line of body.children) if (line.dataset.id === focused) line.focus();
}

// ---- The picture of one session, as a stream that lasts as long as the session ----
let chosen = null;
let shown = null;
const picture = byId("picture");
const isLarge = (session) => session.width_px > 1600;
function watchSession(id, half) {
  if (id === shown) return;
  shown = id;
  picture.hidden = id === null;
  if (id === null) picture.removeAttribute("src");
  else picture.src = `/sessions/${id}.mjpeg${half ? "?half" : ""}`;
  byId("missing").textContent = id === null ? "No session is open." : "";
}
picture.addEventListener("error", () => {
  if (shown === null) return;
  byId("missing").textContent = "Its picture cannot be shown: too many clients watch it, or it has none yet.";
  picture.hidden = true;
  const lost = shown;
  setTimeout(() => {
    if (shown === lost) shown = undefined;
  }, 2000); // The next status tries again.
});

function showSessions(sessions) {
  if (!sessions.some((session) => session.id === chosen)) chosen = sessions.length > 0 ? sessions[0].id : null;
  showTable("sessions", sessionColumns, sessions, "No museum is connected.", (line, session) => {
    line.tabIndex = 0;
    line.dataset.id = session.id;
    if (session.id === chosen) line.className = "chosen";
    const choose = () => {
      chosen = session.id;
      watchSession(document.hidden ? null : chosen, isLarge(session));
    };
    line.addEventListener("click", choose);
    line.addEventListener("keydown", (event) => {
      if (event.code === "Enter" || event.code === "Space") {
        event.preventDefault();
        choose();
      }
    });
  });
  const session = sessions.find((candidate) => candidate.id === chosen);
  watchSession(document.hidden || !session ? null : chosen, session && isLarge(session));
  const size = session ? `${session.width_px} × ${session.height_px}${isLarge(session) ? ", shown at half size" : ""}` : "";
  byId("caption").textContent = session ? `${session.museum || "(unnamed)"} in “${session.scene}”, ${size}` : "";
}

const order = Object.keys(stageNames);
function show(status) {
  const sessions = status.sessions || [];
  const nodes = status.nodes || [];
  byId("state").textContent = status.state;
  byId("state").classList.toggle("wrong", !status.healthy);
  byId("sessions-count").textContent = sessions.length;
  byId("nodes-count").textContent = `${nodes.filter((node) => node.state === "ready").length} / ${nodes.length}`;
  byId("fps").textContent = fixed(status.gauges.frames_per_second, 1);
  byId("rays").textContent = large(status.gauges.rays_per_second);
  const late = sessions.reduce((sum, session) => sum + session.late_frames, 0);
  byId("late").textContent = late;
  byId("late").classList.toggle("wrong", late > 0);
  showSessions(sessions);
  showTable("nodes", nodeColumns, nodes, "No node is connected.");
  const stages = Object.entries(status.stages)
    .map(([name, stage]) => ({ name, ...stage }))
    .filter((stage) => stage.count > 0);
  stages.sort((a, b) => ((order.indexOf(a.name) + 99) % 99) - ((order.indexOf(b.name) + 99) % 99));
  showTable("stages", stageColumns, stages, "No frame has been measured yet.");
  byId("foot").textContent = `${status.process} ${status.version}, up ${duration(status.uptime_s)}`;
}

repeat(
  1000,
  async () => {
    try {
      const answer = await get("/status");
      if (!answer.ok) throw new Error(`it answers ${answer.status}`);
      show(await answer.json());
    } catch (problem) {
      byId("state").textContent =
        `The farm's coordinator does not answer (${problem.message}). This page tries again by itself.`;
      byId("state").classList.add("wrong");
    }
  },
  () => watchSession(null),
);
