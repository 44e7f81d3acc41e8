// SPDX-License-Identifier: Apache-2.0
// The card that shows whether the projectors are still aligned.
import { byId, isNumber, make, makeSvg } from "./helpers.js";
import { ask, press, say } from "./requests.js";

const kLine = ["#d7b36a", "#7fb0c9", "#c98a7f", "#9cc07f", "#b39bd1", "#cfcfcf"];

function ago(seconds) {
  if (seconds < 90) return `${Math.round(seconds)} s ago`;
  return seconds < 5400 ? `${Math.round(seconds / 60)} min ago` : `${Math.round(seconds / 3600)} h ago`;
}

// Plots the errors of the last ten minutes, the newest at the right, with a gap where nothing was measured.
function healingPlot(names, history) {
  const width = 600,
    height = 120,
    whole = 600;
  const largest = Math.max(1, ...history.flatMap((row) => row.slice(1).filter(isNumber)));
  // Errors are small and bumps are large, so the axis shows square roots.
  const x = (s) => width * (1 - Math.min(s, whole) / whole);
  const y = (px) => height - 4 - (height - 16) * Math.sqrt(Math.max(px, 0) / largest);
  const svg = makeSvg("svg", {
    viewBox: `0 0 ${width} ${height}`,
    role: "img",
    "aria-label": `Each projector's error in the last ten minutes: at most ${largest.toFixed(1)} pixels`,
  });
  for (const px of [0.2, 1, 5, 25, 125].filter((mark) => mark <= largest)) {
    svg.append(makeSvg("line", { x1: 0, x2: width, y1: y(px), y2: y(px), class: "mark" }));
    const label = makeSvg("text", { x: 2, y: y(px) - 2 });
    label.textContent = `${px} px`;
    svg.append(label);
  }
  names.forEach((name, i) => {
    let points = [];
    const draw = () => {
      if (points.length > 1)
        svg.append(makeSvg("polyline", { points: points.join(" "), stroke: kLine[i % kLine.length] }));
      points = [];
    };
    for (const row of history) {
      if (isNumber(row[0]) && isNumber(row[i + 1])) points.push(`${x(row[0]).toFixed(1)},${y(row[i + 1]).toFixed(1)}`);
      else draw();
    }
    draw();
  });
  return svg;
}

function healingLine(projector, colour) {
  const item = make("li", undefined, projector.state === "good" ? "ok" : projector.wants_scan ? "fault" : "warning");
  const words = make("span");
  const name = make("b", projector.name);
  name.style.color = colour;
  words.append(name, projector.state === "good" ? ": in position" : `: ${projector.reason || projector.state}`);
  const figures = [];
  if (isNumber(projector.off_px) && projector.state === "good") figures.push(`error ${projector.off_px.toFixed(2)} px`);
  if (isNumber(projector.sigma_px)) figures.push(`uncertainty ${projector.sigma_px.toFixed(2)} px`);
  if (isNumber(projector.last_px))
    figures.push(`corrected by ${projector.last_px.toFixed(1)} px ${ago(projector.last_s)}`);
  words.append(make("span", figures.join(", "), "figures-line"));
  if (projector.wants_scan) words.append(make("span", "Start a calibration when the museum is closed.", "remedy"));
  item.append(words);
  return item;
}

export function showHealing(watched) {
  byId("healing-card").hidden = watched === null;
  if (watched === null) return;
  byId("healing-state").textContent =
    "Fixed cameras compare the wall with the shown picture. A projector that was bumped is corrected without patterns.";
  byId("healing-projectors").replaceChildren(
    ...watched.projectors.map((one, i) => healingLine(one, kLine[i % kLine.length])),
  );
  byId("healing-plot").replaceChildren(
    ...(watched.history.length > 1 ? [healingPlot(watched.names, watched.history)] : []),
  );
}

press("realign", async () => {
  await ask("/realign", {});
  say("Every projector is measured anew; errors are corrected within some seconds.");
});

press("realign-undo", async () => {
  const answer = await ask("/realign/undo", {});
  say(`Undone: ${answer.undone}.`);
});
